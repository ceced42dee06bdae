"""Constants of a law for other moduli, and of the laws that extend the neo-Hookean one by a constant."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from tisim.laws._law import Parameters
from tisim.laws._registry import get

Constants = dict[str, "float | tuple[float, ...]"]
Extension = Literal["yeoh", "mooney-rivlin", "eight-chain"]


def scaled(law: str, parameters: Parameters, factor: float) -> Constants:
    """Parameters for which the energy is `factor` times that of the ones given.

    Parameters
    ----------
    law : str
        Name of a law.
    parameters : mapping
        Parameters of the law.
    factor : float
        Factor of all parameters in Pa [-]; others, such as an exponent, stay.

    Returns
    -------
    dict
        Parameters, in the order given.
    """
    units = {name: unit for name, (unit, _) in get(law).parameters.items()}
    return {
        name: _each(value, lambda x: x * factor) if units[name] == "Pa" else value
        for name, value in parameters.items()
    }


def with_moduli(law: str, parameters: Parameters, *, shear_modulus: float, bulk_modulus: float) -> Constants:
    """Parameters with other small-strain moduli; the shape of the isochoric response stays.

    Constants that depend on the bulk modulus (`bulk`, `lam`) follow from the moduli. The other ones in Pa
    keep their ratios to each other, and those without a unit (a stiffening, an exponent) stay. An unchanged
    shear modulus leaves them as they are, to the last bit.

    Parameters
    ----------
    law : str
        Name of a law.
    parameters : mapping
        Parameters of the law.
    shear_modulus, bulk_modulus : float
        Moduli that are wanted [Pa].

    Returns
    -------
    dict
        Parameters, in the law's order.
    """
    chosen = get(law)
    plain = chosen.from_moduli(shear_modulus, bulk_modulus)
    stiffer = chosen.from_moduli(shear_modulus, 2.0 * bulk_modulus)
    before = chosen.moduli(parameters).shear_modulus

    def moved(x: float) -> float:
        # a constant that is the shear modulus becomes exactly the wanted one
        return x if shear_modulus == before else x / before * shear_modulus

    found: Constants = {}
    for name, (unit, _) in chosen.parameters.items():
        if plain[name] != stiffer[name]:
            found[name] = plain[name]
        else:
            found[name] = _each(parameters[name], moved) if unit == "Pa" else parameters[name]
    return found


def extension(
    law: Extension, amount: float, *, shear_modulus: float, bulk_modulus: float
) -> dict[str, float]:
    """Parameters of a law that extends the neo-Hookean one by one constant, at the same small-strain moduli.

    Parameters
    ----------
    law : "yeoh", "mooney-rivlin" or "eight-chain"
    amount : float
        Size of the extension [-]: the stiffening of Yeoh's law, the share C01 / (C10 + C01) of the
        second invariant, or 1 / L^2 of the chains' locking stretch L.
    shear_modulus, bulk_modulus : float
        Small-strain moduli [Pa].

    Raises
    ------
    ValueError
        For chains that would lock at rest, an amount outside 0 to 1.
    """
    g = shear_modulus
    if law == "yeoh":
        return {"mu": g, "stiffening": amount, "bulk": bulk_modulus}
    if law == "mooney-rivlin":
        return {"c10": 0.5 * g * (1.0 - amount), "c01": 0.5 * g * amount, "bulk": bulk_modulus}
    if not 0.0 < amount < 1.0:
        raise ValueError(f"expected a value between 0 and 1, got {amount:g}")
    return {"mu": g, "locking": amount**-0.5, "bulk": bulk_modulus}


def _each(value: float | tuple[float, ...], change: Callable[[float], float]) -> float | tuple[float, ...]:
    return tuple(change(x) for x in value) if isinstance(value, tuple) else change(value)
