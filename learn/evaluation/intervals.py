"""Conformal intervals: a radius around each predicted point, and a factor around the force.

The score of a point is its distance error over a scale: the root of the squares of a fitted error and of the
ensemble's spread, where there is one (normalised conformal prediction; Lei et al., JASA 113, 2018). The
fitted error is a regression of the error's logarithm on what the rod, the depth and the prediction say, from
one half of the validation pokes; the other half calibrates, in rings around first touch. Points of a poke
are not independent: each poke is one draw, whose points say how its errors are distributed. The quantile is
taken of the mean of k pokes' distributions, with a share of 1 / (k + 1) beyond all of them for the poke to
come (Dunn, Wasserman and Ramdas, JASA 118, 2023: pooling CDFs). Fewer than 9 pokes cannot promise 90 %: the
largest score is taken then, and `promised` says what it promises. Unseen shapes are not exchangeable with
seen ones, so that the coverage is measured, never presumed.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.errors import InputError
from learn.metrics import Cases
from learn.metrics.rings import EDGES_MM

Floats = NDArray[np.float64]
_LEAST_MM = 1e-4
LEVEL = 0.9


@dataclass(frozen=True)
class Intervals:
    """level: of the coverage that was asked for; promised: what so few pokes can promise at most.

    scale: coefficients of ln(fitted error / mm); factors: of the scale, by ring of distance from first touch
    (`learn.metrics.rings.EDGES_MM`). force_scale: fitted error of ln(force); force: factor of it.
    """

    level: float
    promised: float
    pokes: int
    scale: list[float]
    factors: list[float]
    force_scale: float
    force: float

    def radius_mm(self, cases: Cases) -> Floats:
        """Radius of the interval at each point of each frame [mm], (f, n)."""
        return np.asarray(np.array(self.factors)[_ring(cases)] * _scale_mm(cases, np.array(self.scale)))

    def force_log(self, cases: Cases) -> Floats:
        """The true force lies within predicted e^-x and predicted e^x, (f,)."""
        return np.asarray(self.force * np.hypot(self.force_scale, cases.force_spread))

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class Coverage:
    """Shares of points and of forces that lie within their intervals; rings: the points by ring, NaN where
    there are none; pokes: share of pokes of whose points at least the promised share is covered."""

    points: float
    force: float
    rings: list[float]
    pokes: float


def fit_intervals(cases: Cases, *, level: float = LEVEL, seed: int = 0) -> Intervals:
    """From answers to the validation part. InputError where it has fewer than two pokes."""
    pokes = np.unique(cases.poke)
    if len(pokes) < 2:
        raise InputError(f"intervals need at least two validation pokes, there is {len(pokes)}")
    order = np.random.default_rng(seed).permutation(pokes)
    first = np.isin(cases.poke, order[: len(order) // 2])
    fitting, held = cases.where(first), cases.where(~first)
    scale = _fit_scale(fitting)
    scores = held.distance_mm / _scale_mm(held, scale)
    force_scale = float(np.sqrt((_force_error(fitting) ** 2).mean()))
    force = _force_error(held) / np.hypot(force_scale, held.force_spread)
    ring, poke = _ring(held), np.broadcast_to(held.poke[:, None], scores.shape)
    anywhere = pooled_quantile(scores.reshape(-1), poke.reshape(-1), level)
    factors = [
        pooled_quantile(scores[ring == k], poke[ring == k], level) if (ring == k).any() else anywhere
        for k in range(len(EDGES_MM) - 1)
    ]
    k = len(np.unique(held.poke))
    return Intervals(
        level=level,
        promised=min(level, k / (k + 1)),
        pokes=k,
        scale=scale.tolist(),
        factors=factors,
        force_scale=force_scale,
        force=pooled_quantile(force, held.poke, level),
    )


def coverage(intervals: Intervals, cases: Cases) -> Coverage:
    """How the intervals did on these cases."""
    inside = cases.distance_mm <= intervals.radius_mm(cases)
    ring = _ring(cases)
    each = [inside[cases.poke == p].mean() for p in np.unique(cases.poke)]
    return Coverage(
        points=float(inside.mean()),
        force=float((_force_error(cases) <= intervals.force_log(cases)).mean()),
        rings=[
            float(inside[ring == k].mean()) if (ring == k).any() else float("nan")
            for k in range(len(EDGES_MM) - 1)
        ],
        pokes=float((np.array(each) >= intervals.promised).mean()),
    )


def pooled_quantile(scores: Floats, poke: NDArray[np.int64], level: float) -> float:
    """The least score below which lie `level` of the mean distribution of k pokes, weighing k / (k + 1)."""
    _, place, counts = np.unique(poke, return_inverse=True, return_counts=True)
    order = np.argsort(scores)
    mass = np.cumsum((1 / (counts[place] * (len(counts) + 1)))[order])
    found = int(np.searchsorted(mass, level - 1e-12))
    return float(scores[order[min(found, len(scores) - 1)]])


def rank_correlation(intervals: Intervals, cases: Cases) -> float:
    """Spearman's, of radius and error over all points: 1 where wide intervals are where large errors are."""
    radius = intervals.radius_mm(cases).reshape(-1).argsort().argsort()
    error = cases.distance_mm.reshape(-1).argsort().argsort()
    return float(np.corrcoef(radius, error)[0, 1])


def _ring(cases: Cases) -> NDArray[np.int64]:
    return np.asarray(np.searchsorted(np.array(EDGES_MM[1:-1]), cases.away * 1e3, side="right"))


def _force_error(cases: Cases) -> Floats:
    return np.asarray(np.abs(np.log(cases.force_predicted / cases.force)))


def _scale_mm(cases: Cases, scale: Floats) -> Floats:
    return np.asarray(np.hypot(np.exp(_features(cases) @ scale), cases.spread * 1e3))


def _features(cases: Cases) -> Floats:
    away = np.log1p(cases.away / 2.5e-3)
    depth = np.broadcast_to(np.log(cases.depth / 5e-3)[:, None], away.shape)
    size = np.log(np.linalg.norm(cases.predicted, axis=2) / cases.depth[:, None] + 1e-4)
    parts = [np.ones_like(away), away, away**2, away**3, depth, depth**2, depth * away, size, size**2]
    return np.stack(parts, axis=-1)


def _fit_scale(cases: Cases) -> Floats:
    a = _features(cases).reshape(-1, _features(cases).shape[-1])
    target = np.log(np.maximum(cases.distance_mm.reshape(-1), _LEAST_MM))
    ridge = 1e-6 * len(a) * np.eye(a.shape[1])
    return np.asarray(np.linalg.solve(a.T @ a + ridge, a.T @ target))
