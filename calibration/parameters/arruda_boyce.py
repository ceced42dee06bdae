"""Arruda-Boyce: shear modulus, K/G and the locking stretch."""

from __future__ import annotations

from calibration.parameters._coordinates import (
    Coordinate,
    Parameters,
    Parametrisation,
    bulk_ratio,
    shear_modulus,
)
from tisim import laws


def _assemble(v: dict[str, float]) -> Parameters:
    found: Parameters = {
        "mu": v["shear_modulus"],
        "locking": v["locking"],
        "bulk": v["shear_modulus"] * v["bulk_ratio"],
    }
    # mu is the chain network's modulus; the small-strain one is a function of the locking stretch times it
    found["mu"] = v["shear_modulus"] ** 2 / laws.get("arruda-boyce").moduli(found).shear
    return found


def arruda_boyce(terms: int) -> Parametrisation:  # noqa: ARG001 - one form only
    locking = Coordinate(name="locking", unit="-", log=True, low=1.2, high=20.0, spread=0.4, start=3.0)
    return Parametrisation(
        law="arruda-boyce",
        label="arruda-boyce",
        coordinates=(shear_modulus(), bulk_ratio(), locking),
        assemble=_assemble,
    )
