"""The first loading of a record: from contact to the first reversal or hold, thinned, with its errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.coupons import relative_sd, scatter_scale, slope
from calibration.errors import InputError
from calibration.experiment.model import PokeTrial
from calibration.pokes._scene import approach

Array = NDArray[np.float64]

LEAST = 5  # points that a curve needs
MOST = 200  # points kept: more samples than these are averaged, neighbours together
# A piece of the way that takes PAUSE times as long as the median piece is a hold.
PIECES, PAUSE = 50, 5.0


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadingBranch:
    """depth [m] from first touch, force along the rod [N] and its sd [N], each (k,), depth rising.

    sd: of the force, with the depth's error through the measured slope, of independent samples; where several
    samples make a point, of their mean. sd_estimated: the lab gave no force_sd.
    left_out: what of the record is not in it, one sentence.
    """

    trial: str
    depth: Array
    force: Array
    sd: Array
    sd_estimated: bool
    left_out: str


def loading_branch(trial: PokeTrial, *, max_depth: float | None = None) -> LoadingBranch:
    """The part of a poke's record that a purely elastic block can answer for.

    max_depth [m]: nothing deeper is used. InputError where less than 5 points are left, or no push.
    """
    record = trial.record
    depth = record.depth - approach(trial)
    tolerance = _tolerance(depth, trial.depth_sd)
    inside = np.flatnonzero(depth > tolerance)
    if not inside.size:
        raise InputError(f"trial {trial.id}: record: expected a depth beyond the first touch, got none")
    first = int(inside[0])
    end, why = _end(record.time[first:], depth[first:], tolerance)
    kept = np.arange(first, first + end)
    rising = kept[depth[kept] > tolerance]
    deep = np.zeros(len(rising), bool) if max_depth is None else depth[rising] > max_depth
    used = rising[~deep]
    if len(used) < LEAST:
        raise InputError(
            f"trial {trial.id}: record: expected at least {LEAST} samples in its first loading,"
            f" got {len(used)}"
        )
    d, force, sd = _weighed(trial, depth[used], record.force[used])
    if not force[-max(1, len(force) // 5) :].mean() > 0.0:
        raise InputError(f"trial {trial.id}: record: expected a force above 0 (pushing) at its deepest")
    return LoadingBranch(
        trial=trial.id,
        depth=d,
        force=force,
        sd=sd,
        sd_estimated=trial.force_sd is None,
        left_out=_say(
            len(depth),
            {
                "at or before the first touch": first + len(kept) - len(rising),
                f"deeper than {0.0 if max_depth is None else max_depth * 1e3:g} mm": int(deep.sum()),
                why: len(depth) - first - end,
            },
        ),
    )


def _tolerance(depth: Array, sd: float) -> float:
    """What a depth may wander without going anywhere [m]: noise, or the step of the reading."""
    steps = np.abs(np.diff(depth))
    steps = steps[steps > 0.0]
    if not steps.size:
        return 3.0 * sd
    quantum = float(steps.min()) if (np.diff(depth) == 0.0).any() else 0.0
    return max(3.0 * sd, min(quantum, 0.02 * float(np.ptp(depth))), 1e-3 * float(np.ptp(depth)))


def _end(time: Array, depth: Array, tolerance: float) -> tuple[int, str]:
    """How many samples belong to the first loading, and what ends it."""
    peak = np.maximum.accumulate(depth)
    back = np.flatnonzero(depth < peak - 2.0 * tolerance)
    last = int(back[0]) if back.size else len(depth)
    top = float(peak[last - 1])
    arrived = int(np.flatnonzero(depth[:last] >= top - tolerance)[0]) + 1
    if back.size:
        why = f"at and after the end of the loading at {time[arrived - 1]:g} s"
    elif time[last - 1] - time[arrived - 1] > 0.1 * (time[arrived - 1] - time[0]):
        why = f"in a hold from {time[arrived - 1]:g} s"
    else:
        arrived, why = last, ""
    pause = _pause(time[:arrived], peak[:arrived], tolerance)
    if pause is not None:
        return pause, f"from a hold at {time[pause - 1]:g} s on"
    return arrived, why


def _pause(time: Array, peak: Array, tolerance: float) -> int | None:
    """Samples before a hold on the way, if there is one: where a piece of the way takes far too long."""
    grows = np.concatenate([[True], np.diff(peak) > 0.0])
    way = float(peak[-1] - peak[0])
    pieces = int(min(PIECES, way // (2.0 * tolerance))) if tolerance > 0.0 else PIECES
    if pieces < 4:
        return None
    levels = np.linspace(peak[0], peak[-1], pieces + 1)
    stay = np.diff(np.interp(levels, peak[grows], time[grows]))
    long = stay > np.maximum(PAUSE * np.median(stay), 3.0 * np.median(np.diff(time)))
    if not long.any():
        return None
    return max(1, int(np.searchsorted(peak, levels[int(np.argmax(long))], side="right")))


def _weighed(trial: PokeTrial, depth: Array, force: Array) -> tuple[Array, Array, Array]:
    groups = np.array_split(np.argsort(depth, kind="stable"), min(MOST, len(depth)))
    d = np.array([depth[g].mean() for g in groups])
    f = np.array([force[g].mean() for g in groups])
    share = 1.0 / np.sqrt([len(g) for g in groups])
    through_depth = slope(d, f) * trial.depth_sd * share
    if trial.force_sd is None:  # the scatter of the means, depth's share in it
        return d, f, relative_sd(d, f) * scatter_scale(f)
    return d, f, np.hypot(trial.force_sd * share, through_depth)


def _say(total: int, parts: dict[str, int]) -> str:
    found = [f"{n} {what}" for what, n in parts.items() if n and what]
    return f"{sum(n for w, n in parts.items() if w)} of {total} samples: {', '.join(found)}" if found else ""
