"""Whether a scene can be solved at all, said in one sentence before any work is done."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import Any

import numpy as np

from tisim import laws
from tisim._specimen import half_sizes, is_ideal, skin_profile
from tisim.bodies import Block, BoxInclusion, Circle, CylinderInclusion, Rectangle, Rod, SphereInclusion
from tisim.mesh import Mesh
from tisim.scene import Beam, Clamps, Coupon, Material, Poke, Press, Scene, Solver, Specimen, Void

LARGEST = 10.0  # of any length [m]: beyond it somebody wrote millimetres
STEEPEST = 45.0  # of a push against the normal [degrees]
MOST_LOSS = 0.95  # of stiffness or weight, anywhere in a specimen
MOST_TILT = 0.8  # of a clamp [rad]


class _FieldError(Exception):
    """field: where; expected: what was wanted; got: what was there."""

    def __init__(self, field: str, expected: str, got: object) -> None:
        super().__init__(f"{field}: expected {expected}, got {got!r}")


def check_scene(index: int, scene: Scene) -> None:
    """Raise ValueError that names the scene by its place in the list, the field and what is expected."""
    for kind, check in _CHECKS.items():
        if isinstance(scene, kind):
            try:
                _material(scene.material)
                _solver(scene.solver)
                check(scene)
            except _FieldError as bad:
                raise ValueError(f"scene {index}: {kind.__name__}.{bad}") from None
            return
    raise ValueError(f"scene {index}: expected a Beam, Poke, Coupon or Press, got {type(scene).__name__}")


def _number(field: str, value: object, expected: str, good: Callable[[float], bool]) -> None:
    number = isinstance(value, Real) and not isinstance(value, bool)
    if not number or not np.isfinite(float(value)) or not good(float(value)):  # type: ignore[arg-type]
        raise _FieldError(field, expected, value)


def _length(field: str, value: object) -> None:
    _number(field, value, f"a length above 0 and up to {LARGEST:g} m", lambda v: 0.0 < v <= LARGEST)


def _positive(field: str, value: object, what: str = "a number above 0") -> None:
    _number(field, value, what, lambda v: v > 0.0)


def _not_negative(field: str, value: object, what: str = "a number not below 0") -> None:
    _number(field, value, what, lambda v: v >= 0.0)


def _vector(field: str, value: Any, size: int = 3) -> None:
    try:
        good = np.shape(value) == (size,) and bool(np.isfinite(np.asarray(value, dtype=float)).all())
    except (TypeError, ValueError):
        good = False
    if not good:
        raise _FieldError(field, f"{size} finite numbers", value)


def _whole(field: str, value: object) -> None:
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
        raise _FieldError(field, "a whole number of at least 1", value)


def _one_of(field: str, value: object, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise _FieldError(field, f"one of {', '.join(choices)}", value)


def _a(field: str, value: object, kinds: tuple[type, ...]) -> None:
    if not isinstance(value, kinds):
        raise _FieldError(field, " or ".join(kind.__name__ for kind in kinds), type(value).__name__)


def _material(material: Material) -> None:
    _a("material", material, (Material,))
    _one_of("material.law", material.law, laws.all_names())
    _positive("material.density", material.density, "a density above 0 kg/m3")
    try:
        laws.get(material.law).check(material.parameters)
        # the packing has rules of its own (exponents other than zero)
        laws.get(material.law).pack(material.parameters)
    except (ValueError, TypeError) as error:
        raise _FieldError(
            "material.parameters", f"a sound set ({error})", dict(material.parameters)
        ) from None


def _solver(solver: Solver) -> None:
    _a("solver", solver, (Solver,))
    _one_of("solver.method", solver.method, ("static", "implicit", "explicit"))
    _number("solver.tolerance", solver.tolerance, "a number between 0 and 1", lambda v: 0.0 < v < 1.0)
    _positive("solver.duration", solver.duration, "a time above 0 s")
    _positive("solver.time_step", solver.time_step, "a time above 0 s")
    _not_negative("solver.mass_damping", solver.mass_damping)
    _not_negative("solver.stiffness_damping", solver.stiffness_damping)
    _whole("solver.max_iterations", solver.max_iterations)


def _mesh(mesh: Mesh | None, *, node_sets: tuple[str, ...], facet_sets: tuple[str, ...]) -> None:
    if mesh is None:
        return
    _a("mesh", mesh, (Mesh,))
    for what, wanted, there in (
        ("node", node_sets, mesh.node_sets),
        ("facet", facet_sets, mesh.facet_sets),
    ):
        for name in wanted:
            if name not in there or not len(there[name]):
                raise _FieldError("mesh", f"a {what} set {name!r} that is not empty", sorted(there))
    if not mesh.n_elements:
        raise _FieldError("mesh", "at least one element", 0)


def _beam(scene: Beam) -> None:
    _length("length", scene.length)
    _length("grip_length", scene.grip_length)
    _a("section", scene.section, (Circle, Rectangle))
    if isinstance(scene.section, Circle):
        _length("section.radius", scene.section.radius)
    else:
        _length("section.width", scene.section.width)
        _length("section.height", scene.section.height)
    _one_of("supports", scene.supports, ("clamped-free", "clamped-clamped"))
    _vector("gravity", scene.gravity)
    _vector("tip_force", scene.tip_force)
    _not_negative("tip_mass", scene.tip_mass, "a mass of 0 kg or more")
    _one_of("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    _length("layer", scene.layer)
    _whole("rings", scene.rings)
    pulled = any(scene.tip_force)
    if pulled and scene.supports == "clamped-clamped":
        raise _FieldError("tip_force", "no force on a beam that is clamped at both ends", scene.tip_force)
    held = ("clamp",) if scene.supports == "clamped-free" else ("clamp", "far_clamp")
    if scene.tip_mass and scene.supports == "clamped-clamped":
        raise _FieldError("tip_mass", "no mass on a beam that is clamped at both ends", scene.tip_mass)
    _mesh(scene.mesh, node_sets=held, facet_sets=("tip",) if pulled or scene.tip_mass else ())
    _specimen(scene)
    _clamps(scene)
    if scene.solver.method != "static" and not is_ideal(scene):
        wanted = "static, the only one offered where the specimen or the clamps are not ideal"
        raise _FieldError("solver.method", wanted, scene.solver.method)


def _within(field: str, value: object, limit: float, unit: str) -> None:
    _number(field, value, f"a number between -{limit:.4g} and {limit:.4g}{unit}", lambda v: abs(v) <= limit)


def _specimen(scene: Beam) -> None:
    s = scene.specimen
    _a("specimen", s, (Specimen,))
    b, h = half_sizes(scene.section)
    # an arc of less than half a turn whose inside is not folded; sizes and moduli that stay well above 0
    _within("specimen.curvature", s.curvature, min(3.0 / scene.length, 0.5 / h), " /m on this beam")
    along = MOST_LOSS / (0.5 * scene.length)
    _within("specimen.taper", s.taper, 0.5 / (0.5 * scene.length), " /m on this beam")
    _within("specimen.axial_gradient", s.axial_gradient, along, " /m on this beam")
    _within("specimen.density_gradient", s.density_gradient, along, " /m on this beam")
    _within("specimen.transverse_gradient", s.transverse_gradient, MOST_LOSS / h, " /m on this beam")
    _number(
        "specimen.skin_thickness",
        s.skin_thickness,
        f"a length above 0 and up to half the section, {min(b, h):g} m",
        lambda v: 0.0 < v <= min(b, h),
    )
    _number("specimen.skin", s.skin, f"a number not below -{MOST_LOSS:g}", lambda v: v >= -MOST_LOSS)
    c0, cy, cz = skin_profile(scene)
    lowest = c0 + min(cy, 0.0) + min(cz, 0.0)
    if isinstance(scene.section, Circle):
        lowest = c0 + min(cy, cz, 0.0)
    if lowest < 1.0 - MOST_LOSS:
        wanted = "a skin whose stiffness a quadratic of y and z can stand for (it falls to 0 inside)"
        raise _FieldError("specimen.skin", wanted, s.skin)
    if s.void is None:
        return
    _a("specimen.void", s.void, (Void,))
    _number(
        "specimen.void.position",
        s.void.position,
        f"a place on the beam, 0 to {scene.length:g} m",
        lambda v: 0.0 <= v <= scene.length,
    )
    _length("specimen.void.length", s.void.length)
    _number(
        "specimen.void.edge",
        s.void.edge,
        f"a length above 0 and at most the void's, {s.void.length:g} m",
        lambda v: 0.0 < v <= s.void.length,  # type: ignore[union-attr]
    )
    _number(
        "specimen.void.fraction",
        s.void.fraction,
        f"a part between 0 and {MOST_LOSS:g}",
        lambda v: 0.0 <= v <= MOST_LOSS,
    )


def _clamps(scene: Beam) -> None:
    c = scene.clamps
    _a("clamps", c, (Clamps,))
    _within("clamps.tilt", c.tilt, MOST_TILT, " rad")
    _within("clamps.far_tilt", c.far_tilt, MOST_TILT, " rad")
    _vector("clamps.far_shift", c.far_shift, 2)
    if max(abs(v) for v in c.far_shift) > 0.5 * scene.length:
        raise _FieldError(
            "clamps.far_shift", f"less than half the length, {0.5 * scene.length:g} m", c.far_shift
        )
    if scene.supports == "clamped-free" and (c.far_tilt or any(c.far_shift)):
        name, value = ("far_tilt", c.far_tilt) if c.far_tilt else ("far_shift", c.far_shift)
        raise _FieldError(f"clamps.{name}", "0 on a beam without a far clamp", value)
    _not_negative("clamps.compliance", c.compliance, "a compliance of 0 rad/(N m) or more")
    _number("clamps.squeeze", c.squeeze, "a part between 0 and 0.5", lambda v: 0.0 <= v <= 0.5)


def _poke(scene: Poke) -> None:
    _block(scene.block)
    _rod(scene.rod)
    _vector("site", scene.site, 2)
    inside = np.abs(np.asarray(scene.site)) < 0.5 * np.asarray(scene.block.size[:2])
    if not inside.all():
        raise _FieldError("site", f"a place on the block's top, {scene.block.size[:2]} m large", scene.site)
    _vector("direction", scene.direction)
    size = float(np.linalg.norm(scene.direction))
    angle = np.degrees(np.arccos(np.clip(-scene.direction[2] / size, -1.0, 1.0))) if size > 0 else 180.0
    if angle > STEEPEST + 1e-6:
        raise _FieldError("direction", f"a push within {STEEPEST:g} degrees of (0, 0, -1)", scene.direction)
    _length("depth", scene.depth)
    if scene.depth * np.cos(np.radians(angle)) >= scene.block.size[2]:
        raise _FieldError("depth", f"less than the block's height of {scene.block.size[2]:g} m", scene.depth)
    if scene.back is not None:
        what = f"a depth [m] from 0 to less than the {scene.depth:g} m asked for, or None"
        _number("back", scene.back, what, lambda v: 0.0 <= v < scene.depth)
    _not_negative("friction", scene.friction)
    _length("frame_spacing", scene.frame_spacing)
    _one_of("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    _positive("refinement", scene.refinement)
    _vector("gravity", scene.gravity)
    _mesh(scene.mesh, node_sets=("base",), facet_sets=("top",))


def _block(block: Block) -> None:
    _a("block", block, (Block,))
    _vector("block.size", block.size)
    for value in block.size:
        _length("block.size", value)
    body = block.inclusion
    if body is None:
        return
    _a("block.inclusion", body, (BoxInclusion, SphereInclusion, CylinderInclusion))
    _vector("block.inclusion.centre", body.centre)
    if isinstance(body, BoxInclusion):
        _vector("block.inclusion.size", body.size)
        for value in body.size:
            _length("block.inclusion.size", value)
        _number("block.inclusion.angle", body.angle, "an angle in radians", lambda _v: True)
        return
    _length("block.inclusion.radius", body.radius)
    if isinstance(body, CylinderInclusion):
        _length("block.inclusion.height", body.height)


def _rod(rod: Rod) -> None:
    _a("rod", rod, (Rod,))
    _length("rod.radius", rod.radius)
    _length("rod.length", rod.length)
    _one_of("rod.tip", rod.tip, ("flat", "hemisphere"))
    _length("rod.edge_radius", rod.edge_radius)
    if rod.tip == "flat" and rod.edge_radius > rod.radius:
        raise _FieldError("rod.edge_radius", f"at most the rod's radius of {rod.radius:g} m", rod.edge_radius)


def _coupon(scene: Coupon) -> None:
    _one_of("mode", scene.mode, ("uniaxial", "equibiaxial", "planar", "simple-shear"))
    if not isinstance(scene.stretches, tuple | list) or not len(scene.stretches):
        raise _FieldError("stretches", "at least one stretch", scene.stretches)
    for value in scene.stretches:
        _positive("stretches", value, "stretches above 0")
    if scene.solver.method != "static":
        raise _FieldError("solver.method", "static, the only one offered for coupons", scene.solver.method)


def _press(scene: Press) -> None:
    _length("radius", scene.radius)
    _length("height", scene.height)
    _one_of("platens", scene.platens, ("bonded", "free"))
    _one_of("side", scene.side, ("stick", "stop"))
    _one_of("element", scene.element, ("default", "tet4", "tet10", "hex8"))
    _number("refinement", scene.refinement, "a number between 0.4 and 8", lambda v: 0.4 <= v <= 8.0)
    if not isinstance(scene.stretches, tuple | list) or not len(scene.stretches):
        raise _FieldError("stretches", "at least one stretch", scene.stretches)
    for value in scene.stretches:
        _positive("stretches", value, "stretches above 0")
    steps = np.diff([1.0, *scene.stretches])
    if not ((steps < 0.0).all() or (steps > 0.0).all()):
        raise _FieldError("stretches", "stretches all falling from 1, or all rising from 1", scene.stretches)
    if scene.solver.method != "static":
        raise _FieldError("solver.method", "static, the only one offered for presses", scene.solver.method)


_CHECKS: dict[type, Callable[[Any], None]] = {Beam: _beam, Poke: _poke, Coupon: _coupon, Press: _press}
