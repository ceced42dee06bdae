"""Constitutive laws: one file each, one line here that registers it."""

from __future__ import annotations

from tisim.laws import (
    arruda_boyce,
    eight_chain,
    mooney_rivlin,
    neo_hookean,
    ogden,
    st_venant_kirchhoff,
    stable_neo_hookean,
    yeoh,
)
from tisim.laws._law import Law, Moduli, Parameters

_PAPER = (
    st_venant_kirchhoff.LAW,
    neo_hookean.LAW,
    stable_neo_hookean.LAW,
    mooney_rivlin.LAW,
    ogden.LAW,
    arruda_boyce.LAW,
)
_LAWS: dict[str, Law] = {
    law.name: law
    for law in (
        *_PAPER,
        yeoh.LAW,
        eight_chain.LAW,
    )
}


def names() -> tuple[str, ...]:
    """Names of the paper's laws, in its order: what is calibrated, compared and written on cards."""
    return tuple(law.name for law in _PAPER)


def all_names() -> tuple[str, ...]:
    """Names of all laws that a scene may have."""
    return tuple(_LAWS)


def get(name: str) -> Law:
    """The law of that name; ValueError names the ones there are."""
    try:
        return _LAWS[name]
    except KeyError:
        raise ValueError(f"law: expected one of {', '.join(_LAWS)}, got {name!r}") from None


__all__ = ["Law", "Moduli", "Parameters", "all_names", "get", "names"]
