"""Pokes that differ only by a factor of the moduli share one solve.

Without gravity and without time the moduli are the only stresses of the scene: the energies W(F) and s W(F)
give the same displacements, and forces in the ratio s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from factory.plan.poke import PlannedPoke
from tisim import Material, Poke, laws

# relative tolerance on moduli: cards hold five digits, and the error of the simulated force is larger
ROUNDED = 1e-4


def modulus_ratio(material: Material, other: Material) -> float | None:
    """Ratio of the stress of `material` to that of `other`; None if it depends on the deformation.

    The ratio exists if every parameter in Pa differs by the same factor, to `ROUNDED`, and every other one is
    equal. Materials with parts beside their law have none.
    """
    if material.law != other.law or material.has_parts or other.has_parts:
        return None
    law = laws.get(material.law)
    factor = law.moduli(material.parameters).shear_modulus / law.moduli(other.parameters).shear_modulus
    for name, (unit, _) in law.parameters.items():
        own, its = (np.atleast_1d(np.asarray(m.parameters[name], float)) for m in (material, other))
        scale, slack = (factor, ROUNDED) if unit == "Pa" else (1.0, 0.0)
        if own.shape != its.shape or not np.allclose(own, scale * its, rtol=slack, atol=0.0):
            return None
    return factor


def scale_with_modulus(scenes: Sequence[Poke]) -> bool:
    """True if all material levels give equal displacements, with forces proportional to the shear modulus."""
    first = scenes[0].material
    materials = {id(scene.material): scene.material for scene in scenes}.values()
    if any(scene.course is not None or any(scene.gravity) for scene in scenes):
        return False
    return all(modulus_ratio(material, first) is not None for material in materials)


def one_solve(pokes: Sequence[PlannedPoke]) -> tuple[PlannedPoke, ...]:
    """Assign to each poke the first poke with the same displacements, and the ratio of their forces."""
    first: dict[tuple[int, int], list[PlannedPoke]] = {}
    found = []
    for poke in pokes:
        known = first.setdefault((poke.shape, poke.seed), [])
        for other in known:
            factor = _alike(poke.scene, other.scene)
            if factor is not None:
                found.append(replace(poke, solved_as=other.index, force_factor=factor))
                break
        else:
            known.append(poke)
            found.append(poke)
    return tuple(found)


def _alike(scene: Poke, other: Poke) -> float | None:
    if scene.course is not None or any(scene.gravity) or replace(scene, material=other.material) != other:
        return None
    return modulus_ratio(scene.material, other.material)
