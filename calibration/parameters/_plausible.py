"""Shear moduli that soft tissue and rubber have: outside of them a unit was mistaken, as a rule."""

from __future__ import annotations

SOFTEST, STIFFEST = 100.0, 1e7  # [Pa]


def implausible(shear_modulus: float) -> str:
    """A sentence on a shear modulus [Pa] that no soft material has; empty for any other."""
    if SOFTEST <= shear_modulus <= STIFFEST:
        return ""
    return (
        f"a shear modulus of {shear_modulus:.3g} Pa is outside what soft tissue and rubber have"
        f" ({SOFTEST:g} Pa to {STIFFEST / 1e6:g} MPa): check the units of the records (kPa, N, mm)"
    )
