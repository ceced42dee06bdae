"""Which records are of cylinders between platens, and how much of them is compared."""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.experiment.model import CouponTrial, Experiment

PRESSED = 0.97  # stretch below which platens press
# Strain to which simulation and measurement are compared: the mesh of a bonded cylinder is good to 1 % there,
# and a law with a negative second share has an equilibrium (`docs/compression.md`).
LAST = 0.5


def is_pressed(record: Record) -> bool:
    """A uniaxial test that goes into compression, and hardly into tension."""
    return _pressed(record.mode, record.stretch)


def holds_pressed(experiment: Experiment) -> bool:
    """Whether any coupon of an experiment is a pressed one."""
    return any(_pressed(t.mode, t.stretch) for t in _coupons(experiment))


def all_pressed(experiment: Experiment) -> bool:
    """Whether all of its coupons are, and there is one."""
    return holds_pressed(experiment) and all(_pressed(t.mode, t.stretch) for t in _coupons(experiment))


def compared(record: Record, last: float) -> Record:
    """The part of a pressed record up to a strain; others as they are."""
    return record.only(1.0 - record.stretch <= last) if is_pressed(record) else record


def _pressed(mode: str, stretch: np.ndarray) -> bool:
    return mode == "uniaxial" and bool(stretch.min() < PRESSED) and bool(stretch.max() < 2.0 - PRESSED)


def _coupons(experiment: Experiment) -> list[CouponTrial]:
    return [t for t in experiment.trials if isinstance(t, CouponTrial)]
