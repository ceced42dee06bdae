"""Rod and block rub less (or more) than believed: the surface slides along the rod's tip."""

from __future__ import annotations

from dataclasses import replace

from calibration.diagnosis.pokes._geometry import FRICTION
from calibration.diagnosis.pokes.effects._effect import PokeEffect
from tisim import Mesh, Poke

NONE, LITTLE = -FRICTION, -0.5


def _scene(poke: Poke, mesh: Mesh | None, amplitude: float, kind: float | None) -> Poke:
    del kind
    return replace(poke, friction=max(0.0, FRICTION + amplitude), mesh=mesh)


EFFECT = PokeEffect(
    name="friction",
    parameter="coefficient_above_0.6",
    per_unit=1.0,
    belongs_to="rig",
    step=0.01,
    bounds=(-FRICTION, 0.4),
    ends=(-FRICTION,),
    plausible=FRICTION,
    starts=1.0,  # most of what it does it does near its bound
    sentence="rod and block rub less, or more, than believed",
    remedy="powder the rod, or glue sandpaper on it, and poke the same place again",
    scene=_scene,
    # from 0.4 on hardly anything slides
    nodes=(NONE, LITTLE, -0.35, 0.0, 0.4),
    # free of friction a rod loses no force on the way back, with a little it does
    kinds=lambda _: (LITTLE, NONE),
    kind_label=lambda kind: "some slip" if kind == LITTLE else "free slip",
    chords=True,
    straight=True,
    finer=True,
    back=True,
    reach="rig",
)
