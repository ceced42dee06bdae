"""Search coordinates of the constitutive laws: what an optimiser moves in place of a law's parameters.

A law that is registered in `tisim.laws`, also from outside, is searched in its small-strain moduli (shear
modulus and K/G). `register` gives a law with further constants coordinates of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from calibration.parameters import fibres as _fibres  # noqa: F401 - registers itself
from calibration.parameters import mullins as _mullins  # noqa: F401 - registers itself
from calibration.parameters import prony as _prony  # noqa: F401
from calibration.parameters._coordinates import (
    Coordinate,
    Parameters,
    Parametrisation,
    PartCoordinates,
    ProtocolWindow,
    bulk_ratio,
    shear_modulus,
    two_moduli,
)
from calibration.parameters._laws import arruda_boyce, mooney_rivlin, ogden
from calibration.parameters._parts import (
    Option,
    PartKind,
    part_alternatives,
    part_coordinates,
    part_kind,
    part_kinds,
    register_part,
)
from calibration.parameters._plausible import implausible
from calibration.parameters._stated import OPTIONS, held_part, long_time_parts, part_entry
from tisim import laws

_REGISTERED: dict[str, Callable[[int], Parametrisation]] = {
    "mooney-rivlin": mooney_rivlin,
    "ogden": ogden,
    "arruda-boyce": arruda_boyce,
}
_OURS: Mapping[str, object] = {**_REGISTERED, **{kind.name: kind for kind in part_kinds()}}


def register(law: str, make: Callable[[int], Parametrisation]) -> None:
    """Give a law search coordinates of its own, in place of its small-strain moduli.

    Parameters
    ----------
    law : str
        Name in `tisim.laws`.
    make : callable
        Number of terms (1 for a law that is no series) -> `Parametrisation`.
    """
    _REGISTERED[law] = make


def added_coordinates(law: str) -> Callable[[int], Parametrisation] | None:
    """The function that `register` was given for a law; None for coordinates of the package."""
    make = _REGISTERED.get(law)
    return None if make is _OURS.get(law) else make


def is_added_part(spec: str) -> bool:
    """True for a part from outside the package, which other processes may not know."""
    kind = part_kind(spec)
    return kind is not _OURS.get(kind.name)


def parametrisation(law: str, *, terms: int = 1) -> Parametrisation:
    """Search coordinates of a law.

    Parameters
    ----------
    law : str
        Name in `tisim.laws`.
    terms : int
        Terms of a series law (Ogden: 1 to 3).

    Raises
    ------
    ValueError
        The law is not known; the message names those that are.
    """
    if law not in (*laws.names(), *_REGISTERED):
        raise ValueError(f"law: expected one of {', '.join(laws.names())}, got {law!r}")
    return _REGISTERED[law](terms) if law in _REGISTERED else two_moduli(law)


def is_series(law: str) -> bool:
    """True for a law whose coordinates, or label, depend on the number of its terms."""
    try:
        two = parametrisation(law, terms=2)
    except ValueError:  # it has one term only
        return False
    one = parametrisation(law)
    return (two.label, two.names) != (one.label, one.names)


__all__ = [
    "OPTIONS",
    "Coordinate",
    "Option",
    "Parameters",
    "Parametrisation",
    "PartCoordinates",
    "PartKind",
    "ProtocolWindow",
    "added_coordinates",
    "bulk_ratio",
    "held_part",
    "implausible",
    "is_added_part",
    "is_series",
    "long_time_parts",
    "parametrisation",
    "part_alternatives",
    "part_coordinates",
    "part_entry",
    "part_kind",
    "part_kinds",
    "register",
    "register_part",
    "shear_modulus",
    "two_moduli",
]
