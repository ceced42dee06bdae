"""Scenes of one material: beams, indentation, homogeneous tests and compressed cylinders. SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from tisim.bodies import Block, Circle, Rectangle, Rod, Vector
from tisim.course import Course
from tisim.material import Material
from tisim.mesh import Mesh
from tisim.mesh._mesh import free_length

ElementChoice = Literal["default", "tet4", "tet10", "hex8", "hex20"]


@dataclass(frozen=True, kw_only=True)
class Solver:
    """Method and accuracy of a solution.

    Attributes
    ----------
    method : "static", "implicit" or "explicit"
        Equilibrium, dynamics by BDF2, or dynamics by central differences (dynamics for beams only).
    tolerance : float
        Largest residual of the free nodes in equilibrium, as a fraction of the applied load (for a poke, of
        the rod's force). For beams it is not below the rounding error of the residual.
    duration : float
        End time of the dynamic methods [s].
    time_step : float
        Largest step of the implicit method [s]; the explicit method divides it into stable steps.
    mass_damping, stiffness_damping : float
        Rayleigh coefficients [1/s] and [s].
    until_rest : bool
        If True, the dynamic methods end earlier, when the body is at rest in equilibrium.
    max_iterations : int
        Newton iterations per step. A step of a poke takes half as many and, if it fails, up to four times as
        many as a damped motion.
    """

    method: Literal["static", "implicit", "explicit"] = "static"
    tolerance: float = 1e-6
    duration: float = 2.0
    time_step: float = 2e-3
    mass_damping: float = 0.0
    stiffness_damping: float = 0.0
    until_rest: bool = False
    max_iterations: int = 40


@dataclass(frozen=True, kw_only=True)
class Void:
    """A section of a beam in which material is missing, such as bubbles or a cavity.

    Attributes
    ----------
    position : float
        Position of its middle along the beam [m].
    length : float
        Distance between the positions at which half of `fraction` is missing [m]; the integral of the loss is
        fraction * length.
    edge : float
        Length of the transition at each end, half a cosine wave [m], at most `length`: a mesh cannot resolve
        a jump.
    fraction : float
        Peak loss of the section's stiffness, in bending and stretching, and of its weight, 0 to 0.95.
    """

    position: float
    length: float = 0.015
    edge: float = 0.003
    fraction: float


@dataclass(frozen=True, kw_only=True)
class Imperfections:
    """Deviations of a beam from the ideal prism, all zero by default. x runs along the beam at rest.

    Attributes
    ----------
    curvature : float
        Curvature of the stress-free axis, an arc in the plane y = 0 that starts at x = 0 along x; positive
        upwards, towards +z [1/m].
    taper : float
        Relative change of the section's size per metre along x, 0 in the middle of the length [1/m].
    axial_gradient, density_gradient : float
        Relative changes of the modulus and of the density per metre along x, 0 in the middle [1/m].
    transverse_gradient : float
        Relative change of the modulus per metre along z, 0 on the axis [1/m].
    skin : float
        Relative excess stiffness of the outer layer. The layer is thinner than an element, so its excess is
        distributed over the section as a quadratic function of y and z with the layer's stretching stiffness
        and its bending stiffnesses about y and z.
    skin_thickness : float
        Thickness of that layer [m].
    void : Void, optional
        A section with missing material.
    """

    curvature: float = 0.0
    taper: float = 0.0
    axial_gradient: float = 0.0
    density_gradient: float = 0.0
    transverse_gradient: float = 0.0
    skin: float = 0.0
    skin_thickness: float = 0.001
    void: Void | None = None


@dataclass(frozen=True, kw_only=True)
class ClampImperfections:
    """Deviations of clamps from ideal ones, which hold the end sections upright and in shape.

    The equilibrium is continued from that of the ideal beam: beyond the load at which the ideal beam buckles
    (a beam that stands upright) it may be another than the one to which the imperfect beam would bend.

    Attributes
    ----------
    tilt : float
        Rotation of the near clamp's face about y through (0, 0, 0); positive lifts the free end to +z [rad].
    far_tilt : float
        Rotation of the far clamp's face about (length, 0, 0); positive is a positive slope dz/dx [rad].
    far_shift : (float, float)
        Displacement (dx, dz) of the far clamp [m].
    compliance : float
        Additional rotation of each clamp about the middle of its face, about y, per bending moment about y
        that it carries [rad/(N m)]; solved for to 1e-4 of the angle. Loads along y are refused beside it.
    squeeze : float
        Fraction by which the held section's height (z) is reduced; its width (y) grows at constant area.
    """

    tilt: float = 0.0
    far_tilt: float = 0.0
    far_shift: tuple[float, float] = (0.0, 0.0)
    compliance: float = 0.0
    squeeze: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A prismatic beam along x, held in grips at x < 0 (and x > length), under gravity and a tip load.

    Where loads and fibres have the mirror plane y = 0, half of it is solved, which cannot leave that plane. A
    strip on edge that would buckle sideways is then in an equilibrium that is not stable; with a component of
    1e-4 of the load along y the whole beam is solved, and finds the stable one.

    Attributes
    ----------
    material : Material
    length : float
        Free length [m]. Optional if `mesh` is given: by default the distance from the mesh's clamp to its
        farthest node, or between its two clamps.
    section : Circle or Rectangle
    supports : "clamped-free" or "clamped-clamped"
    grip_length : float
        Length held in each grip [m]. It does not change the result: all of a beam that is in a grip is fixed,
        so the structured mesh begins at the grip's face, x = 0 (`tisim.mesh.beam_mesh(with_grips=True)` also
        meshes what is behind it). A beam that is held only behind the grip's face has a longer `length`.
    gravity : (float, float, float)
        Acceleration of gravity [m/s2].
    tip_force : (float, float, float)
        Dead load on the free end face [N].
    tip_mass : float
        Mass distributed uniformly over the free end face [kg]. It adds inertia in the dynamic methods only
        (mass damping acts on it too); its weight has to be given as a tip_force.
    element : "default", "tet4", "tet10" or "hex8"
        "default" is the mixed 10-node tetrahedron, "tet4" the paper's element.
    mesh : Mesh, optional
        Mesh to use instead of the structured one. It needs node sets "clamp" (and "far_clamp"), and a facet
        set "tip" for a tip force or mass.
    axial_element_size : float
        Length of the structured elements along the beam [m].
    radial_elements : int
        Number of elements from the axis to the surface.
    imperfections : Imperfections
        Static beams only. The result's mesh is that of the ideal prism; `tisim.rest_positions` returns the
        stress-free positions of its nodes.
    clamp_imperfections : ClampImperfections
        Static beams only.
    course : Course, optional
        Fraction of the load (weight and tip force) over time, from 0; quasi-static, without inertia. Required
        for static beams of a viscous material; a beam loaded at time 0 has `Course().jump(1.0).hold(T)`.
    solver : Solver
    """

    material: Material
    length: float = None  # type: ignore[assignment] # a number from __post_init__ on
    section: Circle | Rectangle = field(default_factory=lambda: Circle(radius=0.010))
    supports: Literal["clamped-free", "clamped-clamped"] = "clamped-free"
    grip_length: float = 0.020
    gravity: Vector = (0.0, 0.0, -9.81)
    tip_force: Vector = (0.0, 0.0, 0.0)
    tip_mass: float = 0.0
    element: ElementChoice = "default"
    mesh: Mesh | None = None
    axial_element_size: float = 0.007
    radial_elements: int = 2
    imperfections: Imperfections = field(default_factory=Imperfections)
    clamp_imperfections: ClampImperfections = field(default_factory=ClampImperfections)
    course: Course | None = None
    solver: Solver = field(default_factory=Solver)

    def __post_init__(self) -> None:
        if self.length is not None:
            return
        if self.mesh is None:
            raise TypeError("Beam: expected length, the free length [m], or a mesh")
        # the scene's check refuses other objects and meshes without clamps
        free = free_length(self.mesh, self.held) if isinstance(self.mesh, Mesh) else math.nan
        object.__setattr__(self, "length", free)

    @property
    def held(self) -> tuple[str, ...]:
        """Node sets that the supports hold."""
        return ("clamp",) if self.supports == "clamped-free" else ("clamp", "far_clamp")


@dataclass(frozen=True, kw_only=True)
class Poke:
    """Indentation: a rod pushed along its axis into the top of a block.

    Attributes
    ----------
    material : Material
    site : (float, float)
        Point at which the rod's axis meets the rest surface, (x, y) [m].
    direction : (float, float, float)
        Direction of the push, of any length; up to 45 degrees from -z.
    depth : float
        Travel of the rod from first contact with the undeformed surface [m].
    retract_to : float, optional
        Depth to which the rod is then retracted [m], with frames on the way; None for no retraction. The
        surface does not adhere to the rod.
    course : Course, optional
        Depth over time [m], from 0, in place of `depth`, `retract_to` and `frame_spacing`; required for a
        viscous material.
    turns : tuple of (float, (float, float, float))
        Times [s] and directions of a rod that rotates; requires a course. The rod rotates at a constant rate
        about the point where its axis meets the rest surface, from `direction` at time 0 to the first
        direction, then to the next, and keeps the last one; it stands still between two equal directions.
        Times rise and are ends of the course's pieces. If empty, the direction is constant.
    block : Block
    rod : Rod
    friction : float
        Coulomb coefficient (0: frictionless).
    frame_spacing : float
        Travel of the tip from one frame to the next [m].
    element : "default", "tet4", "tet10", "hex8" or "hex20"
        "default" is the 20-node hexahedron, on a mesh made for the rod.
    mesh : Mesh, optional
        Mesh to use instead; it needs a node set "base" (fixed) and a facet set "top".
    refinement : float
        Factor by which elements become smaller (1 = default), 0.5 to 6.
    gravity : (float, float, float)
        Acceleration of gravity [m/s2]; none by default, as in the paper.
    solver : Solver
        The default tolerance is 5e-4 of the rod's force, since contact points that open and close at the
        rod's edge prevent much smaller residuals. Only the static method is available.
    """

    material: Material
    site: tuple[float, float] = (0.0, 0.0)
    direction: Vector = (0.0, 0.0, -1.0)
    depth: float = 0.030
    retract_to: float | None = None
    course: Course | None = None
    turns: tuple[tuple[float, Vector], ...] = ()
    block: Block = field(default_factory=Block)
    rod: Rod = field(default_factory=Rod)
    friction: float = 0.6
    frame_spacing: float = 0.001
    element: ElementChoice = "default"
    mesh: Mesh | None = None
    refinement: float = 1.0
    gravity: Vector = (0.0, 0.0, 0.0)
    solver: Solver = field(default_factory=lambda: Solver(tolerance=5e-4, max_iterations=40))


@dataclass(frozen=True, kw_only=True)
class Coupon:
    """A homogeneous material test.

    Attributes
    ----------
    material : Material
    mode : "uniaxial", "equibiaxial", "planar" or "simple-shear"
    stretches : tuple of float
        Values of the stretch (simple shear: 1 + gamma), solved in sequence.
    course : Course, optional
        Stretch over time, from 1, in place of `stretches`; required for a viscous material.
    solver : Solver
        Only the static method is available.
    """

    material: Material
    mode: Literal["uniaxial", "equibiaxial", "planar", "simple-shear"] = "uniaxial"
    stretches: tuple[float, ...] = (1.1, 1.2, 1.5, 2.0)
    course: Course | None = None
    solver: Solver = field(default_factory=Solver)


@dataclass(frozen=True, kw_only=True)
class Press:
    """Uniaxial compression (or tension) of an upright cylinder between two rigid platens.

    Attributes
    ----------
    material : Material
    radius, height : float
        Radius and height of the rest shape [m].
    platens : "bonded" or "free"
        Bonded: the end faces stick to the platens all over (glued, or rough). Free: they slide without
        friction, and the body remains a cylinder down to a stretch of about 0.44, where its surface becomes
        unstable. An eighth of the body is solved: that a slender one buckles sideways before (a height above
        three radii or so) does not show. In a test that never exceeds the rest height they push and do not
        pull: a viscous body that recovers more slowly than they open loses contact, with force 0. Bonded
        platens pull. Coulomb friction, which lies between the two, is not available.
    stretches : tuple of float
        Height over rest height, all falling from 1 or all rising from 1, solved in sequence.
    course : Course, optional
        Stretch over time, from 1, in place of `stretches`; required for a viscous material.
    side : "stick" or "stop"
        If the side of a bonded cylinder folds onto a platen, either it sticks where it touches and carries
        load, or the solution ends with status PENETRATION.
    element : "default", "tet4", "tet10" or "hex8"
        "default" is the mixed 10-node tetrahedron.
    refinement : float
        Factor by which elements become smaller (1 = default), 0.4 to 8.
    solver : Solver
        Only the static method is available.
    """

    material: Material
    radius: float
    height: float
    platens: Literal["bonded", "free"] = "bonded"
    stretches: tuple[float, ...] = (0.9, 0.8, 0.7)
    course: Course | None = None
    side: Literal["stick", "stop"] = "stick"
    element: ElementChoice = "default"
    refinement: float = 1.0
    solver: Solver = field(default_factory=Solver)


Scene = Beam | Poke | Coupon | Press
