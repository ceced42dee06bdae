"""Metrics of predictions as rows: all frames, by softness, depth, cover, distance from trained ranges."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from learn.evaluation.intervals import Coverage, Intervals, coverage
from learn.metrics import METRICS, Metric, Predictions

DEPTH_BAND_MM = 5.0
COVER_BANDS_MM = (0.0, 4.0, 8.0, 16.0, np.inf)  # edges of the bands of tissue above the inclusion
# edges of the bands of distance from the trained ranges, in widths of these
DISTANCE_BANDS = (0.0, 0.1, 0.3, 1.0, np.inf)
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Value:
    """Mean and standard deviation of a metric over frames (or pokes, or folds); NaN if there are none."""

    mean: float
    sd: float

    def text(self, metric: Metric, *, sd: bool = True) -> str:
        """Text for a table, without the unit; "-" if there is no value."""
        scale = 100 if metric.percent else 1
        if not np.isfinite(self.mean):
            return "-"
        first = f"{round(self.mean * scale, metric.digits) + 0.0:.{metric.digits}f}"
        return f"{first} ± {self.sd * scale:.{metric.digits}f}" if sd else first


Row = dict[str, Value]  # by metric


def summarise(predictions: Predictions) -> Row:
    """Mean and standard deviation of every metric of `METRICS`."""
    return {name: _value(metric, predictions) for name, metric in METRICS.items()}


def by_softness(predictions: Predictions) -> dict[str, Row]:
    """Metrics for each softness level, in the order of their names, and for "all"."""
    names = sorted({str(s) for s in predictions.softness})
    rows = {name: summarise(predictions.where(predictions.softness == name)) for name in names}
    return {**rows, "all": summarise(predictions)}


def by_depth(predictions: Predictions) -> dict[str, Row]:
    """Metrics for each band of depth, `DEPTH_BAND_MM` wide, that has frames."""
    band = np.ceil(predictions.depth * 1e3 / DEPTH_BAND_MM - 1e-6).astype(int)
    return {
        f"{DEPTH_BAND_MM * (k - 1):g} to {DEPTH_BAND_MM * k:g} mm": summarise(predictions.where(band == k))
        for k in np.unique(band).tolist()
    }


def by_cover(predictions: Predictions) -> dict[str, Row]:
    """Metrics for each band of `COVER_BANDS_MM` that has frames: of the tissue below the contact."""
    cover = predictions.cover
    rows = {}
    for low, high in itertools.pairwise(COVER_BANDS_MM):
        mine = (cover > low) & (cover <= high)
        if mine.any():
            name = f"{low:g} to {high:g} mm" if np.isfinite(high) else f"above {low:g} mm"
            rows[name] = summarise(predictions.where(mine))
    return rows


@dataclass(frozen=True, kw_only=True)
class Outside:
    """Errors on frames of another dataset within one band of distance from the trained ranges.

    Attributes
    ----------
    frames, pokes : numbers of frames and pokes.
    distance : mean distance (`learn.validity.Domain.distance`).
    mean_mm, force : mean displacement error [mm], and mean error of the force relative to the true one.
    calibrated, widened : coverage of the intervals without and with their widening by the distance; None if
        the run has no intervals.
    """

    frames: int
    pokes: int
    distance: float
    mean_mm: float
    force: float
    calibrated: Coverage | None
    widened: Coverage | None


def by_distance(
    predictions: Predictions, distance: Floats, intervals: Intervals | None
) -> dict[str, Outside]:
    """Errors inside the trained ranges, and outside in bands of `DISTANCE_BANDS`; empty bands are left out.

    `distance` is that of the frames, (f,).
    """
    bands = {"inside": distance == 0.0}
    for low, high in itertools.pairwise(DISTANCE_BANDS):
        name = f"{low:g} to {high:g}" if np.isfinite(high) else f"beyond {low:g}"
        bands[name] = (distance > low) & (distance <= high)
    return {
        name: _outside(predictions.where(mine), distance[mine], intervals)
        for name, mine in bands.items()
        if mine.any()
    }


def _outside(predictions: Predictions, distance: Floats, intervals: Intervals | None) -> Outside:
    return Outside(
        frames=len(distance),
        pokes=predictions.pokes,
        distance=float(distance.mean()),
        mean_mm=float(predictions.distance_mm.mean()),
        force=float(np.abs(predictions.force_predicted / predictions.force - 1.0).mean()),
        calibrated=None if intervals is None else coverage(intervals, predictions),
        widened=None if intervals is None else coverage(intervals, predictions, distance=distance),
    )


def over_folds(folds: list[Row]) -> Row:
    """Mean and standard deviation of the folds' means; for one fold, its own values."""
    if len(folds) == 1:
        return folds[0]
    return {name: _joined([fold[name].mean for fold in folds]) for name in folds[0]}


def _joined(means: list[float]) -> Value:
    known = np.array([v for v in means if np.isfinite(v)])
    if not len(known):
        return Value(float("nan"), float("nan"))
    return Value(float(known.mean()), float(known.std(ddof=1)) if len(known) > 1 else float("nan"))


def _value(metric: Metric, predictions: Predictions) -> Value:
    values = np.asarray(metric.values(predictions), dtype=float)
    values = values[np.isfinite(values)]
    if not len(values):
        return Value(float("nan"), float("nan"))
    return Value(float(values.mean()), float(values.std()))
