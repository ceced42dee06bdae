"""Scenes: beams, pokes, coupons and compressed cylinders of one material. SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from tisim import laws, parts
from tisim.bodies import Block, Circle, Rectangle, Rod, Vector
from tisim.course import Course
from tisim.mesh import Mesh
from tisim.mesh._mesh import free_length

ElementChoice = Literal["default", "tet4", "tet10", "hex8", "hex20"]


@dataclass(frozen=True, kw_only=True)
class Material:
    """A constitutive law with its parameters, and what the material has beside it.

    How they combine is stated in `tisim.parts`.

    Attributes
    ----------
    law : str
        A name in `tisim.laws.all_names()`.
    parameters : mapping
        By name as the law's docstring states them, moduli in Pa; a tuple for a series (Ogden).
    density : float
        Rest density [kg/m3].
    viscosity : tisim.parts.Viscosity, optional
        Relaxation of the isochoric stress (`tisim.Prony`).
    softening : tisim.parts.Softening, optional
        Softening by the largest energy so far (`tisim.OgdenRoxburgh`).
    fibres : tisim.parts.Fibres, optional
        One family of fibres (`tisim.HolzapfelGasserOgden`).
    """

    law: str
    parameters: Mapping[str, float | tuple[float, ...]]
    density: float = 1000.0
    viscosity: parts.Viscosity | None = None
    softening: parts.Softening | None = None
    fibres: parts.Fibres | None = None

    @property
    def has_parts(self) -> bool:
        """True if the material has viscosity, softening or fibres beside its law."""
        return self.viscosity is not None or self.softening is not None or self.fibres is not None

    @property
    def remembers(self) -> bool:
        """True if the stress depends on the history of deformation."""
        return self.viscosity is not None or self.softening is not None


def material_from_moduli(
    law: str, *, shear_modulus: float, bulk_modulus: float, density: float = 1000.0
) -> Material:
    """Material of a law with given small-strain moduli.

    Constants that small strains do not determine have the law's plain default; see its `from_moduli`.

    Parameters
    ----------
    law : str
        A name in `tisim.laws.all_names()`.
    shear_modulus, bulk_modulus : float
        [Pa].
    density : float
        Rest density [kg/m3].

    Returns
    -------
    Material

    Raises
    ------
    ValueError
        For an unknown law, or moduli that the law cannot have.
    """
    chosen = laws.get(law)
    parameters = chosen.from_moduli(shear_modulus, bulk_modulus)
    chosen.check(parameters)
    return Material(law=law, parameters=parameters, density=density)


@dataclass(frozen=True, kw_only=True)
class Solver:
    """Method and accuracy of a solution.

    Attributes
    ----------
    method : "static", "implicit" or "explicit"
        Equilibrium, dynamics by BDF2, or dynamics by central differences (both of beams only).
    tolerance : float
        Equilibrium when the free nodes' residual is below this fraction of the applied load (the rod's force,
        for a poke), or below what rounding leaves of it.
    duration : float
        End time of the dynamic methods [s].
    time_step : float
        Step of the implicit method [s] (the explicit one takes its stable step).
    mass_damping, stiffness_damping : float
        Rayleigh coefficients [1/s] and [s].
    until_rest : bool
        The dynamic methods also end when the motion has died down to equilibrium.
    max_iterations : int
        Newton iterations a step (of pokes: as many more after each step refused before it).
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
    """A stretch of a beam in which material is missing: bubbles, a hollow.

    Attributes
    ----------
    position : float
        Of its middle along the beam [m].
    length : float
        Between the positions where half of `fraction` is missing [m]; the loss integrates to fraction *
        length.
    edge : float
        Length over which the loss sets in at either end, as half a cosine [m], `length` at most: a mesh
        cannot follow a jump.
    fraction : float
        Peak loss of the section's stiffness, in bending and stretching, and of its weight, 0 to 0.95.
    """

    position: float
    length: float = 0.015
    edge: float = 0.003
    fraction: float


@dataclass(frozen=True, kw_only=True)
class Imperfections:
    """Deviations of a real beam from the ideal prism, zero for the ideal one. x runs along the beam at rest.

    Attributes
    ----------
    curvature : float
        Stress-free, the axis is an arc in the plane y = 0 that leaves x = 0 along x; positive is bent
        upwards, to +z [1/m].
    taper : float
        Relative change of the section's size per metre along x, 0 in the middle of the length [1/m].
    axial_gradient, density_gradient : float
        The same for the modulus and for the density [1/m].
    transverse_gradient : float
        Relative change of the modulus per metre along z, 0 on the axis [1/m].
    skin : float
        Relative excess of stiffness of the outer layer. The layer is thinner than an element, so its excess
        is spread over the section as a quadratic of y and z that has the layer's stretching stiffness and
        its bending stiffnesses about y and z.
    skin_thickness : float
        Depth of that layer [m].
    void : Void, optional
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
    """Deviations of clamps from ideal ones, each of which holds the section of its end upright and in shape.

    Attributes
    ----------
    tilt : float
        Rotation of the near clamp's face about (0, 0, 0) and y; positive lifts the free end, to +z [rad].
    far_tilt : float
        Rotation of the far clamp's face about (length, 0, 0); positive is a positive slope dz/dx [rad].
    far_shift : (float, float)
        Displacement (dx, dz) of the far clamp [m].
    compliance : float
        Each clamp turns, besides, by this times the bending moment that it carries, about the middle of its
        face [rad/(N m)]; found to 1e-4 of the angle.
    squeeze : float
        The held section is lower (z) by this fraction, and wider (y) so that its area stays.
    """

    tilt: float = 0.0
    far_tilt: float = 0.0
    far_shift: tuple[float, float] = (0.0, 0.0)
    compliance: float = 0.0
    squeeze: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A prismatic beam along x, held in grips at x < 0 (and x > length), under gravity and a tip load.

    Attributes
    ----------
    material : Material
    length : float
        Free length [m]. May be left out with a mesh of one's own: how far that reaches from its clamp, or
        from one clamp to the other.
    section : Circle or Rectangle
    supports : "clamped-free" or "clamped-clamped"
    grip_length : float
        Length held in each grip, all of its nodes fixed [m].
    gravity : (float, float, float)
        [m/s2].
    tip_force : (float, float, float)
        Dead load on the free end face [N].
    tip_mass : float
        Fixed to the free end face, spread evenly over it [kg]: inertia of the dynamic methods only (mass
        damping acts on it too); its weight is to be given as a tip_force.
    element : "default", "tet4", "tet10" or "hex8"
        "default" is the mixed 10-node tetrahedron; "tet4" the paper's.
    mesh : Mesh, optional
        An own mesh with node sets "clamp" (and "far_clamp"), instead of the structured one; facet set "tip"
        where a tip force acts.
    axial_element_size : float
        Length of the structured elements along the beam [m].
    radial_elements : int
        Number of elements from the axis to the surface.
    imperfections : Imperfections
        Static beams only. The result's mesh stays the ideal prism's; `tisim.rest_positions` gives the
        positions of its nodes free of stress.
    clamp_imperfections : ClampImperfections
        Static beams only.
    course : Course, optional
        The part of the load, weight and tip force, that acts over time, from 0: quasi-static, without
        inertia. What a viscous material needs unless its motion is asked for; a beam that hangs from time 0
        on has `Course().jump(1.0).hold(T)`.
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
        held = ("clamp",) if self.supports == "clamped-free" else ("clamp", "far_clamp")
        # what is no mesh, or has no clamps, is refused by the scene's check
        free = free_length(self.mesh, held) if isinstance(self.mesh, Mesh) else math.nan
        object.__setattr__(self, "length", free)


@dataclass(frozen=True, kw_only=True)
class Poke:
    """Indentation: a rod pushed along its axis into the top of a block.

    Attributes
    ----------
    material : Material
    site : (float, float)
        Where the rod's axis meets the rest surface, (x, y) [m].
    direction : (float, float, float)
        Of the push, of any length; up to 45 degrees from -z.
    depth : float
        Travel asked for [m], counted from first touch of the undeformed surface.
    retract_to : float, optional
        Depth that the rod is then drawn back to [m], frames kept on the way as well; None: not at all. The
        surface does not pull at the rod.
    course : Course, optional
        The depth over time [m], from 0, in place of `depth`, `retract_to` and `frame_spacing`; what a viscous
        material needs.
    turns : tuple of (float, (float, float, float))
        Of a poke with a course: times [s] and directions, as `direction`, that the rod turns to. It turns
        about the place where its axis meets the rest surface, at a constant rate, from `direction` at time 0
        to the first, from there to the next, and stays at the last; a direction given twice is a rest.
        Times are ends of the course's pieces, rising. Empty: the direction stays.
    block : Block
    rod : Rod
    friction : float
        Coulomb coefficient (0 slides freely).
    frame_spacing : float
        A frame is kept each time the tip has moved this far [m].
    element : "default", "tet4", "tet10", "hex8" or "hex20"
        "default" is the 20-node hexahedron, on a mesh made for the rod.
    mesh : Mesh, optional
        An own mesh, with node set "base" (fixed) and facet set "top".
    refinement : float
        Elements get smaller by this factor (1 = default), 0.5 to 6.
    gravity : (float, float, float)
        [m/s2]; none by default, as in the paper.
    solver : Solver
        Its tolerance is 5e-4 of the rod's force, since contact points that come and go at the rod's edge
        keep the iteration from doing much better. Only the static method is offered.
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
        Values of the stretch (simple shear: 1 + gamma), each solved in turn.
    course : Course, optional
        The stretch over time, from 1, in place of `stretches`; what a viscous material needs.
    solver : Solver
        Only the static method is offered.
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
        Of the rest shape [m].
    platens : "bonded" or "free"
        Bonded: the end faces stick to the platens all over (glued, or rough). Free: they slide without
        friction; the cylinder stays one, down to a stretch of 0.44 or so, where its surface gets unstable.
        Coulomb friction, between the two, is not offered.
    stretches : tuple of float
        Height over rest height, all falling from 1 or all rising from 1, each solved in turn.
    course : Course, optional
        The stretch over time, from 1, in place of `stretches`; what a viscous material needs.
    side : "stick" or "stop"
        What happens where a bonded cylinder's side folds onto a platen: it stays where it comes down, and
        carries; or the run ends there, with status PENETRATION.
    element : "default", "tet4", "tet10" or "hex8"
        "default" is the mixed 10-node tetrahedron.
    refinement : float
        Elements get smaller by this factor (1 = default), 0.4 to 8.
    solver : Solver
        Only the static method is offered.
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
