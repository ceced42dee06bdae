"""Registry of the laws by name."""

from __future__ import annotations

import re
from dataclasses import replace

from tisim.laws import (
    arruda_boyce,
    eight_chain,
    mooney_rivlin,
    neo_hookean,
    ogden,
    st_venant_kirchhoff,
    stable_neo_hookean,
    stiffening_neo_hookean,
    yeoh,
)
from tisim.laws._energy import lazy
from tisim.laws._law import Law

# The paper's laws, in its order; the other built-in laws are not calibrated by default.
_PAPER = (
    st_venant_kirchhoff.LAW,
    neo_hookean.LAW,
    stable_neo_hookean.LAW,
    mooney_rivlin.LAW,
    ogden.LAW,
    arruda_boyce.LAW,
)
_BUILT_IN: dict[str, Law] = {
    law.name: law for law in (*_PAPER, yeoh.LAW, eight_chain.LAW, stiffening_neo_hookean.LAW)
}
_ADDED: dict[str, Law] = {}
_NAME = re.compile(r"[a-z0-9][a-z0-9-]*")


def register(law: Law) -> Law:
    """Add a law; an added law of the same name is replaced.

    Parameters
    ----------
    law : Law

    Returns
    -------
    Law
        The law as registered.

    Raises
    ------
    TypeError
        If it is not a `Law`.
    ValueError
        If its name is that of a built-in law or has other characters than lower-case letters, digits and
        hyphens, or if the parameters of its `from_moduli` fail its check or do not have the given moduli.
    """
    if not isinstance(law, Law):
        raise TypeError(f"law: expected a Law, got {type(law).__name__}")
    if not _NAME.fullmatch(law.name):
        raise ValueError(f"law: expected a name of lower-case letters, digits and hyphens, got {law.name!r}")
    if law.name in _BUILT_IN:
        raise ValueError(f"law: {law.name!r} is a law of tisim's own; choose another name")
    parameters = law.from_moduli(2e4, 6e6)
    law.check(parameters)
    found = law.moduli(parameters)
    if max(abs(found.shear_modulus / 2e4 - 1.0), abs(found.bulk_modulus / 6e6 - 1.0)) > 1e-6:
        raise ValueError(f"{law.name}: from_moduli(2e4, 6e6) has other moduli, {found}")
    made = replace(law, energy=lazy(law.energy))
    _ADDED[law.name] = made
    return made


def unregister(name: str) -> None:
    """Remove an added law; other names are ignored."""
    _ADDED.pop(name, None)


def added(name: str) -> Law | None:
    """The law of that name if it was added, None for a built-in one."""
    return _ADDED.get(name)


def names() -> tuple[str, ...]:
    """Names of the laws that are calibrated and compared: the paper's, in its order, then added ones."""
    return tuple(law.name for law in _PAPER) + tuple(_ADDED)


def all_names() -> tuple[str, ...]:
    """Names of all laws that a scene may have: the built-in ones, then added ones."""
    return tuple(_BUILT_IN) + tuple(_ADDED)


def get(name: str) -> Law:
    """The law of that name.

    Raises
    ------
    ValueError
        For an unknown name; the message lists the known ones.
    """
    law = _BUILT_IN.get(name) or _ADDED.get(name)
    if law is None:
        raise ValueError(f"law: expected one of {', '.join(all_names())}, got {name!r}")
    return law
