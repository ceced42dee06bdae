"""Diagnosis of coupons: homogeneous tests with the catalogue's effects nested in their stresses."""

from calibration.diagnosis.coupons.effects import EFFECTS, CouponEffect
from calibration.diagnosis.coupons.model import CouponModel

__all__ = ["EFFECTS", "CouponEffect", "CouponModel"]
