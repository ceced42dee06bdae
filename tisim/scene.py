"""What can be simulated: beams, pokes, coupons and pressed cylinders of one material. SI units throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from tisim.bodies import Block, Circle, Rectangle, Rod, Vector
from tisim.mesh import Mesh

ElementChoice = Literal["default", "tet4", "tet10", "hex8"]


@dataclass(frozen=True, kw_only=True)
class Material:
    """A constitutive law with its parameters.

    law: a name in `tisim.laws.all_names()`.
    parameters: by name as the law's docstring states them (moduli in Pa); a tuple for a series (Ogden).
    density: rest density [kg/m3].
    """

    law: str
    parameters: Mapping[str, float | tuple[float, ...]]
    density: float = 1000.0


@dataclass(frozen=True, kw_only=True)
class Solver:
    """How a scene is brought to its answer.

    method: "static" (equilibrium), "implicit" (dynamics) or "explicit" (dynamics).
    tolerance: equilibrium when the free nodes' residual falls below this part of the applied load (the rod's
        force, for a poke), or below what rounding leaves of it.
    duration: end time of the dynamic methods [s]; they also end when the motion has died down to
        equilibrium, where `until_rest` is set.
    time_step: step of the implicit method [s] (the explicit one takes its stable step).
    mass_damping, stiffness_damping: Rayleigh coefficients [1/s] and [s].
    max_iterations: Newton iterations a step (of pokes: as many more after each step refused before it).
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

    position: of its middle along the beam [m].
    length: between the places where half of `fraction` is missing [m]; the loss integrates to fraction *
        length.
    edge: over which the loss sets in at either end, as half a cosine [m]: a mesh cannot follow a jump.
        `length` at most (a raised cosine).
    fraction: peak loss of the section's stiffness, in bending and stretching, and of its weight, 0 to 0.95.
    """

    position: float
    length: float = 0.015
    edge: float = 0.003
    fraction: float


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """How a real beam departs from the ideal prism; all zero: the ideal one. x runs along the beam at rest.

    curvature: stress-free, the axis is an arc in the plane y = 0 that leaves x = 0 along x; positive is bent
        upwards, to +z [1/m].
    taper: relative change of the section's size per metre along x, 0 in the middle of the length [1/m].
    axial_gradient, density_gradient: the same for the modulus and for the density [1/m].
    transverse_gradient: relative change of the modulus per metre along z, 0 on the axis [1/m].
    skin: relative excess of stiffness of the outer layer, which is skin_thickness deep [m]. The layer is
        thinner than an element, so its excess is spread over the section as a quadratic of y and z that has
        the layer's stretching stiffness and its bending stiffnesses about y and z.
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
class Clamps:
    """How grips depart from ideal ones, each of which holds the section of its end upright and in shape.

    tilt: the near clamp's face, turned about (0, 0, 0) and y; positive lifts the free end, to +z [rad].
    far_tilt: the far clamp's, about (length, 0, 0); positive is a positive slope dz/dx as well [rad].
    far_shift: (dx, dz) of the far clamp [m].
    compliance: each clamp turns, besides, by this times the bending moment that it carries, about the middle
        of its face [rad/(N m)]; found to 1e-4 of the angle.
    squeeze: the held section is lower (z) by this part, and wider (y) so that its area stays.
    """

    tilt: float = 0.0
    far_tilt: float = 0.0
    far_shift: tuple[float, float] = (0.0, 0.0)
    compliance: float = 0.0
    squeeze: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A prismatic beam along x, held in grips at x < 0 (and x > length), under gravity and a tip load.

    length: free length [m]; grip_length: part held in each grip [m], all of its nodes fixed.
    gravity [m/s2], tip_force: dead load on the free end face [N].
    tip_mass: fixed to the free end face, spread evenly over it [kg]: inertia of the dynamic methods only
        (mass damping acts on it too); its weight is to be given as a tip_force.
    element: "default" is the mixed 10-node tetrahedron; "tet4" the paper's.
    mesh: an own mesh with node sets "clamp" (and "far_clamp"), instead of the structured one;
        facet set "tip" where a tip force acts.
    layer: length of the structured elements along the beam [m]; rings: elements from axis to surface.
    specimen, clamps: how body and grips depart from the ideal ones (static beams only). The result's mesh
        stays the ideal prism's; `tisim.rest_positions` is where its nodes lie free of stress.
    """

    material: Material
    length: float
    section: Circle | Rectangle = field(default_factory=lambda: Circle(radius=0.010))
    supports: Literal["clamped-free", "clamped-clamped"] = "clamped-free"
    grip_length: float = 0.020
    gravity: Vector = (0.0, 0.0, -9.81)
    tip_force: Vector = (0.0, 0.0, 0.0)
    tip_mass: float = 0.0
    element: ElementChoice = "default"
    mesh: Mesh | None = None
    layer: float = 0.007
    rings: int = 2
    specimen: Specimen = field(default_factory=Specimen)
    clamps: Clamps = field(default_factory=Clamps)
    solver: Solver = field(default_factory=Solver)


@dataclass(frozen=True, kw_only=True)
class Poke:
    """A rod pushed along its axis into the top of a block.

    site: where the rod's axis meets the rest surface, (x, y) [m].
    direction: of the push, unit length on use; up to 45 degrees from -z.
    depth: travel asked for [m], counted from first touch of the undeformed surface.
    back: depth that the rod is then drawn back to [m], frames kept on the way as well; None: not at all. The
        surface does not pull at the rod.
    friction: Coulomb coefficient (0 slides freely).
    frame_spacing: a frame is kept each time the tip has moved this far [m].
    element: "default" is the 8-node hexahedron with element pressure on a mesh made for the rod.
    mesh: an own mesh, with node set "base" (fixed) and facet set "top".
    refinement: elements get smaller by this factor (1 = default).
    gravity [m/s2]: none by default, as in the paper.
    solver: its tolerance is 5e-4 of the rod's force, since contact points that come and go at the rod's edge
        keep the iteration from doing much better.
    """

    material: Material
    site: tuple[float, float] = (0.0, 0.0)
    direction: Vector = (0.0, 0.0, -1.0)
    depth: float = 0.030
    back: float | None = None
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

    stretches: values of the stretch (simple-shear: 1 + gamma), each solved in turn.
    """

    material: Material
    mode: Literal["uniaxial", "equibiaxial", "planar", "simple-shear"] = "uniaxial"
    stretches: tuple[float, ...] = (1.1, 1.2, 1.5, 2.0)
    solver: Solver = field(default_factory=Solver)


@dataclass(frozen=True, kw_only=True)
class Press:
    """An upright cylinder between two rigid platens.

    radius, height: of the rest shape [m].
    platens: "bonded" (the end faces stick to them all over: glued, or rough) or "free" (they slide without
        friction; the cylinder stays one, down to a stretch of 0.44 or so, where its surface gets unstable).
        Coulomb friction, between the two, is not offered.
    stretches: height over rest height, all falling from 1 or all rising from 1, each solved in turn.
    side: what happens where a bonded cylinder's side folds onto a platen: "stick" (it stays where it comes
        down, and carries) or "stop" (the run ends there, with status PENETRATION).
    element: "default" is the mixed 10-node tetrahedron.
    refinement: elements get smaller by this factor (1 = default).
    """

    material: Material
    radius: float
    height: float
    platens: Literal["bonded", "free"] = "bonded"
    stretches: tuple[float, ...] = (0.9, 0.8, 0.7)
    side: Literal["stick", "stop"] = "stick"
    element: ElementChoice = "default"
    refinement: float = 1.0
    solver: Solver = field(default_factory=Solver)


Scene = Beam | Poke | Coupon | Press
