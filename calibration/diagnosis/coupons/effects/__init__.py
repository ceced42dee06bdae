"""The effects on coupons. A new one is a file with an EFFECT, and its line here."""

from calibration.diagnosis.coupons.effects import (
    anisotropy,
    hysteresis,
    limited_extensibility,
    machine_compliance,
    mullins,
    platen_friction,
    rate_dependence,
    second_invariant,
    strain_offset,
    strain_stiffening,
)
from calibration.diagnosis.coupons.effects._effect import CouponEffect

_ALL = (
    rate_dependence,
    hysteresis,
    mullins,
    anisotropy,
    strain_offset,
    machine_compliance,
    platen_friction,
    strain_stiffening,
    second_invariant,
    limited_extensibility,
)

EFFECTS: dict[str, CouponEffect] = {module.EFFECT.name: module.EFFECT for module in _ALL}

__all__ = ["EFFECTS", "CouponEffect"]
