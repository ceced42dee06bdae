"""Time-dependent fits of cantilever releases: vibration, damping and slow approach to equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._over_time import OverTime
from calibration.measurements.release._record import records_of, why_no_record
from calibration.parameters import ProtocolWindow, part_kind

# Relaxation times shorter than this fraction of 1 / (angular frequency) act as viscous damping and cannot be
# separated.
FASTEST = 0.1


def window(experiment: Experiment) -> ProtocolWindow:
    """Range of times from FASTEST of the fastest vibration to the end of the longest record."""
    records = records_of(experiment)
    return ProtocolWindow(
        first=FASTEST * min(r.period for r in records) / (2.0 * np.pi),
        last=max(float(r.time[-1]) - r.release_time for r in records),
        peaks=0,
    )


def check(experiment: Experiment, specs: Sequence[str]) -> None:
    """InputError for a trial with markers that has no record (`why_no_record`), if there are specs."""
    for t in experiment.trials:
        why = why_no_record(t, experiment) if isinstance(t, BeamTrial) and specs else ""
        if why:
            part = part_kind(specs[0])
            raise InputError(f"{why}, for --{part.option} {specs[0]}")


OVER_TIME = OverTime(
    options=("time",),
    window=window,
    check=check,
    why_not="since the reduced beam of a release has neither",
)
