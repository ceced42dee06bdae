"""Time-dependent fits of indentation: relaxation only, since the strain is not homogeneous."""

from __future__ import annotations

from calibration.experiment.model import Experiment, PokeTrial
from calibration.measurements._over_time import OverTime
from calibration.measurements.indentation._course import window_of
from calibration.parameters import ProtocolWindow


def window(experiment: Experiment) -> ProtocolWindow:
    """Range of times and number of peaks that the indentations of an experiment cover."""
    return window_of([t for t in experiment.trials if isinstance(t, PokeTrial)])


OVER_TIME = OverTime(
    options=("time",),
    window=window,
    why_not="whose strain differs from place to place, so that a fit follows its relaxation alone",
)
