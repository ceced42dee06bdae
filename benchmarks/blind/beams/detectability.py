"""Size of a hidden effect in sigmas: the misfit that remains after moduli and nuisances are fitted.

Ideal beams are fitted to the true silhouettes (without noise) by Gauss-Newton over one modulus per specimen
and, with their priors, radii, free lengths and registrations. The size is the square root of the minimum of
chi-square.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from benchmarks.blind.beams.cases import LENGTH_SD, RADIUS_SD, TIMES, Case, seen
from benchmarks.blind.beams.ideal_beams import LENGTHS, LOAD, RADIUS, STRETCH, Table, edge_points, interpolate
from benchmarks.blind.beams.model import GRAVITY, Beam

Array = NDArray[np.float64]
OUTLINE_SD, CORRELATION = 0.1e-3, 5e-3  # [m]
TRACE_START = 2.5e-3  # distance of the outline's first point from the clamp face [m]
SHIFT_SD, ROLL_SD, SCALE_SD = 0.1e-3, np.deg2rad(0.15), 0.003
# White part of the contour error over OUTLINE_SD: two good meshes differ by 0.04 mm next to a clamp,
# and no diagnosis can count on less.
FLOOR = 0.4


def trace(kind: int) -> Array:
    """`traced` for a beam of this kind (index of LENGTHS)."""
    return traced(*LENGTHS[kind])


def traced(length: float, bridge: bool) -> Array:
    """Positions s of traced edge points, as fractions of the free length; dense near a clamp."""
    half = length / 2 if bridge else length
    steps = [TRACE_START]
    while sum(steps) < half - 0.5e-3:
        steps.append(min(0.9e-3 * 1.07 ** len(steps), 3.8e-3 if not bridge else 3.0e-3))
    at = np.cumsum(steps)[:-1] / length
    return np.concatenate([at, 1 - at[::-1]]) if bridge else np.append(at, 0.996)


def contour_root(at: Array) -> Array:
    """Lower Cholesky factor of the covariance [m2] of the contour error at arc lengths `at` [m]."""
    kernel = np.exp(-((at[:, None] - at) ** 2) / (2 * CORRELATION**2))
    return np.asarray(np.linalg.cholesky(OUTLINE_SD**2 * (kernel + FLOOR**2 * np.eye(len(at)))))


@lru_cache(maxsize=8)
def _root(kind: int) -> Array:
    return contour_root(trace(kind) * LENGTHS[kind][0])


def sigmas(case: Case, edges: Array, kept: Table, *, against: tuple[Case, Array] | None = None) -> float:
    """Distance [sigma] of `edges` from ideal beams, or to first order from `against`, after the fit."""
    specimens = sorted({t.specimen for t in case.trials})
    trials, photographs = len(case.trials), len(TIMES)
    count = 2 * len(specimens) + trials + 4 * trials * photographs
    theta = np.zeros(count)
    steps = 1 if against else 6
    size = 0.0
    for _ in range(steps):
        normal, right, total = np.zeros((count, count)), np.zeros(count), 0.0
        for k, trial in enumerate(case.trials):
            group = specimens.index(trial.specimen)
            own = [group, len(specimens) + group, 2 * len(specimens) + k]
            beam = _fitted(trial.beam(), theta[own], trial.kind)
            curve = kept.ideal_edges(beam, trial.kind)
            slopes = [
                (kept.ideal_edges(_fitted(beam, d, trial.kind), trial.kind) - curve) / 0.02
                for d in 0.02 * np.eye(3)
            ]
            for photograph in range(photographs):
                first = 2 * len(specimens) + trials + 4 * (photographs * k + photograph)
                columns = [*own, *range(first, first + 4)]
                measured = seen(case, edges, k, photograph, trace(trial.kind))
                base = curve
                if against:
                    base = seen(*against, k, photograph, edge_points(trial.kind))
                r, J = _misfit(trial.kind, measured, base, slopes, theta[first : first + 4])
                total += float(r @ r)
                normal[np.ix_(columns, columns)] += J.T @ J
                right[columns] += J.T @ r
        prior = np.ones(count)
        prior[: len(specimens)] = 1e-9
        total += float(prior @ theta**2)
        right -= prior * theta
        move = np.linalg.solve(normal + np.diag(prior), right)
        size = float(np.sqrt(max(total - float(right @ move), 0.0)))
        theta = theta + move
        if np.abs(move[: len(specimens)]).max() < 1e-5:
            break
    return size


@dataclass(frozen=True, eq=False, kw_only=True)
class Columns:
    """Changes of all photographs of a case divided by the noise (whitened); the last rows are the priors.

    Attributes
    ----------
    free : by parameters that any fit may change, shape (k, parameters).
    causes : by causes, shape (k, causes).
    """

    free: Array
    causes: Array


def columns_at(case: Case, edges: Array, kept: Table, others: Sequence[tuple[Case, Array]]) -> Columns:
    """Columns of a case: free ones for moduli, radii, free lengths and registrations.

    Those of causes are the differences between this case and each of `others` (cases with their edges).
    """
    specimens = sorted({t.specimen for t in case.trials})
    shared = 2 * len(specimens) + len(case.trials)
    count = shared + 4 * len(case.trials) * len(TIMES)
    free, causes = [], []
    for k, trial in enumerate(case.trials):
        group = specimens.index(trial.specimen)
        own = [group, len(specimens) + group, 2 * len(specimens) + k]
        plain = kept.ideal_edges(_fitted(trial.beam(), np.zeros(3), trial.kind), trial.kind)
        slopes = [
            (kept.ideal_edges(_fitted(trial.beam(), d, trial.kind), trial.kind) - plain) / 0.02
            for d in 0.02 * np.eye(3)
        ]
        for photograph in range(len(TIMES)):
            first = shared + 4 * (len(TIMES) * k + photograph)
            base = seen(case, edges, k, photograph, edge_points(trial.kind))
            found = [
                _misfit(trial.kind, seen(*other, k, photograph, trace(trial.kind)), base, slopes, np.zeros(4))
                for other in ((case, edges), *others)
            ]
            (still, J), *moved = found
            rows = np.zeros((len(J), count))
            rows[:, [*own, *range(first, first + 4)]] = J
            free.append(rows)
            causes.append(np.stack([still - r for r, _ in moved], axis=1).reshape(len(J), len(others)))
    priors = np.eye(count)[len(specimens) :]
    return Columns(
        free=np.concatenate([*free, priors]),
        causes=np.concatenate([*causes, np.zeros((len(priors), len(others)))]),
    )


def _fitted(beam: Beam, own: Array, kind: int) -> Beam:
    """Beam with changed parameters, limited to the range of the table.

    `own` holds the change of ln(modulus), and those of radius and free length in standard deviations.
    """
    radius = beam.radius + RADIUS_SD * float(np.clip(own[1], -6, 6))
    unit = LENGTHS[kind][0] * radius / RADIUS
    length = np.clip(
        beam.length + LENGTH_SD * own[2], 1.0001 * STRETCH[0] * unit, 0.9999 * STRETCH[-1] * unit
    )
    weight = beam.density * GRAVITY * radius / RADIUS
    mu = np.clip(beam.mu * np.exp(own[0]), 1.001 * weight / LOAD[1], 0.999 * weight / LOAD[0])
    return replace(beam, mu=float(mu), radius=radius, length=float(length))


def _misfit(
    kind: int, measured: Array, curve: Array, slopes: list[Array], place: Array
) -> tuple[Array, Array]:
    """Whitened normal distance (rows,) of points from the registered curve, and its derivatives (rows, 7).

    `place` (4,) is the registration in standard deviations; `slopes` are the derivatives of the curve by the
    beam's parameters.
    """
    registration = [
        SHIFT_SD * np.stack([np.ones_like(curve[..., 0]), np.zeros_like(curve[..., 0])], axis=-1),
        SHIFT_SD * np.stack([np.zeros_like(curve[..., 0]), np.ones_like(curve[..., 0])], axis=-1),
        ROLL_SD * np.stack([-curve[..., 1], curve[..., 0]], axis=-1),
        SCALE_SD * curve,
    ]
    curve = curve + sum(q * d for q, d in zip(place, registration, strict=True))
    rows, columns = [], []
    for side in range(2):
        s, small = trace(kind), 1e-4
        for _ in range(3):
            here, ahead, behind = (interpolate(kind, curve, at)[side] for at in (s, s + small, s - small))
            tangent = (ahead - behind) / (2 * small)
            length = np.hypot(*tangent.T)
            foot = s + np.einsum("sc,sc->s", measured[side] - here, tangent) / length**2
            s = np.clip(foot, 0.003, 1.02)
        here = interpolate(kind, curve, s)[side]
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) / length[:, None]
        fields = [interpolate(kind, d, s)[side] for d in (*slopes, *registration)]
        block = np.stack([np.einsum("sc,sc->s", f, normal) for f in (measured[side] - here, *fields)], axis=1)
        white = solve_triangular(_root(kind), block, lower=True)
        rows.append(white[:, 0])
        columns.append(white[:, 1:])
    return np.concatenate(rows), np.concatenate(columns)
