"""Beams as a kind of scene: static beams are solved in chains, dynamic beams one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tisim._checks import (
    FieldError,
    check_choice,
    check_length,
    check_not_negative,
    check_number,
    check_type,
    check_vector,
    check_whole,
    check_within,
)
from tisim.bodies import Circle, Rectangle
from tisim.mesh import Mesh
from tisim.parts import FIELDS
from tisim.problems._checks import check_course, check_mesh
from tisim.problems._registry import OnStep, SceneKind
from tisim.problems._stops import shortest_time
from tisim.problems.beam.rest_shape import is_ideal, is_planar, skin_profile
from tisim.result import Result
from tisim.scene import Beam, ClampImperfections, Imperfections, Void

if TYPE_CHECKING:  # scipy is imported when a scene is solved
    from numpy.typing import NDArray

    from tisim.discretisation.body import Discretisation

MOST_LOSS = 0.95  # largest loss of stiffness or weight anywhere in a beam, as a fraction
MOST_TILT = 0.8  # of a clamp [rad]
SIDEWAYS = 0.05  # part of a load along y that a clamp which turns about y may bear
SECONDS_PER_NODE = 5e-5  # of a static beam [core-s]
SECONDS_DYNAMIC = 20.0


def check(scene: Beam) -> None:
    check_length("grip_length", scene.grip_length)
    check_type("section", scene.section, (Circle, Rectangle))
    if isinstance(scene.section, Circle):
        check_length("section.radius", scene.section.radius)
    else:
        check_length("section.width", scene.section.width)
        check_length("section.height", scene.section.height)
    check_choice("supports", scene.supports, ("clamped-free", "clamped-clamped"))
    check_vector("gravity", scene.gravity)
    check_vector("tip_force", scene.tip_force)
    check_not_negative("tip_mass", scene.tip_mass, "a mass of 0 kg or more")
    check_choice("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    check_length("axial_element_size", scene.axial_element_size)
    check_whole("radial_elements", scene.radial_elements)
    pulled = any(scene.tip_force)
    if pulled and scene.supports == "clamped-clamped":
        raise FieldError("tip_force", "no force on a beam that is clamped at both ends", scene.tip_force)
    if scene.tip_mass and scene.supports == "clamped-clamped":
        raise FieldError("tip_mass", "no mass on a beam that is clamped at both ends", scene.tip_mass)
    check_mesh(scene.mesh, node_sets=scene.held, facet_sets=("tip",) if pulled or scene.tip_mass else ())
    check_length("length", scene.length)  # after the mesh, from which it may have been derived
    if scene.mesh is not None:
        _check_own_mesh(scene, scene.mesh)
    _check_imperfections(scene)
    _check_clamps(scene)
    _check_course(scene)
    if scene.solver.method != "static" and not is_ideal(scene):
        wanted = "static, the only one offered where the specimen or the clamps are not ideal"
        raise FieldError("solver.method", wanted, scene.solver.method)


NEAR = 1e-3  # of the length: a clamp's face may be so far from where it is expected


def _check_own_mesh(scene: Beam, mesh: Mesh) -> None:
    """Refuse a mirror plane that the loads break, and a place that imperfections are not measured from."""
    fibres = None if scene.material.fibres is None else np.abs(scene.material.fibres.axis())
    for name in mesh.symmetry:
        k = "xyz".index(name)
        oblique = fibres is not None and 1e-9 < fibres[k] < 1.0 - 1e-9
        if scene.gravity[k] or scene.tip_force[k] or oblique:
            crossed = f"gravity, tip force or fibres cross its mirror plane {name}"
            wanted = f"a whole body (tisim.mesh.unfold), since {crossed}"
            raise FieldError("mesh", wanted, mesh.symmetry)
    if is_ideal(scene):
        return
    used = mesh.nodes[np.unique(mesh.elements), 0]
    near = float(mesh.nodes[mesh.node_sets["clamp"], 0].max())
    far = float(used.max() if len(scene.held) == 1 else mesh.nodes[mesh.node_sets["far_clamp"], 0].min())
    if max(abs(near), abs(far - scene.length)) > NEAR * scene.length:
        wanted = (
            f"a beam from its clamp's face at x = 0 to x = {scene.length:g} m, its length, since the"
            " imperfections of specimen and clamps are measured from there"
        )
        raise FieldError("mesh", wanted, (near, far))


def _check_course(scene: Beam) -> None:
    if not is_static(scene):
        if scene.course is not None:
            raise FieldError("course", "None for a dynamic beam, released at time 0", scene.course)
        if scene.solver.until_rest and scene.material.viscosity is not None:
            raise FieldError("solver.until_rest", "False for a viscous beam, which goes on creeping", True)
        return
    check_course(scene, start=0.0)
    if scene.course is None:
        if scene.material.softening is not None:
            raise FieldError("course", "a tisim.Course, since the material softens", scene.course)
        return
    if is_ideal(scene):
        return
    if scene.course.times[0] != 0.0 or scene.course.values[0] != 1.0:
        wanted = "the whole load at once, jump(1.0), where the specimen or the clamps are not ideal"
        raise FieldError("course.values", wanted, scene.course.values)


def takes(scene: Beam) -> tuple[str, ...]:
    return ("fibres",) if scene.solver.method == "explicit" else tuple(FIELDS)


def _check_imperfections(scene: Beam) -> None:
    s = scene.imperfections
    check_type("imperfections", s, (Imperfections,))
    b, h = scene.section.half_width, scene.section.half_height
    # the arc is shorter than a semicircle and does not fold inside; sizes and moduli stay well above 0
    check_within("imperfections.curvature", s.curvature, min(3.0 / scene.length, 0.5 / h), " /m on this beam")
    along = MOST_LOSS / (0.5 * scene.length)
    check_within("imperfections.taper", s.taper, 0.5 / (0.5 * scene.length), " /m on this beam")
    check_within("imperfections.axial_gradient", s.axial_gradient, along, " /m on this beam")
    check_within("imperfections.density_gradient", s.density_gradient, along, " /m on this beam")
    check_within(
        "imperfections.transverse_gradient", s.transverse_gradient, MOST_LOSS / h, " /m on this beam"
    )
    check_number(
        "imperfections.skin_thickness",
        s.skin_thickness,
        f"a length above 0 and up to half the section, {min(b, h):g} m",
        lambda v: 0.0 < v <= min(b, h),
    )
    check_number(
        "imperfections.skin", s.skin, f"a number not below -{MOST_LOSS:g}", lambda v: v >= -MOST_LOSS
    )
    c0, cy, cz = skin_profile(scene)
    lowest = c0 + min(cy, 0.0) + min(cz, 0.0)
    if isinstance(scene.section, Circle):
        lowest = c0 + min(cy, cz, 0.0)
    if lowest < 1.0 - MOST_LOSS:
        wanted = "a skin whose stiffness a quadratic of y and z can stand for (it falls to 0 inside)"
        raise FieldError("imperfections.skin", wanted, s.skin)
    if s.void is None:
        return
    check_type("imperfections.void", s.void, (Void,))
    check_number(
        "imperfections.void.position",
        s.void.position,
        f"a place on the beam, 0 to {scene.length:g} m",
        lambda v: 0.0 <= v <= scene.length,
    )
    check_length("imperfections.void.length", s.void.length)
    check_number(
        "imperfections.void.edge",
        s.void.edge,
        f"a length above 0 and at most the void's, {s.void.length:g} m",
        lambda v: 0.0 < v <= s.void.length,  # type: ignore[union-attr]
    )
    check_number(
        "imperfections.void.fraction",
        s.void.fraction,
        f"a part between 0 and {MOST_LOSS:g}",
        lambda v: 0.0 <= v <= MOST_LOSS,
    )


def _check_clamps(scene: Beam) -> None:
    c = scene.clamp_imperfections
    check_type("clamp_imperfections", c, (ClampImperfections,))
    check_within("clamp_imperfections.tilt", c.tilt, MOST_TILT, " rad")
    check_within("clamp_imperfections.far_tilt", c.far_tilt, MOST_TILT, " rad")
    check_vector("clamp_imperfections.far_shift", c.far_shift, 2)
    if max(abs(v) for v in c.far_shift) > 0.5 * scene.length:
        raise FieldError(
            "clamp_imperfections.far_shift",
            f"less than half the length, {0.5 * scene.length:g} m",
            c.far_shift,
        )
    if scene.supports == "clamped-free" and (c.far_tilt or any(c.far_shift)):
        name, value = ("far_tilt", c.far_tilt) if c.far_tilt else ("far_shift", c.far_shift)
        raise FieldError(f"clamp_imperfections.{name}", "0 on a beam without a far clamp", value)
    check_not_negative("clamp_imperfections.compliance", c.compliance, "a compliance of 0 rad/(N m) or more")
    sideways = [abs(v[1]) > SIDEWAYS * float(np.linalg.norm(v)) for v in (scene.gravity, scene.tip_force)]
    if c.compliance and any(sideways):
        wanted = "0 where gravity or tip force act along y, since the clamps turn about y alone"
        raise FieldError("clamp_imperfections.compliance", wanted, c.compliance)
    check_number(
        "clamp_imperfections.squeeze", c.squeeze, "a part between 0 and 0.5", lambda v: 0.0 <= v <= 0.5
    )


def is_static(scene: Beam) -> bool:
    return scene.solver.method == "static"


def mesh_key(scene: Beam) -> tuple[Any, ...] | None:
    if not is_static(scene):
        return None
    size = (scene.axial_element_size, scene.radial_elements)
    return ("beam", scene.length, scene.section, scene.supports, scene.element, *size, is_planar(scene))


def seconds(scene: Beam) -> float:
    if not is_static(scene):
        return SECONDS_DYNAMIC
    if scene.mesh is not None:
        return SECONDS_PER_NODE * scene.mesh.n_nodes
    steps = (
        1.0 if scene.course is None else 1.0 + 0.3 * len(scene.course.stops(shortest_time(scene.material)))
    )
    nodes = steps * 70.0 * scene.length / scene.axial_element_size * (scene.radial_elements / 2.0) ** 2
    return SECONDS_PER_NODE * nodes


def solve(scene: Beam, on_step: OnStep) -> Result:
    if is_static(scene):
        return next(solve_chain([scene], on_step))
    from tisim.problems.dynamics.solve import solve_dynamic

    return solve_dynamic(scene, on_step=on_step)


def solve_chain(scenes: Sequence[Beam], _: OnStep) -> Iterator[Result]:
    from tisim.problems.beam.solve import solve_beams

    return solve_beams(scenes)


def describe(result: Result, _: int) -> str:
    scene = result.scene
    assert isinstance(scene, Beam)
    name = "Cantilever" if scene.supports == "clamped-free" else "Bridge"
    return f"{name} of {scene.length * 1e3:.0f} mm"


def discretise(result: Result, _: int) -> Discretisation:
    from tisim.problems.beam.rest_shape import specimen_discretisation
    from tisim.problems.beam.system import beam_discretisation

    return specimen_discretisation(result.scene, beam_discretisation(result.scene))


def rest(result: Result) -> NDArray[np.float64]:
    from tisim.problems.beam.rest_shape import rest_positions

    return rest_positions(result.scene, result.mesh)


KIND = SceneKind(
    scene=Beam,
    check=check,
    takes=takes,
    mesh_key=mesh_key,
    chained=is_static,
    seconds=seconds,
    solve=solve,
    solve_chain=solve_chain,
    describe=describe,
    discretise=discretise,
    rest=rest,
)
