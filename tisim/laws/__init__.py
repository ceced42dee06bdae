"""Constitutive laws: one file each, one line here that registers it."""

from __future__ import annotations

from tisim.laws import (
    arruda_boyce,
    mooney_rivlin,
    neo_hookean,
    ogden,
    st_venant_kirchhoff,
    stable_neo_hookean,
)
from tisim.laws._law import Law, Moduli, Parameters

_LAWS: dict[str, Law] = {
    law.name: law
    for law in (
        st_venant_kirchhoff.LAW,
        neo_hookean.LAW,
        stable_neo_hookean.LAW,
        mooney_rivlin.LAW,
        ogden.LAW,
        arruda_boyce.LAW,
    )
}


def names() -> tuple[str, ...]:
    """Names of the laws, in the paper's order."""
    return tuple(_LAWS)


def get(name: str) -> Law:
    """The law of that name; ValueError names the ones there are."""
    try:
        return _LAWS[name]
    except KeyError:
        raise ValueError(f"law: expected one of {', '.join(_LAWS)}, got {name!r}") from None


__all__ = ["Law", "Moduli", "Parameters", "get", "names"]
