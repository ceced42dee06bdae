"""The material that effects make of a neo-Hookean one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from factory.errors import InputError
from factory.extension import TAKEN, CardEffect
from tisim import Material, Moduli, laws, material_from_moduli

BASE = "neo-hookean"  # the law that extensions are found on


def extended(material: Material, effects: Sequence[CardEffect], name: str) -> Material:
    """A neo-Hookean material with those of its effects that go with it into any body; name: the mixture's.

    InputError names the key where there is no such material.
    """
    for number, effect in enumerate(effects):
        if effect.left_out(name):
            continue
        key, parameter = f"key effects.{number}", TAKEN[effect.effect][0]
        if effect.base_law != BASE:
            raise InputError(f"{key}.base_law: expected {BASE}, got {effect.base_law}")
        if set(effect.parameters) != {parameter}:
            raise InputError(f"{key}.parameters: expected {parameter} of {effect.effect}, and no other")
        try:
            material = _with(material, effect.effect, effect.parameters[parameter].value)
            laws.get(material.law).check(material.parameters)
        except ValueError as error:
            raise InputError(f"{key}.parameters.{parameter}.value: {effect.effect}: {error}") from None
    return material


def _with(material: Material, effect: str, value: float) -> Material:
    law = laws.get(material.law)
    moduli = law.moduli(material.parameters)
    if effect == "density":
        if not value > -1.0:
            raise ValueError(f"expected a value above -1, got {value:g}")
        return replace(material, density=material.density * (1.0 + value))
    if effect == "compressibility":
        # what the law has without a unit, a stiffening or a locking stretch, stays
        scaled = law.from_moduli(moduli.shear, _bulk(moduli, value))
        own = {n: material.parameters[n] for n in law.parameters if n not in ("lam", "bulk")}
        return replace(material, parameters={**scaled, **own})
    if effect == "creep":
        return material
    if material.law != BASE:
        raise ValueError(f"asks for another law than {material.law}, which another effect asks for: keep one")
    return replace(_in_law(material, effect, value), density=material.density)


def _bulk(moduli: Moduli, drop: float) -> float:
    """Bulk modulus [Pa] with Poisson's ratio lower by `drop`."""
    g, k = moduli.shear, moduli.bulk
    nu = (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g) - drop
    if not -1.0 < nu < 0.5:
        raise ValueError(f"leaves a Poisson ratio of {nu:.3g}, expected one between -1 and 0.5")
    return 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))


def _in_law(material: Material, effect: str, value: float) -> Material:
    """A neo-Hookean material with a constant more, at the same small-strain moduli."""
    moduli = laws.get(material.law).moduli(material.parameters)
    g, k = moduli.shear, moduli.bulk
    if effect == "strain-stiffening":
        return Material(law="yeoh", parameters={"mu": g, "stiffening": value, "bulk": k})
    if effect == "second-invariant":
        constants = {"c10": 0.5 * g * (1.0 - value), "c01": 0.5 * g * value}
        return Material(law="mooney-rivlin", parameters={**constants, "bulk": k})
    if not 0.0 < value < 1.0:
        raise ValueError(f"expected a value between 0 and 1, got {value:g}")
    return Material(law="eight-chain", parameters={"mu": g, "locking": value**-0.5, "bulk": k})


def in_one_law(materials: Mapping[str, Material]) -> dict[str, Material]:
    """All in one law, since a dataset has one set of parameters: those that stayed neo-Hookean beside one
    that stiffens get its law, with no stiffening. InputError where several laws cannot be one."""
    asked = {m.law: name for name, m in materials.items()}
    if len(asked) == 1:
        return dict(materials)
    if set(asked) != {BASE, "yeoh"}:
        (law, name), (other, second), *_ = asked.items()
        raise InputError(
            f"softness {name} asks for the law {law} and {second} for {other}, which one dataset cannot hold:"
            " build them apart, or delete key effects of a card to leave its extension out"
        )
    found = {}
    for name, m in materials.items():
        moduli = laws.get(m.law).moduli(m.parameters)
        plain = material_from_moduli("yeoh", shear=moduli.shear, bulk=moduli.bulk, density=m.density)
        found[name] = m if m.law == "yeoh" else plain
    return found
