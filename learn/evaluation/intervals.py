"""Conformal intervals: a radius around each predicted point, and a factor around the force.

The score of a point is its distance error divided by a scale: the root sum of squares of a fitted error and,
for an ensemble, of the members' spread (normalised conformal prediction; Lei et al., JASA 113, 2018). The
fitted error is a regression of the error's logarithm on the distance from contact, the depth and the
predicted displacement. The pokes are divided into cross-validation folds; each fold is scored by the
regression on the others, and all scores calibrate, in rings around first contact (cross-conformal prediction;
Barber et al., Ann. Statist. 49, 2021: CV+). Points of a poke are not independent: each poke is one draw,
whose points give a distribution of errors. The quantile is taken of the mean of k pokes' distributions, with
weight 1 / (k + 1) beyond all of them for the new poke (Dunn, Wasserman and Ramdas, JASA 118, 2023: pooling
CDFs). Fewer than 9 pokes cannot guarantee 90 %: the largest score is then used, and `promised` is the
guaranteed coverage. New shapes are not exchangeable with trained ones, so that the coverage is measured,
never presumed.

Errors are larger over large inclusions, where the indenter comes near what is rigid, and the more it is
inclined. The fitted errors therefore have a factor e^(b V^(1/3) + c g + d a): V is the inclusion's volume, g
the distance from the indenter's tip to what is rigid, a the angle (`learn.quantities.covariates`). With
respect to new shapes each shape is one draw: b, c and d are fitted to five shapes or more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from learn.errors import InputError
from learn.metrics import RING_EDGES_MM, Predictions
from learn.quantities import COVARIATES

Floats = NDArray[np.float64]
_LEAST_MM = 1e-4
_LEAST_FORCE = 1e-5  # least error of ln(force)
LEAST_DEPTH = 1e-6  # [m]: keeps the logarithms finite at the moment of contact
LEVEL = 0.9
LEAST_POKES = 2
PARTS = 5  # cross-validation folds of the pokes; the error scale of each is fitted to the others
N_FEATURES = 9  # of `_Scale.fit`, without the covariates
LEAST_SHAPES = 5  # for a fit of how errors depend on the covariates
# Outside the trained ranges: LENGTH, in widths of these, is the length scale of the widening; far outside, a
# force is known to a factor of e^FORCE_UNKNOWN = 4, which holds nine tenths of the forces on thin covers, the
# worst case of studies/learning/outside.
LENGTH, FORCE_UNKNOWN = 0.5, 1.4


@dataclass(frozen=True)
class Intervals:
    """Intervals of one run.

    Attributes
    ----------
    level : requested coverage.
    promised : largest coverage, up to `level`, that this number of pokes can guarantee.
    pokes : number of pokes that calibrated.
    scale : coefficients of ln(fitted error / mm).
    factors : factors on the scale, by ring of distance from first contact (`learn.metrics.RING_EDGES_MM`).
    force_scale, force : fitted error of ln(force), and its factor.
    growth, force_growth : change of the logarithms of both fitted errors per unit of each of
        `learn.quantities.COVARIATES`; 0 if there are few shapes.
    """

    level: float
    promised: float
    pokes: int
    scale: list[float]
    factors: list[float]
    force_scale: float
    force: float
    growth: tuple[float, ...] = (0.0,) * len(COVARIATES)
    force_growth: tuple[float, ...] = (0.0,) * len(COVARIATES)

    @property
    def text(self) -> str:
        """Level and calibration in words: "90 %, calibrated on 36 indentations"."""
        weaker = f", which guarantee {100 * self.promised:.0f} %" if self.promised < self.level else ""
        return f"{100 * self.level:.0f} %, calibrated on {self.pokes} indentations{weaker}"

    def radius_mm(self, predictions: Predictions, *, distance: float | Floats = 0.0) -> Floats:
        """Radius of the interval at each point of each frame [mm], (f, n).

        `distance` from the trained ranges, a number or (f,), is `learn.validity.Domain.distance`; far outside
        the radius is at least as large as the predicted displacement.
        """
        return self.radius_at_mm(
            _size(predictions),
            away=predictions.away,
            depth=predictions.depth[:, None],
            spread=predictions.spread,
            covariates=predictions.covariates[:, None],
            distance=np.asarray(distance)[..., None],
        )

    def radius_at_mm(
        self,
        size: Floats,
        *,
        away: Floats,
        depth: float | Floats,
        spread: float | Floats = 0.0,
        covariates: Floats | None = None,
        distance: float | Floats = 0.0,
    ) -> Floats:
        """Radius [mm] from the magnitude of the predicted displacement [m]; others as in `Predictions`.

        No point of the surface moves further than the indenter has travelled, so that the error is never
        larger than predicted displacement and depth together. This bounds the radius where the fitted error,
        a polynomial in logarithms, is extrapolated: just after contact.
        """
        fitted = _scale_mm(size, away, depth, self.scale)
        if covariates is not None:
            fitted = fitted * np.exp(covariates @ np.array(self.growth))
        radius = np.array(self.factors).take(_ring(away)) * _with_spread(fitted, spread)
        if (np.asarray(distance) > 0.0).any():
            radius = np.hypot(radius, np.sqrt(_unknown(distance)) * (1e3 * size))
        return np.asarray(np.minimum(radius, 1e3 * (size + depth)))

    def force_log(
        self,
        spread: float | Floats = 0.0,
        *,
        covariates: Floats | None = None,
        distance: float | Floats = 0.0,
    ) -> Floats:
        """Half width x of the force's interval: from predicted force times e^-x to predicted force times e^x.

        `spread` of an ensemble is as `Predictions.force_spread`; the others are as in `radius_at_mm`.
        """
        grown = 0.0 if covariates is None else covariates @ np.array(self.force_growth)
        fitted = self.force_scale * np.exp(grown)
        inside = self.force * np.hypot(fitted, spread)
        return np.asarray(np.hypot(inside, np.sqrt(_unknown(distance)) * FORCE_UNKNOWN))

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class Coverage:
    """Fractions of points and of forces that lie within their intervals.

    Attributes
    ----------
    points, force : over all points and over all frames.
    points_error, force_error : standard errors of both, as estimates for other shapes: each shape is one draw
        (each poke, where there are fewer than `LEAST_SHAPES` shapes); NaN for a single draw.
    rings : fraction of points by ring of distance from first contact; NaN if there are none.
    pokes : fraction of pokes with at least the promised fraction of points covered.
    """

    points: float
    force: float
    points_error: float
    force_error: float
    rings: list[float]
    pokes: float


def fit_intervals(predictions: Predictions, *, level: float = LEVEL, seed: int = 0) -> Intervals:
    """Fit intervals to predictions of the validation part. InputError if it has fewer than two pokes."""
    pokes = np.unique(predictions.poke)
    if len(pokes) < LEAST_POKES:
        raise InputError(too_few(len(pokes)))
    order = np.random.default_rng(seed).permutation(pokes)
    scores, force = np.empty(predictions.away.shape), np.empty(len(predictions.depth))
    sample = _Sample.of(predictions, many=len(np.unique(predictions.shape)) >= LEAST_SHAPES)
    for part in np.array_split(order, min(PARTS, len(order))):
        mine = np.isin(predictions.poke, part)
        scale = _Scale.fit(_Sample(*(values[~mine] for values in sample)))
        scores[mine], force[mine] = scale.scores(predictions.where(mine))
    return _calibrated(_Scale.fit(sample), scores, force, predictions, level)


def recalibrated(intervals: Intervals, predictions: Predictions) -> Intervals:
    """Intervals of these predictions by the error scale of earlier ones, which is not fitted again.

    For predictions of few pokes of one body by a network whose intervals were fitted to many shapes.
    InputError if there are fewer than two pokes.
    """
    if predictions.pokes < LEAST_POKES:
        raise InputError(too_few(predictions.pokes))
    scale = _Scale(**{name: getattr(intervals, name) for name in _Scale._fields})
    return _calibrated(scale, *scale.scores(predictions), predictions, intervals.level)


def _calibrated(
    scale: _Scale, scores: Floats, force: Floats, predictions: Predictions, level: float
) -> Intervals:
    """Intervals from the `scores` of points (f, n), and of the `force` of frames (f,)."""
    pokes = predictions.pokes
    ring, poke = _ring(predictions.away), np.broadcast_to(predictions.poke[:, None], scores.shape)
    anywhere = pooled_quantile(scores.reshape(-1), poke.reshape(-1), level)
    factors = [
        pooled_quantile(scores[ring == k], poke[ring == k], level) if (ring == k).any() else anywhere
        for k in range(len(RING_EDGES_MM) - 1)
    ]
    return Intervals(
        level=level,
        promised=min(level, pokes / (pokes + 1)),
        pokes=pokes,
        factors=factors,
        force=pooled_quantile(force, predictions.poke, level),
        **scale._asdict(),
    )


def coverage(intervals: Intervals, predictions: Predictions, *, distance: float | Floats = 0.0) -> Coverage:
    """Coverage of the intervals on these predictions; `distance` is as in `Intervals.radius_mm`."""
    inside = predictions.distance_mm <= intervals.radius_mm(predictions, distance=distance)
    ring = _ring(predictions.away)
    known = _force_error(predictions) <= intervals.force_log(
        predictions.force_spread, covariates=predictions.covariates, distance=distance
    )
    each = [inside[predictions.poke == p].mean() for p in np.unique(predictions.poke)]
    shapes = len(np.unique(predictions.shape)) >= LEAST_SHAPES
    draw = predictions.shape if shapes else predictions.poke
    return Coverage(
        points=float(inside.mean()),
        force=float(known.mean()),
        points_error=_standard_error(inside.mean(axis=1), draw),
        force_error=_standard_error(known, draw),
        rings=[
            float(inside[ring == k].mean()) if (ring == k).any() else float("nan")
            for k in range(len(RING_EDGES_MM) - 1)
        ],
        pokes=float((np.array(each) >= intervals.promised).mean()),
    )


def _standard_error(share: NDArray[Any], draw: NDArray[Any]) -> float:
    """Standard error of the mean over frames (f,), of which those of one draw belong together.

    That of a ratio of the draws' sums (Cochran, Sampling Techniques, 1977, eq. 2.46).
    """
    _, place, counts = np.unique(draw, return_inverse=True, return_counts=True)
    k = len(counts)
    if k < 2:
        return float("nan")
    rest = np.bincount(place, share - share.mean())
    return float(np.sqrt(k / (k - 1) * (rest**2).sum()) / counts.sum())


def pooled_quantile(scores: Floats, poke: NDArray[np.int64], level: float) -> float:
    """Least score at which the mean distribution of k pokes, of weight k / (k + 1), reaches `level`.

    The largest score if none does.
    """
    _, place, counts = np.unique(poke, return_inverse=True, return_counts=True)
    order = np.argsort(scores)
    mass = np.cumsum((1 / (counts[place] * (len(counts) + 1)))[order])
    found = int(np.searchsorted(mass, level - 1e-12))
    return float(scores[order[min(found, len(scores) - 1)]])


def rank_correlation(
    intervals: Intervals, predictions: Predictions, *, distance: float | Floats = 0.0
) -> float:
    """Spearman's rank correlation of radius and error over all points."""
    radius = intervals.radius_mm(predictions, distance=distance).reshape(-1).argsort().argsort()
    error = predictions.distance_mm.reshape(-1).argsort().argsort()
    return float(np.corrcoef(radius, error)[0, 1])


def _unknown(distance: float | Floats) -> Floats:
    """Fraction 1 - exp(-(d / LENGTH)^2) of the prior variance, at distance d from the trained ranges.

    The variance of a Gaussian process with a squared exponential covariance returns to its prior in this way
    with the distance from its data (Rasmussen and Williams 2006, eqs 2.26, 4.9).
    """
    return np.asarray(-np.expm1(-((np.asarray(distance) / LENGTH) ** 2)))


def _ring(away: Floats) -> NDArray[np.int64]:
    return np.asarray(np.searchsorted(np.array(RING_EDGES_MM[1:-1]), away * 1e3, side="right"))


def _force_error(predictions: Predictions) -> Floats:
    ratio = predictions.force_predicted / predictions.force
    positive = ratio > 0.0
    return np.where(positive, np.abs(np.log(np.where(positive, ratio, 1.0))), np.inf)


def _size(predictions: Predictions) -> Floats:
    return np.asarray(np.linalg.norm(predictions.predicted, axis=2))


def _scale_mm(size: Floats, away: Floats, depth: float | Floats, scale: Sequence[float] | Floats) -> Floats:
    """Fitted error at each point [mm], from the coefficients of `_Scale.fit` (Horner's scheme)."""
    c, (x, t, s) = scale, _logarithms(size, away, depth)
    of_x = x * (c[1] + c[6] * t + x * (c[2] + x * c[3]))
    return np.asarray(np.exp(c[0] + t * (c[4] + t * c[5]) + of_x + s * (c[7] + s * c[8])))


def _with_spread(fitted: Floats, spread: float | Floats) -> Floats:
    """Root sum of squares [mm] of `fitted` [mm] and `spread` [m]."""
    return fitted if np.ndim(spread) == 0 and spread == 0.0 else np.hypot(fitted, np.asarray(spread) * 1e3)


def _logarithms(size: Floats, away: Floats, depth: float | Floats) -> tuple[Floats, Floats, Floats]:
    """Logarithms of distance and depth over the rod's size, and of displacement over depth."""
    deep = np.maximum(depth, LEAST_DEPTH)
    return np.log1p(away / 2.5e-3), np.log(deep / 5e-3), np.log(size / deep + 1e-4)


class _Sample(NamedTuple):
    """What `_Scale` is fitted to, of f frames at n points.

    `features` (f, n, k) and `logs` of the errors of points [mm] (f, n); `of_force` (f, l) and the errors
    `force` (f,) of forces.
    """

    features: Floats
    logs: Floats
    of_force: Floats
    force: Floats

    @classmethod
    def of(cls, predictions: Predictions, *, many: bool) -> _Sample:
        """All frames; `many` is True if there are enough shapes to fit the dependence on the inclusion."""
        x, t, s = _logarithms(_size(predictions), predictions.away, predictions.depth[:, None])
        within = predictions.covariates * many
        features = np.empty((*x.shape, N_FEATURES + len(COVARIATES)))
        parts = (1.0, x, x**2, x**3, t, t**2, t * x, s, s**2)
        for k, part in enumerate(parts):
            features[..., k] = part
        features[..., len(parts) :] = within[:, None]
        return cls(
            features=features,
            logs=np.log(np.maximum(predictions.distance_mm, _LEAST_MM)),
            of_force=np.column_stack([np.ones(len(within)), within]),
            force=_force_error(predictions),
        )


class _Scale(NamedTuple):
    """Scale of the errors; the fields are those of `Intervals`."""

    scale: list[float]
    force_scale: float
    growth: tuple[float, ...]
    force_growth: tuple[float, ...]

    @classmethod
    def fit(cls, sample: _Sample) -> _Scale:
        """Fit the logarithms of the errors by least squares; `force_scale` is a root mean square residual."""
        found = _least_squares(sample.features, sample.logs)
        slope = _least_squares(sample.of_force, np.log(np.maximum(sample.force, _LEAST_FORCE)))[1:]
        rest = sample.force * np.exp(-sample.of_force[:, 1:] @ slope)
        return cls(
            scale=found[:N_FEATURES].tolist(),
            force_scale=float(np.sqrt((rest**2).mean())),
            growth=tuple(found[N_FEATURES:].tolist()),
            force_growth=tuple(slope.tolist()),
        )

    def scores(self, predictions: Predictions) -> tuple[Floats, Floats]:
        """Errors divided by their scale: of points (f, n), and of forces (f,)."""
        fitted = _scale_mm(_size(predictions), predictions.away, predictions.depth[:, None], self.scale)
        fitted = fitted * np.exp(predictions.covariates @ np.array(self.growth))[:, None]
        force = self.force_scale * np.exp(predictions.covariates @ np.array(self.force_growth))
        return (
            predictions.distance_mm / _with_spread(fitted, predictions.spread),
            _force_error(predictions) / np.hypot(force, predictions.force_spread),
        )


def _least_squares(features: Floats, values: Floats) -> Floats:
    """Least-squares coefficients of the values (...) in their features (..., k)."""
    a = features.reshape(-1, features.shape[-1])
    ridge = 1e-6 * len(a) * np.eye(a.shape[1])
    return np.asarray(np.linalg.solve(a.T @ a + ridge, a.T @ values.reshape(-1)))


def too_few(pokes: int) -> str:
    """Sentence stating that there are too few validation pokes for intervals."""
    there = "there is 1" if pokes == 1 else f"there are {pokes}"
    return f"intervals need at least two validation pokes, {there}: train on a dataset of more pokes"


def force_fault(predictions: Predictions) -> str | None:
    """Sentence stating that forces are predicted which have no logarithm; None if there are none."""
    bad = ~(predictions.force_predicted > 0.0)
    if not bad.any():
        return None
    count = f"{int(bad.sum())} of {len(bad)}"
    return f"intervals need predicted forces above 0 N, which {count} are not: train for more epochs"
