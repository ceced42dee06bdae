"""Ogden, N terms: each term's share of the shear modulus G_p = mu_p alpha_p / 2 and its exponent; K/G."""

from __future__ import annotations

from calibration.parameters._coordinates import (
    Coordinate,
    Parameters,
    Parametrisation,
    bulk_ratio,
    shear_modulus,
)

# An exponent of either sign from the second term on: a negative one stiffens equibiaxial tension.
_START = (3.0, -2.0, 8.0)


def _assemble(v: dict[str, float]) -> Parameters:
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
        assemble=_assemble,
    )
