"""Uniaxial compression of a cylinder (`tisim.Press`) as a kind of scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from tisim._checks import (
    FieldError,
    check_choice,
    check_length,
    check_number,
)
from tisim.parts import FIELDS
from tisim.problems._checks import check_course, check_static, check_stretches, oblique_fibres
from tisim.problems._registry import OnStep, SceneKind
from tisim.result import Result
from tisim.scene import Press

SECONDS = 2.0  # cost of a scene with the default mesh [core-s]


def check(scene: Press) -> None:
    check_length("radius", scene.radius)
    check_length("height", scene.height)
    check_choice("platens", scene.platens, ("bonded", "free"))
    check_choice("side", scene.side, ("stick", "stop"))
    check_choice("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    check_number("refinement", scene.refinement, "a number between 0.4 and 8", lambda v: 0.4 <= v <= 8.0)
    check_stretches(scene.stretches, "uniaxial")
    check_course(scene, start=1.0, instead_of=("stretches",))
    if scene.course is not None:
        _check_way(scene)
    steps = np.diff([1.0, *scene.stretches])
    if not ((steps < 0.0).all() or (steps > 0.0).all()):
        raise FieldError("stretches", "stretches all falling from 1, or all rising from 1", scene.stretches)
    if oblique_fibres(scene.material):
        wanted = "a direction along x, y or z, since an eighth of the cylinder stands for all of it"
        raise FieldError("material.fibres.direction", wanted, scene.material.fibres.direction)  # type: ignore[union-attr]
    check_static(scene.solver, "presses")


def _check_way(scene: Press) -> None:
    """Refuse side "stick" for a bonded cylinder that is unloaded: its side would never lift off again.

    Raises FieldError also if a stretch of the course is not above 0.
    """
    values = np.array(scene.course.values) if scene.course is not None else np.ones(0)
    check_stretches(tuple(values), "uniaxial")
    before = np.array([1.0, *values[:-1]])
    unloads = bool(((values > before) & (before < 1.0)).any())
    if unloads and scene.platens == "bonded" and scene.side == "stick":
        wanted = (
            "'stop' where a bonded cylinder is unloaded: a side that touched a platen would stick for good"
        )
        raise FieldError("side", wanted, scene.side)


def takes(_: Press) -> tuple[str, ...]:
    return tuple(FIELDS)


def mesh_key(scene: Press) -> tuple[Any, ...]:
    return ("press", scene.radius, scene.height, scene.element, scene.refinement, scene.platens)


def seconds(scene: Press) -> float:
    return SECONDS * scene.refinement**4


def solve(scene: Press, on_step: OnStep) -> Result:
    from tisim.problems.compression.solve import solve_press

    return solve_press(scene, on_step=on_step)


def describe(result: Result, frame: int) -> str:
    scene = result.scene
    assert isinstance(scene, Press)
    assert result.nominal_stress is not None
    stress = result.nominal_stress[frame] * 1e-3
    stretch = result.load[frame]
    return f"Cylinder between {scene.platens} platens, stretch {stretch:.3g}, {stress:.3g} kPa"


KIND = SceneKind(
    scene=Press,
    check=check,
    takes=takes,
    mesh_key=mesh_key,
    seconds=seconds,
    solve=solve,
    describe=describe,
)
