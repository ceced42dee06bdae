"""Repeatability scatter: standard deviations of smooth deviations along the strain, from repeated tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri, stdtrit

from calibration._numerics import robust_sd
from calibration.measurements.compression._record import is_compressed
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

REPEATS = 4  # that a material needs, so that one odd test is not taken for scatter
FIRST = 0.02  # strain from which repeats are compared: before, a record is mostly noise
BEND = 4  # highest degree in the strain
TERMS = ("zero of the strain", "scale", *(f"bend {k}" for k in range(1, BEND + 1)))
GRID = 60
STEEP = 0.05  # probability that noise makes a line over the number of the test so steep
ROUNDS = 200  # of expectation and maximisation
TINY = 1e-16  # variance, of a logarithm
LEAST = 0.001  # of a bend: that some repeats agree better than this may be luck
ALIKE = 1.3  # ratio of the times of two loadings at one speed, at most
_SURE = 0.995  # few repeats tell their scatter badly: as much wider as Student's t is here


@dataclass(frozen=True, kw_only=True)
class Drift:
    """Linear trend over the number of the test.

    Attributes
    ----------
    material : name of the material.
    strain : compressive strain of the comparison.
    per_test : change of the logarithm of the stress from one test to the next.
    correlation : correlation of that logarithm with the number of the test.
    """

    material: str
    strain: float
    per_test: float
    correlation: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Repeatability:
    """Scatter between repeats.

    Attributes
    ----------
    last : largest strain of `basis`.
    sds : standard deviations of the terms of `basis`, shape (len(TERMS),); zero without repeats.
    repeats : names of the tests that it is estimated from.
    drifts : significant trends over the number of the test.
    """

    last: float
    sds: Array
    repeats: tuple[str, ...]
    drifts: tuple[Drift, ...] = ()


def bends(strain: Array, last: float, degree: int = BEND) -> Array:
    """Legendre polynomials over [FIRST, last], shape (k, degree + 1); constant beyond."""
    return np.asarray(np.polynomial.legendre.legvander(_unit(strain, last), degree))


def bent(strain: Array, last: float, terms: Array) -> Array:
    """Sum of `bends` with coefficients `terms`, shape of the strain."""
    return np.asarray(np.polynomial.legendre.legval(_unit(strain, last), terms))


def _unit(strain: Array, last: float) -> Array:
    return np.clip(2.0 * (strain - FIRST) / (last - FIRST) - 1.0, -1.0, 1.0)


def basis(strain: Array, last: float) -> Array:
    """Basis of deviations of the logarithm of a force, shape (k, len(TERMS)).

    The first column is 1/strain, the derivative by an offset of the strain for a force in proportion to the
    strain; the others are `bends`.
    """
    return np.column_stack([1.0 / np.maximum(strain, 0.5 * FIRST), bends(strain, last)])


def repeatability_of(records: Sequence[Record], last: float) -> Repeatability:
    """Estimate the repeatability scatter from the first strokes of repeats, pooled over all materials.

    The scale term is left out for repeats on different specimens, since each specimen has its own modulus.
    """
    last = min(last, max((_reach(r) for r in records if is_compressed(r)), default=last))
    squares, weights, names = [], [], []
    drifts: list[Drift] = []
    for group in _repeats(records, last):
        square, known = _variances(group, last)
        own_scale = len({r.specimen for r in group}) > 1
        independent = np.array([not (own_scale and name == "scale") for name in TERMS])
        squares.append(np.where(independent, square, 0.0))
        weights.append(np.where(independent, known, 0.0))
        names += [r.name for r in group]
        drifts += _drift(group)
    if not squares:
        return Repeatability(last=last, sds=np.zeros(len(TERMS)), repeats=())
    freedom = np.maximum(np.sum(weights, axis=0), 1.0)
    pooled = np.sqrt(np.sum(np.multiply(squares, weights), axis=0) / freedom)
    bent = np.arange(len(TERMS)) >= TERMS.index("scale")
    sds = np.maximum(pooled * stdtrit(freedom, _SURE) / ndtri(_SURE), np.where(bent, LEAST, 0.0))
    sds = np.where(np.any(weights, axis=0), sds, 0.0)
    return Repeatability(last=last, sds=sds, repeats=tuple(names), drifts=tuple(drifts))


def _drift(group: Sequence[Record]) -> list[Drift]:
    """Trend of the stress at the largest common strain over the number of the test, if it is significant."""
    order = np.array([r.earlier for r in group], dtype=float)
    if np.ptp(order) == 0.0:
        return []
    from scipy.stats import linregress  # imported when needed: scipy.stats takes 0.3 s

    strain = min(_reach(r) for r in group)
    line = linregress(order, [float(np.log(_loading(r, np.array([strain]))[0])) for r in group])
    if not line.pvalue < STEEP:
        return []
    return [
        Drift(
            material=group[0].material,
            strain=strain,
            per_test=float(line.slope),
            correlation=float(line.rvalue),
        )
    ]


def _variances(group: Sequence[Record], last: float) -> tuple[Array, int]:
    """Variances of the terms between n repeats, shape (k,), and their degrees of freedom.

    A trend over the number of the test has a cause (set between tests, their order) and is not scatter: a
    linear trend is removed. The terms are random effects in addition to the noise of single points. Their
    variances are estimated by expectation-maximisation (Dempster, Laird and Rubin, J. R. Stat. Soc. B 39,
    1977) with a median in the maximisation, robust against one outlier; variance is not counted twice for
    nearly collinear terms.
    """
    grid = np.linspace(FIRST, min(_reach(r) for r in group), GRID)
    own = np.array([_loading(r, grid) for r in group])
    order = np.array([r.earlier for r in group], dtype=float)
    there = np.column_stack([np.ones(len(group)), order - order.mean()][: 1 + int(np.ptp(order) > 0.0)])
    known = len(group) - there.shape[1]
    # small stresses are the noisier part of a logarithm
    weight = np.median(own, axis=0)
    logs = np.log(own)
    wanted = weight[:, None] * (logs - there @ np.linalg.lstsq(there, logs, rcond=None)[0]).T
    columns = weight[:, None] * basis(grid, last)
    terms = np.linalg.lstsq(columns, wanted, rcond=None)[0]
    square, white = np.mean(terms**2, axis=1), np.mean((wanted - columns @ terms) ** 2)
    for _ in range(ROUNDS):
        white, square = max(white, TINY), np.maximum(square, TINY)
        spread = np.linalg.inv(columns.T @ columns / white + np.diag(1.0 / square))
        terms = spread @ columns.T @ wanted / white
        square = robust_sd(terms, axis=1) ** 2 + np.diag(spread)
        left = np.sum((wanted - columns @ terms) ** 2) / len(group)
        white = (left + np.trace(columns @ spread @ columns.T)) / GRID
    return square * len(group) / known, known


def _repeats(records: Sequence[Record], last: float) -> list[list[Record]]:
    """Groups of at least REPEATS repeats: tests of one material in one state.

    First loadings and loadings of specimens that were loaded in earlier tests are separate, since a first
    loading softens the material. In a fit over time a group has one speed.
    """
    found: dict[tuple[str, bool], list[list[Record]]] = {}
    for r in sorted(records, key=_duration):
        if is_compressed(r) and _reach(r) > 0.9 * last:
            groups = found.setdefault((r.material, r.remembers), [])
            if not groups or _duration(r) > ALIKE * _duration(groups[-1][0]):
                groups.append([])
            groups[-1].append(r)
    return [g for groups in found.values() for g in groups if len(g) >= REPEATS]


def _duration(record: Record) -> float:
    """Duration of the first loading [s]; 1 without a course or a clock."""
    time = record.time[record.branch == record.branch[0]]
    if record.course is None or not np.isfinite(time).all():
        return 1.0
    return max(float(np.ptp(time)), np.finfo(float).tiny)


def _reach(record: Record) -> float:
    """Largest compressive strain."""
    return float(1.0 - record.stretch.min())


def _loading(record: Record, strain: Array) -> Array:
    """Compressive stress [Pa] of the first branch at these strains, at least 1e-3 of the largest."""
    first = record.branch == record.branch[0]
    x, y = 1.0 - record.stretch[first], -record.stress[first]
    order = np.argsort(x, kind="stable")
    return np.maximum(np.interp(strain, x[order], y[order]), 1e-3 * float(np.abs(y).max()))
