"""Chains run out of length (Arruda-Boyce's series of five terms, as `tisim`'s law): the amplitude is one over
the squared locking stretch; the small-strain modulus stays."""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.coupons._kinematics import first_excess, stress_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect

# C_k of Arruda and Boyce, J. Mech. Phys. Solids 41 (1993): 2 k C_k, so that the first is 1
_TERMS = np.array([1.0, 2 / 10, 3 * 22 / 1050, 4 * 38 / 7000, 5 * 1038 / 673750])


def _extra(s: Array, amplitude: float, record: Record) -> Array:
    i1 = first_excess(record.mode, s) + 3.0
    slope = np.polynomial.polynomial.polyval(amplitude * i1, _TERMS)
    rest = float(np.polynomial.polynomial.polyval(3.0 * amplitude, _TERMS))
    return stress_of(record.mode, s, 0.5 * (slope / rest - 1.0))


EFFECT = CouponEffect(
    name="limited-extensibility",
    parameter="one_over_locking_stretch_squared",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 1.0),
    plausible=0.5,
    sentence="the material's chains run out of length at a finite strain",
    remedy="pull until it locks: only there it differs from a plain stiffening",
    extra=_extra,
)
