"""The rigid inclusion lies elsewhere than believed: higher, or aside along x or y."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import PokeEffect
from tisim import Mesh, Poke

X, Y, Z = 0.0, 1.0, 2.0
STEP = 1.5e-3  # [m]


def _scene(poke: Poke, mesh: Mesh | None, amplitude: float, kind: float | None) -> Poke:
    """Meshed anew: its outline is met by other cells, which the mesh's error covers."""
    del mesh
    inclusion = poke.block.inclusion
    assert inclusion is not None
    centre = np.asarray(inclusion.centre) + amplitude * np.eye(3)[int(kind or 0.0)]
    moved = replace(inclusion, centre=(float(centre[0]), float(centre[1]), float(centre[2])))
    return replace(poke, block=replace(poke.block, inclusion=moved))


def _kinds(records: Sequence[Record]) -> tuple[float | None, ...]:
    """Aside only where pokes at several places tell."""
    sites = {r.geometry.site for r in records if r.geometry.block.inclusion is not None}
    return (X, Y, Z) if len(sites) > 1 else (Z,)


EFFECT = PokeEffect(
    name="inclusion-misplaced",
    parameter="shift_mm",
    per_unit=1e3,
    belongs_to="specimen",
    step=0.1e-3,
    bounds=(-3.0 * STEP, 3.0 * STEP),
    plausible=3.0 * STEP,
    sentence="the inclusion lies elsewhere than believed",
    remedy="poke around the inclusion at several places, or look at it by ultrasound",
    scene=_scene,
    nodes=(-3.0 * STEP, -2.0 * STEP, -STEP, 0.0, STEP, 2.0 * STEP, 3.0 * STEP),
    chord=STEP,
    finer=True,
    kinds=_kinds,
    kind_label=lambda kind: f"along {'xyz'[int(kind)]}",
    touches=lambda record: record.geometry.block.inclusion is not None,
    reach="material",
)
