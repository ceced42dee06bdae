"""Chains run out of length (eight Langevin chains: Arruda and Boyce, J. Mech. Phys. Solids 41, 1993;
`tisim`'s law `eight-chain`): the amplitude is one over the squared locking stretch; the small-strain modulus
stays.

Past ENDS of the chains' length the force goes on in a straight line, as in that law: a search may step there.
"""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.coupons._kinematics import first_excess, stress_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect

ENDS = 0.995
_STEPS = 5  # of Newton's method, from a Pade form that is right to 5 %
_SHORT = 1e-4  # part of its length up to which a chain is Gaussian to rounding errors


def _stiffening(x: Array) -> Array:
    """Force of a chain at the part x of its length, over that of a Gaussian one (1 for short ones): the
    inverse Langevin function over 3 x."""
    inside = np.clip(x, _SHORT, ENDS)
    b = inside * (3.0 - inside**2) / (1.0 - inside**2)
    for _ in range(_STEPS):
        value, slope = _langevin(b)
        b = b - (value - inside) / slope
    past = np.maximum(x - ENDS, 0.0) / _langevin(b)[1]
    return np.asarray((b + past) / (3.0 * np.maximum(x, _SHORT)))


def _langevin(b: Array) -> tuple[Array, Array]:
    """coth b - 1/b, and its slope."""
    e = np.exp(-2.0 * b)
    return (1.0 + e) / (1.0 - e) - 1.0 / b, 1.0 / b**2 - 4.0 * e / (1.0 - e) ** 2


def _extra(s: Array, amplitude: float, record: Record) -> Array:
    i1 = first_excess(record.mode, s) + 3.0
    part = _stiffening(np.sqrt(amplitude * i1 / 3.0)) / _stiffening(np.sqrt(np.array([amplitude])))
    return stress_of(record.mode, s, 0.5 * (part - 1.0))


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
