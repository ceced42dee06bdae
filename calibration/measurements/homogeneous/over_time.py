"""Time-dependent fits of homogeneous tests: along the course of each record, with all parts of a material."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.experiment.model import CouponTrial, Experiment
from calibration.measurements._over_time import OverTime, need_clock
from calibration.measurements.homogeneous._branches import protocol_window
from calibration.parameters import ProtocolWindow


def _coupons(experiment: Experiment) -> list[CouponTrial]:
    return [t for t in experiment.trials if isinstance(t, CouponTrial)]


def window(experiment: Experiment) -> ProtocolWindow:
    """Range of times and number of peaks that the coupons of an experiment cover."""
    return protocol_window(_coupons(experiment))


def check(experiment: Experiment, specs: Sequence[str]) -> None:
    """InputError for a record without a clock if a part needs one."""
    for t in _coupons(experiment):
        if t.time is None:
            need_clock(t.id, specs)


OVER_TIME = OverTime(options=("time", "damage", "fibres"), window=window, check=check)
