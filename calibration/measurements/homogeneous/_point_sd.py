"""Standard deviation of the points of a homogeneous test: stated, or estimated from the record's scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponTrial
from calibration.measurements._records import Stroke
from calibration.measurements.homogeneous._scatter import FEWEST, SMALLEST_RELATIVE, grows, slope, unstated_sd

Array = NDArray[np.float64]

ASSUMED = 3  # as if from the scatter of so few points: nearly nothing is known of an sd that is assumed


def stress_sd(
    trial: CouponTrial,
    parts: Sequence[Stroke],
    over: Array,
    means: Sequence[Mapping[str, Array]],
    counts: Sequence[Array],
    samples: Sequence[Array],
    used: NDArray[np.bool_],
) -> list[Array]:
    """Standard deviation of the stress alone [Pa] of the means in each branch's bins.

    An error estimated from the scatter is at least SMALLEST_RELATIVE of the record's largest stress, for any
    number of averaged points. Whether it grows with the stress is decided from the whole record.

    Parameters
    ----------
    over : abscissa of the trial, for the scatter about a smooth curve.
    counts, samples : numbers of points, and of samples of the record, in each bin.
    used : mask of the trial's points that are compared.
    """
    if trial.stress_sd is not None:
        return [np.asarray(trial.stress_sd / np.sqrt(n)) for n in samples]
    curves = [(over[b.points][used[b.points]], trial.stress[b.points][used[b.points]]) for b in parts]
    relative, least = grows(curves), _least_sd(trial)
    return [
        np.maximum(unstated_sd(*curve, mean["stress"], count, relative=relative), least)
        for curve, mean, count in zip(curves, means, counts, strict=True)
    ]


def with_stretch_error(
    trial: CouponTrial, stretch: Array, stress: Array, samples: Array, own: Array
) -> Array:
    """Standard deviation of the means in a branch's bins [Pa], including the stretch error.

    samples : number of samples of the record in each bin; own : error of the stress alone.
    """
    if trial.stretch_sd == 0.0:
        return own
    return np.asarray(
        np.hypot(own, slope(stretch, stress, trial.stretch_sd) * trial.stretch_sd / np.sqrt(samples))
    )


def with_stretch_error_over_time(
    trial: CouponTrial,
    b: Stroke,
    holds: Sequence[slice],
    mean: Mapping[str, Array],
    first: NDArray[np.intp],
    samples: Array,
    own: Array,
) -> Array:
    """As `with_stretch_error`; a hold has the slope of the last ramp."""
    if trial.stretch_sd == 0.0:
        return own
    rows = b.points.start + first
    moves = ~np.array([any(h.start <= i < h.stop for h in holds) for i in rows])
    if np.count_nonzero(moves) < 5:
        return own
    slopes = slope(mean["stretch"][moves], mean["stress"][moves], trial.stretch_sd)
    last = np.maximum(np.cumsum(moves) - 1, 0)
    return np.asarray(np.hypot(own, slopes[last] * trial.stretch_sd / np.sqrt(samples)))


def _least_sd(trial: CouponTrial) -> float:
    """Least standard deviation of a stress that the lab does not state [Pa].

    A load cell is accurate to a fraction of its range, which held the whole record, not of each reading, or
    of the part that is compared (studies/compression/diagnosis.md).
    """
    return SMALLEST_RELATIVE * float(np.abs(trial.stress).max(initial=0.0))


def scatter_points(trial: CouponTrial, sd: Array, used: NDArray[np.bool_]) -> int:
    """Number of points from whose scatter the sd comes: see `Record.scatter_points`.

    sd : standard deviation of the means that are compared; used : mask of the trial's points that are.
    """
    if trial.stress_sd is not None:
        return 0
    if len(np.unique((trial.stretch if trial.time is None else trial.time)[used])) < FEWEST:
        return ASSUMED
    scatters = float(np.median(sd)) > 1.01 * _least_sd(trial)
    return int(np.count_nonzero(used)) if scatters else 0
