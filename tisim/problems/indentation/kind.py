"""Indentation (`tisim.Poke`) as a kind of scene."""

from __future__ import annotations

import numpy as np

from tisim._checks import (
    FieldError,
    check_choice,
    check_length,
    check_not_negative,
    check_number,
    check_positive,
    check_type,
    check_vector,
)
from tisim.bodies import Block, Inclusion, Rod
from tisim.mesh.indentation import check_indentation
from tisim.problems._checks import check_course, check_mesh, check_static
from tisim.problems._registry import OnStep, SceneKind
from tisim.result import Result
from tisim.scene import Poke

STEEPEST = 45.0  # of a push against the normal [degrees]
SECONDS = 10.0  # of a default poke [core-s]


def check(scene: Poke) -> None:
    check_course(scene, start=0.0, instead_of=("depth", "retract_to", "frame_spacing"))
    if scene.course is not None:
        for value in scene.course.values:
            check_not_negative("course.values", value, "depths of 0 m or more")
        if not max(scene.course.values) > 0.0:
            raise FieldError("course.values", "a depth above 0 m", scene.course.values)
        from tisim.problems.indentation.course import without_course

        scene = without_course(scene)
    _check_block(scene.block)
    _check_rod(scene.rod)
    check_vector("site", scene.site, 2)
    inside = np.abs(np.asarray(scene.site)) < 0.5 * np.asarray(scene.block.size[:2])
    if not inside.all():
        raise FieldError("site", f"a place on the block's top, {scene.block.size[:2]} m large", scene.site)
    check_vector("direction", scene.direction)
    size = float(np.linalg.norm(scene.direction))
    angle = np.degrees(np.arccos(np.clip(-scene.direction[2] / size, -1.0, 1.0))) if size > 0 else 180.0
    if angle > STEEPEST + 1e-6:
        raise FieldError("direction", f"a push within {STEEPEST:g} degrees of (0, 0, -1)", scene.direction)
    check_length("depth", scene.depth)
    if scene.depth * np.cos(np.radians(angle)) >= scene.block.size[2]:
        raise FieldError("depth", f"less than the block's height of {scene.block.size[2]:g} m", scene.depth)
    if scene.retract_to is not None:
        what = f"a depth [m] from 0 to less than the {scene.depth:g} m asked for, or None"
        check_number("retract_to", scene.retract_to, what, lambda v: 0.0 <= v < scene.depth)
    check_not_negative("friction", scene.friction)
    check_length("frame_spacing", scene.frame_spacing)
    check_choice("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    check_positive("refinement", scene.refinement)
    check_vector("gravity", scene.gravity)
    check_mesh(scene.mesh, node_sets=("base",), facet_sets=("top",))
    check_static(scene.solver, "pokes")
    if scene.mesh is None:
        check_indentation(
            block=scene.block,
            site=scene.site,
            direction=scene.direction,
            rod=scene.rod,
            refinement=scene.refinement,
        )


def _check_block(block: Block) -> None:
    check_type("block", block, (Block,))
    check_vector("block.size", block.size)
    for value in block.size:
        check_length("block.size", value)
    body = block.inclusion
    if body is None:
        return
    check_type("block.inclusion", body, (Inclusion,))
    try:
        body.check()
    except FieldError as bad:
        raise bad.within("block.inclusion") from None


def _check_rod(rod: Rod) -> None:
    check_type("rod", rod, (Rod,))
    check_length("rod.radius", rod.radius)
    check_length("rod.length", rod.length)
    check_choice("rod.tip", rod.tip, ("flat", "hemisphere"))
    check_length("rod.edge_radius", rod.edge_radius)
    if rod.tip == "flat" and rod.edge_radius > rod.radius:
        raise FieldError("rod.edge_radius", f"at most the rod's radius of {rod.radius:g} m", rod.edge_radius)


def takes(_: Poke) -> tuple[str, ...]:
    return "viscosity", "softening", "fibres"


def seconds(scene: Poke) -> float:
    return SECONDS * scene.refinement**3


def solve(scene: Poke, on_step: OnStep) -> Result:
    from tisim.problems.indentation.solve import solve_poke

    return solve_poke(scene, on_step=on_step)


def describe(result: Result, frame: int) -> str:
    scene = result.scene
    assert isinstance(scene, Poke)
    assert result.rod_force is not None
    down = abs(scene.direction[2]) / float(np.linalg.norm(scene.direction))
    angle = np.degrees(np.arccos(min(down, 1.0)))
    force = float(np.linalg.norm(result.rod_force[frame]))
    return f"Poke to {result.load[frame] * 1e3:.1f} mm at {angle:.0f}°, {force:.2f} N"


KIND = SceneKind(scene=Poke, check=check, takes=takes, seconds=seconds, solve=solve, describe=describe)
