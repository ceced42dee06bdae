"""The material stiffens with strain: W gets a term G/2 a (I1 - 3)^2 beside the baseline's (Yeoh's law in
`tisim`, which refuses a < 0: its energy would have no least value)."""

from __future__ import annotations

from calibration.diagnosis.coupons._kinematics import first_excess, stress_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _extra(s: Array, amplitude: float, record: Record) -> Array:
    return stress_of(record.mode, s, amplitude * first_excess(record.mode, s))


EFFECT = CouponEffect(
    name="strain-stiffening",
    parameter="c2_over_c1",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 4.0),
    plausible=0.5,
    sentence="the material gets stiffer the more it is strained",
    remedy="pull to larger strain",
    extra=_extra,
)
