"""Repeatability scatter: repeats of one test differ smoothly along the strain, and each record may deviate as
much as the experiment's own repeats show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import linregress, norm, t

from calibration.measurements.compression._record import is_compressed
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

REPEATS = 4  # that a material needs, so that one odd test is not taken for scatter
FIRST = 0.02  # strain from which repeats are compared: before, a record is mostly noise
BEND = 4  # highest degree in the strain
TERMS = ("zero of the strain", "scale", *(f"bend {k}" for k in range(1, BEND + 1)))
GRID = 60
STEEP = 0.05  # probability that noise makes a line over the number of the test so steep
LEAST = 0.001  # of a bend: that some repeats agree better than this may be luck
ALIKE = 1.3  # ratio of the times of two loadings at one speed, at most
_SURE = 0.995  # few repeats tell their own scatter badly: as much wider as Student's t is here
_NORMAL = 1.4826  # standard deviations in a median absolute deviation


@dataclass(frozen=True, eq=False, kw_only=True)
class Repeatability:
    """sds : of the terms of `basis` up to the strain `last`, shape (len(TERMS),); zero without repeats.
    repeats : names of the tests that show it."""

    last: float
    sds: Array
    repeats: tuple[str, ...]


def bends(strain: Array, last: float, degree: int = BEND) -> Array:
    """Legendre polynomials over [FIRST, last], (k, degree + 1); constant beyond."""
    unit = np.clip(2.0 * (strain - FIRST) / (last - FIRST) - 1.0, -1.0, 1.0)
    return np.asarray(np.polynomial.legendre.legvander(unit, degree))


def basis(strain: Array, last: float) -> Array:
    """Of the logarithm of a force, (k, len(TERMS)): what a strain that is off by one would change it by (a
    force grows in proportion at first), and bends."""
    return np.column_stack([1.0 / np.maximum(strain, 0.5 * FIRST), bends(strain, last)])


def repeatability_of(records: Sequence[Record], last: float) -> Repeatability:
    """From the first strokes of tests of one material. The scale of unlike specimens does not count: each has
    its modulus."""
    last = min(last, max((_reach(r) for r in records if is_compressed(r)), default=last))
    squares, names = [], []
    for group in _repeats(records, last):
        reached = min(_reach(r) for r in group)
        grid = np.linspace(FIRST, reached, GRID)
        logs = np.array([np.log(_loading(r, grid)) for r in group])
        terms = np.linalg.lstsq(basis(grid, last), (logs - np.median(logs, axis=0)).T, rcond=None)[0]
        terms, known = _without_order(terms, np.array([r.earlier for r in group], dtype=float))
        spread = _NORMAL * np.median(np.abs(terms - np.median(terms, axis=1)[:, None]), axis=1)
        spread *= np.sqrt((len(group) - 1) / known) * t.ppf(_SURE, known) / norm.ppf(_SURE)
        spread[TERMS.index("scale") :] = np.maximum(spread[TERMS.index("scale") :], LEAST)
        if len({r.specimen for r in group}) > 1:
            spread[TERMS.index("scale")] = 0.0
        squares.append(spread**2)
        names += [r.name for r in group]
    sds = np.sqrt(np.mean(squares, axis=0)) if squares else np.zeros(len(TERMS))
    return Repeatability(last=last, sds=sds, repeats=tuple(names))


def _without_order(terms: Array, order: Array) -> tuple[Array, Array]:
    """Terms (k, n) of n tests less what goes on from test to test, and the degrees of freedom left (k,). A
    line over their number is taken out of a term where noise would not make one so steep; what it says is a
    cause (set between tests, their order), and no scatter."""
    known = np.full(len(terms), len(order) - 1.0)
    if np.ptp(order) == 0.0:
        return terms, known
    left = terms.copy()
    for k, own in enumerate(terms):
        line = linregress(order, own)
        if line.pvalue < STEEP:
            left[k] = own - line.slope * (order - order.mean())
            known[k] -= 1.0
    return left, known


def _repeats(records: Sequence[Record], last: float) -> list[list[Record]]:
    """Tests of one material in one state: first loadings, and loadings of specimens that a test before has
    loaded already, since a first loading softens the material. In a fit over time, those of one speed."""
    found: dict[tuple[str, bool], list[list[Record]]] = {}
    for r in sorted(records, key=_duration):
        if is_compressed(r) and _reach(r) > 0.9 * last:
            groups = found.setdefault((r.material, r.remembers), [])
            if not groups or _duration(r) > ALIKE * _duration(groups[-1][0]):
                groups.append([])
            groups[-1].append(r)
    return [g for groups in found.values() for g in groups if len(g) >= REPEATS]


def _duration(record: Record) -> float:
    """Of the first loading [s]; 1 where time does not count."""
    time = record.time[record.branch == record.branch[0]]
    if record.course is None or not np.isfinite(time).all():
        return 1.0
    return max(float(np.ptp(time)), np.finfo(float).tiny)


def _reach(record: Record) -> float:
    """Largest strain."""
    return float(1.0 - record.stretch.min())


def _loading(record: Record, strain: Array) -> Array:
    """Compressive stress [Pa] of the first branch at these strains; tiny where it pulls."""
    first = record.branch == record.branch[0]
    x, y = 1.0 - record.stretch[first], -record.stress[first]
    order = np.argsort(x, kind="stable")
    return np.maximum(np.interp(strain, x[order], y[order]), 1e-3 * float(np.abs(y).max()))
