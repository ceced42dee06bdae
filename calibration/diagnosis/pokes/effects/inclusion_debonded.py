"""The inclusion does not hold the soft material around it: the block answers in part as if it were soft all
over.

The part is the amplitude; 1 is the block without its inclusion, which is softer than any loose one. Between
the two the force is taken to be straight in the part: how a gap opens and closes is not simulated.
"""

from __future__ import annotations

from dataclasses import replace

from calibration.diagnosis.pokes.effects._effect import PokeEffect
from tisim import Mesh, Poke


def _scene(poke: Poke, mesh: Mesh | None, amplitude: float, kind: float | None) -> Poke:
    del mesh, amplitude, kind
    return replace(poke, block=replace(poke.block, inclusion=None))


EFFECT = PokeEffect(
    name="inclusion-debonded",
    parameter="loose_part",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.01,
    bounds=(0.0, 1.0),
    ends=(1.0,),
    plausible=1.0,
    sentence="the soft material has come off the inclusion",
    remedy="pull at the surface above the inclusion, or poke a place far from it",
    scene=_scene,
    nodes=(0.0, 1.0),
    chord=1.0,
    touches=lambda record: record.geometry.block.inclusion is not None,
    reach="material",
)
