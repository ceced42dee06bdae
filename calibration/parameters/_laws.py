"""Search coordinates of the laws that have more than two moduli."""

from __future__ import annotations

from calibration.parameters._coordinates import (
    Coordinate,
    Parameters,
    Parametrisation,
    bulk_ratio,
    shear_modulus,
)
from tisim import laws


def _mooney_rivlin(v: dict[str, float]) -> Parameters:
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
        assemble=_mooney_rivlin,
    )


def _arruda_boyce(v: dict[str, float]) -> Parameters:
    found: Parameters = {
        "mu": v["shear_modulus"],
        "locking": v["locking"],
        "bulk": v["shear_modulus"] * v["bulk_ratio"],
    }
    # mu is the chain network's modulus; the small-strain one is a function of the locking stretch times it
    found["mu"] = v["shear_modulus"] ** 2 / laws.get("arruda-boyce").moduli(found).shear_modulus
    return found


def arruda_boyce(terms: int) -> Parametrisation:  # noqa: ARG001 - one form only
    locking = Coordinate(
        name="locking",
        unit="-",
        log=True,
        low=1.2,
        high=20.0,
        spread=0.4,
        start=3.0,
        limit_high="neo-Hookean",
    )
    return Parametrisation(
        law="arruda-boyce",
        label="arruda-boyce",
        coordinates=(shear_modulus(), bulk_ratio(), locking),
        assemble=_arruda_boyce,
    )


# An exponent of either sign from the second term on: a negative one stiffens equibiaxial tension.
_START = (3.0, -2.0, 8.0)


def _ogden(v: dict[str, float]) -> Parameters:
    terms = sum(name.startswith("alpha") for name in v)
    shears = [v[_name("shear_modulus", p, terms)] for p in range(terms)]
    alphas = [v[_name("alpha", p, terms)] or 1e-6 for p in range(terms)]
    return {
        "mu": tuple(2.0 * g / a for g, a in zip(shears, alphas, strict=True)),
        "alpha": tuple(alphas),
        "bulk": sum(shears) * v["bulk_ratio"],
    }


def _name(what: str, term: int, terms: int) -> str:
    return what if terms == 1 else f"{what}_{term + 1}"


def ogden(terms: int) -> Parametrisation:
    if not 1 <= terms <= len(_START):
        raise ValueError(f"ogden: expected 1 to {len(_START)} terms, got {terms}")
    shears = [shear_modulus(_name("shear_modulus", p, terms)) for p in range(terms)]
    alphas = [
        Coordinate(
            name=_name("alpha", p, terms),
            unit="-",
            log=False,
            low=0.5 if terms == 1 else -12.0,
            high=20.0,
            spread=2.0,
            start=_START[p],
        )
        for p in range(terms)
    ]
    return Parametrisation(
        law="ogden",
        label="ogden" if terms == 1 else f"ogden-{terms}",
        coordinates=(*shears, bulk_ratio(), *alphas),
        assemble=_ogden,
    )
