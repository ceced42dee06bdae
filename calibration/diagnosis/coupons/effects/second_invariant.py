"""The energy depends on the second invariant too (Mooney-Rivlin): the share C01 / (C10 + C01)."""

from __future__ import annotations

from calibration.diagnosis.coupons._kinematics import stress_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _extra(s: Array, amplitude: float, record: Record) -> Array:
    return stress_of(record.mode, s, -0.5 * amplitude, 0.5 * amplitude)


EFFECT = CouponEffect(
    name="second-invariant",
    parameter="c01_share",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(-0.5, 1.5),
    plausible=0.3,
    sentence="the stress depends on the second invariant too, so that modes of loading differ",
    remedy="test in another mode (equibiaxial tells most), or compress as well as pull",
    extra=_extra,
)
