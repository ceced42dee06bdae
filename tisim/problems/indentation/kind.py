"""Indentation (`tisim.Poke`) as a kind of scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

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
from tisim.bodies import Block, Inclusion, Rod, Vector
from tisim.course import Course
from tisim.mesh import ElementKind
from tisim.mesh.indentation import check_indentation
from tisim.parts import FIELDS
from tisim.problems._checks import check_course, check_mesh, check_static
from tisim.problems._registry import OnStep, SceneKind
from tisim.problems.indentation.turning import axis_at
from tisim.result import Result
from tisim.scene import Poke

if TYPE_CHECKING:  # scipy is imported when a scene is solved
    from tisim.discretisation.body import Discretisation

Array = NDArray[np.float64]

STEEPEST = 45.0  # largest angle of the rod's direction from the normal [degrees]
SECONDS = 10.0  # cost of a scene with the default mesh [core-s]
ELEMENT: ElementKind = "hex20"  # the element type "default"
# Version of the contact, raised when its pressure, its friction or its points change; a dataset has one only.
CONTACT = 4
SAME = 1e-9  # difference below which two depths are equal [m]


def check(scene: Poke) -> None:
    check_course(scene, start=0.0, instead_of=("depth", "retract_to", "frame_spacing"))
    if scene.course is None:
        # a shorter way has no step, and so would end well without a frame
        check_number("depth", scene.depth, f"a length above {SAME:g} m", lambda v: v > SAME)
        if scene.turns:
            raise FieldError("turns", "none without a course", scene.turns)
    else:
        for value in scene.course.values:
            check_not_negative("course.values", value, "depths of 0 m or more")
        if not max(scene.course.values) > 0.0:
            raise FieldError("course.values", "a depth above 0 m", scene.course.values)
        from tisim.problems.indentation.course import without_course

        _check_turns(scene, scene.course)
        scene = without_course(scene)
    _check_block(scene.block)
    _check_rod(scene.rod)
    check_vector("site", scene.site, 2)
    check_length("depth", scene.depth)
    check_mesh(scene.mesh, node_sets=("base",), facet_sets=("top",))
    if scene.mesh is not None and scene.mesh.symmetry:
        raise FieldError("mesh", "a whole body (tisim.mesh.unfold makes it whole)", scene.mesh.symmetry)
    if scene.mesh is not None and scene.block.inclusion is not None:
        wanted = "none beside a mesh, which has its own (tisim.mesh.block_around makes such a mesh)"
        raise FieldError("block.inclusion", wanted, scene.block.inclusion)
    low, high = body_bounds(scene)
    if not all(a < at < b for a, at, b in zip(low, scene.site, high, strict=False)):
        raise FieldError("site", f"a place on the top ({_sides(low, high)})", scene.site)
    for name, direction in [("direction", scene.direction), *(("turns", way) for _, way in scene.turns)]:
        _check_way(scene, name, direction)
    if scene.retract_to is not None:
        what = f"a depth [m] from 0 to {SAME:g} less than the {scene.depth:g} m asked for, or None"
        check_number("retract_to", scene.retract_to, what, lambda v: 0.0 <= v < scene.depth - SAME)
    check_not_negative("friction", scene.friction)
    check_length("frame_spacing", scene.frame_spacing)
    check_choice("element", scene.element, ("default", "tet4", "tet10", "hex8", "hex20"))
    check_positive("refinement", scene.refinement)
    check_vector("gravity", scene.gravity)
    check_static(scene.solver, "pokes")
    if scene.mesh is None:
        check_indentation(
            block=scene.block,
            site=scene.site,
            direction=scene.direction,
            rod=scene.rod,
            refinement=scene.refinement,
        )
    else:
        from tisim.problems.indentation.first_touch import FirstTouch, near_facets

        FirstTouch(scene, scene.mesh, near_facets(scene, scene.mesh))


def body_bounds(scene: Poke) -> tuple[Array, Array]:
    """Lowest and highest coordinates (3,) [m] of the block, or of the top and base of the scene's mesh."""
    if scene.mesh is None:
        half = 0.5 * np.asarray(scene.block.size)
        return np.array([-half[0], -half[1], 0.0]), np.array([half[0], half[1], 2.0 * half[2]])
    top = scene.mesh.nodes[np.unique(scene.mesh.facet_sets["top"])]
    base = scene.mesh.nodes[scene.mesh.node_sets["base"], 2].min()
    return np.array([*top[:, :2].min(axis=0), base]), top.max(axis=0)


def _sides(low: Array, high: Array) -> str:
    x, y = (f"{1e3 * low[k]:.4g} to {1e3 * high[k]:.4g}" for k in range(2))
    return f"x {x}, y {y} mm"


def _check_turns(scene: Poke, course: Course) -> None:
    for turn in scene.turns:
        if not isinstance(turn, tuple | list) or len(turn) != 2:
            raise FieldError("turns", "pairs of a time [s] and a direction", scene.turns)
        check_number("turns", turn[0], "pairs of a time [s] and a direction", lambda _: True)
    times = [time for time, _ in scene.turns]
    rising = all(b > a for a, b in zip([0.0, *times], times, strict=False))
    if not rising or any(course.end_at(time) is None for time in times):
        wanted = f"rising times above 0 s at which a piece of the course ends, {course.times}"
        raise FieldError("turns", wanted, tuple(times))


def _check_way(scene: Poke, name: str, direction: Vector) -> None:
    """Refuse a direction that is too oblique, or in which the rod would leave the block at the full depth."""
    check_vector(name, direction)
    size = float(np.linalg.norm(direction))
    angle = np.degrees(np.arccos(np.clip(-direction[2] / size, -1.0, 1.0))) if size > 0 else 180.0
    if angle > STEEPEST + 1e-6:
        raise FieldError(name, f"a push within {STEEPEST:g} degrees of (0, 0, -1)", direction)
    low, high = body_bounds(scene)
    height = float(high[2] - low[2])
    if scene.depth * np.cos(np.radians(angle)) >= height:
        raise FieldError("depth", f"less than the body's height of {height:g} m", scene.depth)
    out = leaves(scene, direction, scene.depth)
    if out is not None:
        wanted = (
            f"a path within the body's sides ({_sides(low, high)}), which at {1e3 * scene.depth:.3g} mm of"
            f" depth is at x = {1e3 * out[0]:.3g}, y = {1e3 * out[1]:.3g} mm"
        )
        raise FieldError(name, wanted, direction)


def leaves(scene: Poke, direction: Vector, depth: float) -> tuple[float, float] | None:
    """End (x, y) [m] of a path from the contact point along `direction` to a depth [m], if off the body.

    None if it is within the body's sides.
    """
    size = float(np.linalg.norm(direction))
    x, y = (scene.site[k] + depth * direction[k] / size for k in range(2))
    low, high = body_bounds(scene)
    inside = all(a <= at <= b for a, at, b in zip(low, (x, y), high, strict=False))
    return None if inside else (x, y)


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
    return tuple(FIELDS)


def seconds(scene: Poke) -> float:
    return SECONDS * scene.refinement**3


def solve(scene: Poke, on_step: OnStep) -> Result:
    from tisim.problems.indentation.solve import solve_poke

    return solve_poke(scene, on_step=on_step)


def describe(result: Result, frame: int) -> str:
    scene = result.scene
    assert isinstance(scene, Poke)
    assert result.rod_force is not None
    axis = axis_at(scene, 0.0 if result.time is None else float(result.time[frame]))
    down = abs(float(axis[2]))
    angle = np.degrees(np.arccos(min(down, 1.0)))
    force = float(np.linalg.norm(result.rod_force[frame]))
    return f"Poke to {result.load[frame] * 1e3:.1f} mm at {angle:.0f}°, {force:.2f} N"


def discretise(result: Result, frame: int) -> Discretisation:
    """Discretisation of a frame; for hex8, tetrahedral parts are reconstructed from the frames up to it."""
    from tisim.discretisation.body import Discretisation
    from tisim.discretisation.quadrature import TetrahedralParts

    found = Discretisation.build(result.mesh, result.mesh.node_sets["base"])
    if result.mesh.kind == "hex8":
        parts = TetrahedralParts(result.mesh, found.reference)
        way = np.diff(result.load, prepend=0.0)
        for back, x in zip(way[: frame + 1] < 0.0, result.positions, strict=False):
            parts.may_recover = bool(back) or bool(result.scene.turns)
            parts.update(x)
    return found


KIND = SceneKind(
    scene=Poke,
    check=check,
    takes=takes,
    seconds=seconds,
    solve=solve,
    describe=describe,
    discretise=discretise,
)
