"""A material as scale and shape: the force of a poke is exactly proportional to the one, smooth in the other.

Shape coordinates are those of `calibration.parameters` but the overall modulus, each as the force is most
nearly log-linear in it: G/K in place of K/G (a near-incompressible block's force falls linearly in G/K),
logarithms where the search takes them, and of several shear moduli their logarithms relative to the first.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from calibration.parameters import Coordinate, Parametrisation, parametrisation
from tisim import Material, laws

Array = NDArray[np.float64]

# Step in G/K for a derivative: at least this, a few per cent of force, far above the solver's tolerance.
COMPLIANCE_STEP = 0.02
# Step in other coordinates, in their spread.
STEP = 0.5


def terms(material: Material) -> int:
    """Terms of a series law, 1 for others."""
    return int(np.size(material.parameters["mu"])) if material.law == "ogden" else 1


def coordinates_of(material: Material) -> Parametrisation:
    return parametrisation(material.law, terms=terms(material))


def values(material: Material) -> dict[str, float]:
    """The inverse of a parametrisation: values by coordinate name.

    ValueError for parameters that none of its coordinates gives.
    """
    p, n = material.parameters, terms(material)
    moduli = laws.get(material.law).moduli(p)
    found = {"shear_modulus": moduli.shear, "bulk_ratio": moduli.bulk / moduli.shear}
    if material.law == "mooney-rivlin":
        found["second_share"] = _number(p, "c01") / (_number(p, "c10") + _number(p, "c01"))
    elif material.law == "arruda-boyce":
        found["locking"] = _number(p, "locking")
    elif material.law == "ogden":
        mu, alpha = (np.atleast_1d(np.asarray(p[name], dtype=float)) for name in ("mu", "alpha"))
        del found["shear_modulus"]
        for k in range(n):
            tail = "" if n == 1 else f"_{k + 1}"
            found[f"shear_modulus{tail}"] = float(0.5 * mu[k] * alpha[k])
            found[f"alpha{tail}"] = float(alpha[k])
    wanted = coordinates_of(material)
    if set(wanted.names) != set(found) or any(found[c.name] <= 0.0 for c in wanted.coordinates if c.log):
        raise ValueError(f"{material.law}: expected parameters that its search coordinates can give")
    back = wanted.assemble(found)
    for name, value in back.items():
        if not np.allclose(value, p[name], rtol=1e-6, atol=1e-9 * moduli.shear):
            raise ValueError(f"{material.law}: {name} is not what its search coordinates give")
    return found


def shear(material: Material) -> float:
    """Small-strain shear modulus [Pa]."""
    return laws.get(material.law).moduli(material.parameters).shear


def shape_names(material: Material) -> tuple[str, ...]:
    """Names of the shape coordinates."""
    wanted = coordinates_of(material)
    return tuple(n for n in wanted.names if n not in ("shear_modulus", "shear_modulus_1"))


def shape(material: Material) -> Array:
    """Shape coordinates (n,), in the order of `shape_names`."""
    v = values(material)
    first = v.get("shear_modulus_1", 1.0)
    known = {c.name: c for c in coordinates_of(material).coordinates}
    return np.array([_inside(known[name], v[name], first) for name in shape_names(material)])


def moved(material: Material, name: str) -> Material:
    """The material with one shape coordinate a step further, towards the inside of its range."""
    wanted = coordinates_of(material)
    v = values(material)
    c = next(c for c in wanted.coordinates if c.name == name)
    if name == "bulk_ratio":
        x = 1.0 / v[name]
        step = max(COMPLIANCE_STEP, 0.5 * x)
        v[name] = 1.0 / (x + step if 1.0 / (x + step) >= c.low else 0.5 * x)
    else:
        u, step = c.inside(v[name]), STEP * c.spread
        v[name] = c.value(u + step if c.value(u + step) <= c.high else u - step)
    return Material(law=material.law, parameters=wanted.assemble(v), density=material.density)


def _inside(c: Coordinate, value: float, first_shear: float) -> float:
    if c.name == "bulk_ratio":
        return 1.0 / value
    if c.name.startswith("shear_modulus"):
        return float(np.log(value / first_shear))
    return c.inside(value)


def _number(parameters: Mapping[str, object], name: str) -> float:
    return float(np.asarray(parameters[name], dtype=float))
