"""Shear moduli at small strain of a dataset's pokes, for any law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def moduli(
    location: str,
    attributes: dict[str, Any],
    parameter: NDArray[Any],
    softness: Ints,
    done: NDArray[np.bool_],
) -> Floats:
    """Shear modulus at small strain of each poke [Pa].

    From the attribute `shear_modulus` (Pa, one per softness level) if the store has it, so that any law can
    be read; else from the law's parameters.
    """
    found = np.full(len(done), np.nan)  # for a poke that was not simulated
    given = attributes.get("shear_modulus")
    if given is not None:
        levels = attributes["softness"]
        if not (
            isinstance(given, list)
            and len(given) == len(levels)
            and all(type(value) in (int, float) and 0 < value < 1e12 for value in given)
        ):
            raise InputError(
                f"{location}: attribute shear_modulus: expected a positive number [Pa] for each of "
                f"{', '.join(levels)}"
            )
        found[done] = np.array(given, dtype=float)[softness[done]]
        return found
    names = attributes["parameter_names"]
    rows = parameter.reshape(len(done), -1)
    if rows.shape[1] != len(names):
        raise InputError(
            f"{location}: attribute parameter_names has {len(names)} names, array parameter has "
            f"{rows.shape[1]} columns"
        )
    for poke in np.flatnonzero(done):
        found[poke] = shear_modulus(attributes["model"], dict(zip(names, rows[poke], strict=True)))
    return found


# weights of I1^i in the five-term series (Arruda and Boyce, J. Mech. Phys. Solids 41, 1993)
_ARRUDA_BOYCE = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


def shear_modulus(law: str, parameters: Mapping[str, float]) -> float:
    """The law's shear modulus at small strain [Pa].

    `parameters` have the names of the store's attribute `parameter_names` (mu_1, mu_2, ... if a parameter
    has terms; moduli in Pa). InputError for an unknown law, a missing parameter or a modulus that is not
    positive.
    """
    try:
        if law in ("neo-hookean", "stable-neo-hookean", "st-venant-kirchhoff", "yeoh", "eight-chain"):
            value = parameters["mu"]
        elif law == "mooney-rivlin":
            value = 2 * (parameters["c10"] + parameters["c01"])
        elif law == "ogden":
            terms = sorted(name[3:] for name in parameters if name.startswith("mu_"))
            value = sum(parameters[f"mu_{i}"] * parameters[f"alpha_{i}"] for i in terms) / 2
        elif law == "arruda-boyce":
            square = parameters["locking"] ** 2
            series = sum(2 * (i + 1) * c * (3 / square) ** i for i, c in enumerate(_ARRUDA_BOYCE))
            value = parameters["mu"] * series
        else:
            raise InputError(
                f"law {law}: its parameters are not known here, expected the attribute shear_modulus"
            )
    except KeyError as error:
        raise InputError(f"law {law}: expected a parameter {error.args[0]}") from None
    if not value > 0:
        raise InputError(f"law {law}: expected a positive shear modulus, got {value:g} Pa")
    return float(value)
