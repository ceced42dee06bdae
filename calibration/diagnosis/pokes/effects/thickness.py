"""The block is higher, or lower, than believed: its base is further from the rod, or nearer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.diagnosis.pokes.effects._effect import PokeEffect
from tisim import Mesh, Poke

PART = 0.2  # of the height, between the simulated blocks


def _scene(poke: Poke, mesh: Mesh | None, amplitude: float, kind: float | None) -> Poke:
    """On the same mesh, stretched: new elements would hide a small change."""
    del kind
    part = 1.0 + amplitude
    size = poke.block.size
    block = replace(poke.block, size=(size[0], size[1], part * size[2]))
    moved = None if mesh is None else replace(mesh, nodes=mesh.nodes * np.array([1.0, 1.0, part]))
    return replace(poke, block=block, mesh=moved)


EFFECT = PokeEffect(
    name="thickness",
    parameter="excess_percent",
    per_unit=100.0,
    belongs_to="specimen",
    step=0.005,
    bounds=(-2.0 * PART, 2.0 * PART),
    plausible=2.0 * PART,
    sentence="the block is thicker, or thinner, than believed",
    remedy="measure the block with callipers",
    scene=_scene,
    nodes=(-2.0 * PART, -PART, 0.0, PART, 2.0 * PART),
    chord=PART,
    finer=True,
    touches=lambda record: record.geometry.block.inclusion is None,
    reach="block",
)
