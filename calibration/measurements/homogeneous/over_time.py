"""Homogeneous tests over time: along the course of each record, with all parts of a material."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.errors import InputError
from calibration.experiment.model import CouponTrial, Experiment
from calibration.measurements._over_time import OverTime, need_clock
from calibration.measurements.homogeneous._record import protocol_window
from calibration.parameters import ProtocolWindow


def _coupons(experiment: Experiment) -> list[CouponTrial]:
    return [t for t in experiment.trials if isinstance(t, CouponTrial)]


def window(experiment: Experiment) -> ProtocolWindow:
    """Of the coupons of an experiment."""
    return protocol_window(_coupons(experiment))


def check(experiment: Experiment, specs: Sequence[str]) -> None:
    """InputError for fibres in a strip, and for a record without a clock where a part needs one."""
    trials = _coupons(experiment)
    strips = [t.id for t in trials if t.mode == "uniaxial"]
    if "fibres" in specs and strips:
        raise InputError(
            f"trial {strips[0]}: --fibres: expected planar, equibiaxial or shear tests, since a strip"
            " shears where its fibres are oblique, which a fit does not follow yet"
        )
    for t in trials:
        if t.time is None:
            need_clock(t.id, specs)


OVER_TIME = OverTime(options=("time", "damage", "fibres"), window=window, check=check)
