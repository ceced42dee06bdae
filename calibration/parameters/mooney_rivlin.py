"""Mooney-Rivlin: shear modulus, K/G, and the second constant's share C01 / (C10 + C01).

Below 0 and above 1 one constant is negative: coupons ask for that at times, pure bending never.
"""

from __future__ import annotations

from calibration.parameters._coordinates import (
    Coordinate,
    Parameters,
    Parametrisation,
    bulk_ratio,
    shear_modulus,
)


def _assemble(v: dict[str, float]) -> Parameters:
    half = 0.5 * v["shear_modulus"]
    return {
        "c10": half * (1.0 - v["second_share"]),
        "c01": half * v["second_share"],
        "bulk": v["shear_modulus"] * v["bulk_ratio"],
    }


def mooney_rivlin(terms: int) -> Parametrisation:  # noqa: ARG001 - one form only
    share = Coordinate(name="second_share", unit="-", log=False, low=-0.5, high=1.0, spread=0.3, start=0.2)
    return Parametrisation(
        law="mooney-rivlin",
        label="mooney-rivlin",
        coordinates=(shear_modulus(), bulk_ratio(), share),
        assemble=_assemble,
    )
