"""The zero of the strain is off: the specimen was slack, or preloaded, when its stretch was called 1."""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _shift(s: Array, amplitude: float, record: Record) -> Array:
    del record
    return np.full(s.size, amplitude)


EFFECT = CouponEffect(
    name="strain-offset",
    parameter="offset_percent",
    per_unit=100.0,
    belongs_to="rig",
    step=1e-4,
    bounds=(-0.1, 0.1),
    plausible=0.03,
    sentence="the zero of the strain is off: the specimen was slack or preloaded at the start",
    remedy="begin at a stated small preload, or record through zero into the other sign",
    shift=_shift,
    reach="rig",
)
