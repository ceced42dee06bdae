"""The effects on pressed cylinders: those of coupons, and what only platens do. A new one is a file with an
EFFECT, and its line here."""

from calibration.diagnosis.coupons import EFFECTS as COUPON_EFFECTS
from calibration.diagnosis.coupons import CouponEffect
from calibration.diagnosis.presses.effects import force_gain, force_offset, platen_friction, platen_tilt
from calibration.diagnosis.presses.effects._effect import PressEffect

_OWN = (platen_friction, platen_tilt, force_offset, force_gain)

# platen-friction is there in both: a formula for coupons, a simulation here
EFFECTS: dict[str, CouponEffect] = {**COUPON_EFFECTS, **{m.EFFECT.name: m.EFFECT for m in _OWN}}

__all__ = ["EFFECTS", "PressEffect"]
