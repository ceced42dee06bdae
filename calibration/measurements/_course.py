"""Loading history as measured, of all kinds: its ramps and holds, and the times that they show.

The driven quantity is a stretch or a depth. Each kind makes its own course of it, which a history-dependent
material is integrated along.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._records import bins
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

STILL = 0.01  # fraction of a range within which a driven quantity has not moved
NOISE = 6.0  # the same, in standard deviations of its noise
LONG = 2.0  # least duration of a hold, over the time that the adjacent motion takes for 10 tolerances
BEGINNING = 4  # number of rows from which the speed of a first ramp is estimated, at least
DIFFERENT = 1.1  # ratio from which two peaks count as different


def unmoved(reach: float, sd: float) -> float:
    """Largest change of a driven quantity that is no motion.

    Noise that is larger than the fraction `STILL` of the range would otherwise count as ramps and turns.

    Parameters
    ----------
    reach : range of the quantity in the record, or its largest distance from rest.
    sd : standard deviation of its noise, in the same unit.
    """
    return max(STILL * reach, NOISE * sd)


def holds(time: Array, driven: Array, tolerance: float) -> list[slice]:
    """Rows of each hold of a driven quantity.

    In a hold the quantity stays within `tolerance` of its value in the first row, for at least LONG times the
    time in which the adjacent motion covers 10 tolerances.
    """
    found: list[slice] = []
    i = 0
    while i < driven.size - 1:
        away = np.abs(driven[i:] - driven[i]) > tolerance
        end = i + int(np.argmax(away)) if away.any() else driven.size
        far = 10.0 * tolerance
        later = np.flatnonzero(np.abs(driven[end:] - driven[i]) > far)
        earlier = np.flatnonzero(np.abs(driven[:i] - driven[i]) > far)
        beside = [time[end + later[0]] - time[end - 1]] if later.size else []
        beside += [time[i] - time[earlier[-1]]] if earlier.size else []
        if beside and end - i > 1 and time[end - 1] - time[i] >= LONG * min(beside):
            found.append(slice(i, end))
            i = end
        else:
            i += 1
    return found


def ramp_start(time: Array, driven: Array, stop: int, sd: float = 0.0) -> float | None:
    """Time at which the first ramp of a record left rest, extrapolated from its first rows.

    Parameters
    ----------
    time, driven : ndarray of float, shape (k,)
        Time [s], and the driven quantity less its value at rest.
    stop : int
        Row after the last one of the ramp.
    sd : float
        Standard deviation of the driven quantity; its speed is that of a change beyond this noise.

    Returns
    -------
    float or None
        None if the record begins at rest or by a jump: the first rows are a hold or creep, not the end of a
        ramp of which more than half is missing.
    """
    last = min(stop, driven.size - 1)
    gone, travel = driven[0], driven[last] - driven[0]
    away = np.abs(driven[: last + 1] - gone) > unmoved(float(np.abs(driven).max()), sd)
    if gone * travel <= 0.0 or abs(gone) > abs(travel) or not away.any():
        return None
    row = max(int(np.argmax(away)), min(BEGINNING, last))
    made = driven[row] - gone
    if gone * made <= 0.0 or time[row] <= time[0]:
        return None
    return float(time[0] - (time[row] - time[0]) * gone / made)


def bins_over_time(time: Array, points: slice, held: Sequence[slice], most: int) -> tuple[Rows, Array]:
    """Bins as by `bins`, separate for each ramp and hold; in a hold their width grows with its time.

    Parameters
    ----------
    time : times of the whole record [s], shape (t,).
    points : rows to put into bins.
    held : rows of each hold of the record.
    most : largest number of bins of a ramp or hold.
    """
    corners = {points.start, points.stop}
    corners |= {i for h in held for i in (h.start, h.stop) if points.start < i < points.stop}
    firsts = []
    for a, b in pairwise(sorted(corners)):
        if b - a <= most or not any(h.start <= a and b <= h.stop for h in held):
            firsts.append(a + bins(slice(a, b), most)[0])
            continue
        since = time[a:b] - time[a]
        scale = np.log1p(since / since[1])
        number = np.floor(most * scale / scale[-1])
        firsts.append(a + np.flatnonzero(np.diff(number, prepend=-1.0)))
    first = np.concatenate(firsts) - points.start
    return first, np.diff(np.append(first, points.stop - points.start)).astype(float)


def window_from(
    *,
    ramps: Sequence[float],
    waits: Sequence[float],
    lengths: Sequence[float],
    intervals: Sequence[float],
    peaks: Sequence[float],
) -> ProtocolWindow:
    """Range of times, and number of different peaks, that the tests of a material cover.

    Parameters
    ----------
    ramps, waits, lengths : durations of ramps, of holds and of whole tests [s].
    intervals : times between rows [s]: what a record of a hold alone shows first.
    peaks : sizes of the loadings that were unloaded from, from rest, in one unit.
    """
    ordered = sorted(peaks)
    different = sum(k == 0 or peak > DIFFERENT * ordered[k - 1] for k, peak in enumerate(ordered))
    last = max(waits or lengths, default=0.0)
    first = min([r for r in ramps if r > 0.0] or [i for i in intervals if i > 0.0], default=last)
    return ProtocolWindow(first=min(first, last), last=last, peaks=different)
