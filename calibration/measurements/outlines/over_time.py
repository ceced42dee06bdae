"""Time-dependent fits of photographed beams: quasi-static creep under the load from time 0."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._over_time import OverTime
from calibration.parameters import ProtocolWindow, part_kind


def window(experiment: Experiment) -> ProtocolWindow:
    """Times of the first and last photograph; faster relaxation is complete in all photographs."""
    times = _times(experiment)
    return ProtocolWindow(first=min(times, default=0.0), last=max(times, default=0.0), peaks=0)


def check(experiment: Experiment, specs: Sequence[str]) -> None:
    """InputError if a part needs time and all photographs are of one time, which shows one modulus only."""
    timed = [s for s in specs if part_kind(s).needs_time]
    if timed and len(set(_times(experiment))) < 2:
        raise InputError(
            f"trial {experiment.trials[0].id}: --{part_kind(timed[0]).option} {timed[0]}:"
            " expected photographs at two times or more (captures.time_s)"
        )


def _times(experiment: Experiment) -> list[float]:
    trials = [t for t in experiment.trials if isinstance(t, BeamTrial)]
    return [c.time for t in trials for c in t.captures if c.outline is not None]


OVER_TIME = OverTime(
    options=("time",),
    window=window,
    check=check,
    why_not="since a beam that hangs still is loaded once, which shows neither",
)
