"""Laws in search coordinates: one file where a law has more than two moduli, one line here."""

from __future__ import annotations

from collections.abc import Callable

from calibration.parameters._coordinates import Coordinate, Parametrisation, two_moduli
from calibration.parameters.arruda_boyce import arruda_boyce
from calibration.parameters.mooney_rivlin import mooney_rivlin
from calibration.parameters.ogden import ogden
from tisim import laws

_OWN: dict[str, Callable[[int], Parametrisation]] = {
    "mooney-rivlin": mooney_rivlin,
    "ogden": ogden,
    "arruda-boyce": arruda_boyce,
}


def parametrisation(law: str, *, terms: int = 1) -> Parametrisation:
    """Search coordinates of a law; terms: of a series law (Ogden, 1 to 3).

    A law without a file here is searched in its small-strain moduli. ValueError names the laws there are.
    """
    if law not in laws.names():  # of others, the small-strain moduli need not be all there is to search
        raise ValueError(f"law: expected one of {', '.join(laws.names())}, got {law!r}")
    return _OWN[law](terms) if law in _OWN else two_moduli(law)


__all__ = ["Coordinate", "Parametrisation", "parametrisation"]
