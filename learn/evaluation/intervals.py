"""Split-conformal intervals: a radius around each predicted point, and a factor around the force.

The score of a point is its distance error over a learned scale; the radius is the scale times that
quantile of the scores of held-out pokes which a finite sample needs (Vovk; Lei et al., JASA 113, 2018). The
scale is a regression of the error's logarithm on what the rod, the depth and the prediction say, fitted on
one half of the validation pokes; the quantile is taken on the other. Points of a poke are not independent
and unseen shapes are not exchangeable with seen ones, so that the coverage is measured, never presumed.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.errors import InputError
from learn.metrics import Cases

Floats = NDArray[np.float64]
_LEAST_MM = 1e-4
LEVEL = 0.9


@dataclass(frozen=True)
class Intervals:
    """level: of the coverage. scale: coefficients of ln(error / mm). factor: of the scale, at that level.

    force: the true force lies within [predicted / e^force, predicted e^force] at that level.
    """

    level: float
    scale: list[float]
    factor: float
    force: float

    def radius_mm(self, cases: Cases) -> Floats:
        """Radius of the interval at each point of each frame [mm], (f, n)."""
        return np.asarray(self.factor * np.exp(_features(cases) @ np.array(self.scale)))

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def fit_intervals(cases: Cases, *, level: float = LEVEL, seed: int = 0) -> Intervals:
    """From answers to the validation part. InputError where it has fewer than two pokes."""
    pokes = np.unique(cases.poke)
    if len(pokes) < 2:
        raise InputError(f"intervals need at least two validation pokes, there is {len(pokes)}")
    order = np.random.default_rng(seed).permutation(pokes)
    first = np.isin(cases.poke, order[: len(order) // 2])
    scale = _fit_scale(cases.where(first))
    held = cases.where(~first)
    scores = held.distance_mm / np.exp(_features(held) @ scale)
    force = np.abs(np.log(cases.force_predicted / cases.force))
    return Intervals(level, scale.tolist(), _quantile(scores.reshape(-1), level), _quantile(force, level))


def coverage(intervals: Intervals, cases: Cases) -> tuple[float, float]:
    """Shares of points and of forces that lie within their intervals."""
    points = (cases.distance_mm <= intervals.radius_mm(cases)).mean()
    force = (np.abs(np.log(cases.force_predicted / cases.force)) <= intervals.force).mean()
    return float(points), float(force)


def rank_correlation(intervals: Intervals, cases: Cases) -> float:
    """Spearman's, of radius and error over all points: 1 where wide intervals are where large errors are."""
    radius = intervals.radius_mm(cases).reshape(-1).argsort().argsort()
    error = cases.distance_mm.reshape(-1).argsort().argsort()
    return float(np.corrcoef(radius, error)[0, 1])


def _quantile(scores: Floats, level: float) -> float:
    n = len(scores)
    return float(np.sort(scores)[min(int(np.ceil((n + 1) * level)), n) - 1])


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
