"""Platens hold a compressed cylinder by friction (slab method: the pressure grows exponentially inwards): its
stress is 2 (e^x - 1 - x) / x^2 times higher with x = 3 a s^(-3/2), where a is the coefficient of friction
times diameter over three times the height at rest, and s the stretch. For small a that is 1 + a s^(-3/2)."""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect

PRESSED = 0.97  # stretch below which platens press


def _factor(s: Array, amplitude: float, record: Record) -> Array:
    del record
    x = 3.0 * amplitude * np.maximum(s, 1e-3) ** -1.5
    small = np.abs(x) < 1e-2
    large = np.where(small, 1.0, x)
    whole = np.where(small, 1.0 + x / 3.0 + x**2 / 12.0, 2.0 * (np.expm1(large) - large) / large**2)
    return np.where(s < 1.0, whole, 1.0)


EFFECT = CouponEffect(
    name="platen-friction",
    parameter="mu_d_over_3h",
    per_unit=1.0,
    belongs_to="rig",
    step=1e-3,
    bounds=(0.0, 1.0),
    plausible=0.2,
    sentence="friction at the platens holds the ends of the compressed specimen",
    remedy="lubricate the platens, or compress cylinders of two heights",
    factor=_factor,
    touches=lambda record: record.mode == "uniaxial" and bool(record.stretch.min() < PRESSED),
    reach="rig",
)
