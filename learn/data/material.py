"""Small-strain shear moduli from the parameters that a store holds."""

from __future__ import annotations

from collections.abc import Mapping

from learn.errors import InputError

# weights of I1^i in the five-term series (Arruda and Boyce, J. Mech. Phys. Solids 41, 1993)
_ARRUDA_BOYCE = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


def shear_modulus(law: str, parameters: Mapping[str, float]) -> float:
    """The law's shear modulus at small strain [Pa].

    parameters: by name as in the store's attribute `parameter_names` (mu_1, mu_2, ... where a parameter
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
            raise InputError(f"law {law}: its shear modulus is not known here")
    except KeyError as error:
        raise InputError(f"law {law}: expected a parameter {error.args[0]}") from None
    if not value > 0:
        raise InputError(f"law {law}: expected a positive shear modulus, got {value:g} Pa")
    return float(value)
