"""The reduced beam: Galerkin's method on a planar beam with shear (Reissner) whose axis does not stretch.

Its shapes hold the statics of a short thick cantilever exactly and its lowest modes closely. The equilibrium
is solved with finite rotations; `_vibration` adds the motion about it, `_fem` what three dimensions add.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from tisim import Circle, Rectangle

Array = NDArray[np.float64]
Pair = tuple[float, float]

SHEAR_COEFFICIENTS = {"rectangle": 15.0 / 17.5, "circle": 0.9}  # Cowper's, at a Poisson ratio of 1/2
YOUNG = 3.0  # Young's modulus over the shear modulus of an incompressible material
POINTS = 12  # of the Gauss quadrature along the beam
_ITERATIONS, _TOLERANCE = 30, 1e-12


@dataclass(frozen=True, kw_only=True)
class BeamParameters:
    """A beam along x in one clamp, in the plane (x, z), as the cameras see it; effects change these. SI.

    Attributes
    ----------
    section : of the beam.
    shear_modulus : [Pa], with E = 3 G, in a vibration of angular frequency 1 / `reference_time`.
    density : [kg/m3].
    length : free length [m].
    relaxation_time : stiffness-proportional damping [s].
    mass_damping : mass-proportional damping [1/s].
    reference_time : see `shear_modulus` [s].
    branches : further relaxation, (fraction of `shear_modulus`, time [s]) each; `shear_modulus` stays.
    grip_depth : length inside the clamp that is free too [m]; the root is at x = -grip_depth.
    gravity : (x, z) [m/s2].
    tip_force : (x, z) [N].
    tip_mass : mass that moves with the tip [kg].
    load_height : height on the end face at which tip force and mass act [m].
    clamp_compliance : rotation of the clamp by the moment [rad/Nm].
    clamp_sag : displacement of the clamp by the force [m/N].
    curvature : of the stress-free beam [1/m].
    stiffening : c2 / c1 of the strain energy.
    axial_gradient : relative change of the modulus along x [1/m], zero in the middle.
    stiff_root : length next to the clamp that in effect does not bend, since the clamp also holds the form of
        the section [m]; beam theory lacks it, `_fem` finds it.
    extra_inertia : relative excess of all mass in motion, but not in weight.
    image_scale : relative excess of the displacements that the cameras show.
    camera_roll : rotation of their frame [rad].
    clock_rate : relative excess of the time that has passed over the time that they show.
    held_below : drop of the tip, in the shape of its equilibrium, at which it was held [m]; displacements are
        counted from there.
    rubbing : deflection of the tip that dry friction of what hangs would hold [m].
    """

    section: Circle | Rectangle
    shear_modulus: float
    density: float
    length: float
    relaxation_time: float = 0.0
    mass_damping: float = 0.0
    reference_time: float = 0.02
    branches: tuple[Pair, ...] = ()
    grip_depth: float = 0.0
    gravity: Pair = (0.0, -9.81)
    tip_force: Pair = (0.0, 0.0)
    tip_mass: float = 0.0
    load_height: float = 0.0
    clamp_compliance: float = 0.0
    clamp_sag: float = 0.0
    curvature: float = 0.0
    stiffening: float = 0.0
    axial_gradient: float = 0.0
    stiff_root: float = 0.0
    extra_inertia: float = 0.0
    image_scale: float = 0.0
    camera_roll: float = 0.0
    clock_rate: float = 0.0
    held_below: float = 0.0
    rubbing: float = 0.0


@dataclass(frozen=True, eq=False)
class Shapes:
    """Timoshenko's cantilever of unit length at n points, under each of k loads: a tip force, a tip moment,
    and distributed loads p = 1, x, x^2. Unit: the tip force is one.

    Attributes
    ----------
    rotation : of the section, the integral of the moment, shape (k, n).
    moment, shear : shape (k, n).
    """

    rotation: Array
    moment: Array
    shear: Array


def _polynomials() -> list[tuple[Polynomial, Polynomial, Polynomial]]:
    """Rotation, moment and shear force of each load."""
    found = []
    one, x = Polynomial([1.0]), Polynomial([0.0, 1.0])
    for shear in (one, *((1.0 - x ** (m + 1)) / (m + 1) for m in range(3))):
        whole = shear.integ()
        moment = whole(1.0) - whole
        found.append((moment.integ(), moment, shear))
    found.insert(1, (x, one, Polynomial([0.0])))
    return found


def _coefficients() -> Array:
    """Coefficients (3, k, degree + 1) of rotation, moment and shear force."""
    found = [[p.coef for p in shape] for shape in _polynomials()]
    degree = max(len(c) for shape in found for c in shape)
    return np.array([[np.pad(shape[i], (0, degree - len(shape[i]))) for shape in found] for i in range(3)])


_COEFFICIENTS = _coefficients()


def shapes_at(x: Array) -> Shapes:
    """Shapes at x (n,), fractions of the length."""
    powers = np.vander(x, _COEFFICIENTS.shape[2], increasing=True).T
    rotation, moment, shear = _COEFFICIENTS @ powers
    return Shapes(rotation, moment, shear)


@dataclass(frozen=True, kw_only=True)
class Section:
    """Moments of a cross section.

    Attributes
    ----------
    area : [m2].
    inertia : second moment of area about y [m4].
    fourth : fourth moment over the second [m2].
    shear_coefficient : Cowper's.
    """

    area: float
    inertia: float
    fourth: float
    shear_coefficient: float


def section_of(shape: Circle | Rectangle) -> Section:
    """Moments of a circle or a rectangle."""
    if isinstance(shape, Circle):
        r = shape.radius
        return Section(
            area=np.pi * r**2,
            inertia=np.pi * r**4 / 4.0,
            fourth=r**2 / 2.0,
            shear_coefficient=SHEAR_COEFFICIENTS["circle"],
        )
    w, h = shape.width, shape.height
    return Section(
        area=w * h,
        inertia=w * h**3 / 12.0,
        fourth=0.15 * h**2,
        shear_coefficient=SHEAR_COEFFICIENTS["rectangle"],
    )


def _gauss() -> tuple[Array, Array, Array]:
    """Gauss points on (0, 1), their weights, and the matrix (n, n) that integrates from 0 to each point."""
    x, w = np.polynomial.legendre.leggauss(POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    powers = np.vander(x, increasing=True)
    upto = x[:, None] * powers / np.arange(1, POINTS + 1)
    return np.asarray(x), np.asarray(w), np.asarray(np.linalg.solve(powers.T, upto.T).T, dtype=np.float64)


GAUSS_POINTS, GAUSS_WEIGHTS, _UPTO = _gauss()
_INSIDE = shapes_at(GAUSS_POINTS)
_ENDS = shapes_at(np.array([0.0, 1.0]))


class ReducedBeam:
    """Matrices of a beam in its shapes. A coordinate q_k [N] is the force that makes shape k."""

    def __init__(self, parameters: BeamParameters) -> None:
        s, cut = parameters, section_of(parameters.section)
        self.parameters = s
        self.span = s.length + s.grip_depth
        self.bending = YOUNG * s.shear_modulus * cut.inertia
        self.shearing = cut.shear_coefficient * s.shear_modulus * cut.area
        L = self.span
        self.softness = 1.0 / (1.0 + s.axial_gradient * (GAUSS_POINTS * L - 0.5 * L))  # over the mean
        self.bend = L * _INSIDE.moment * self.softness / self.bending  # curvature by coordinate
        self.gamma = _INSIDE.shear * self.softness / self.shearing
        root_moment, root_shear = L * _ENDS.moment[:, 0], _ENDS.shear[:, 0]
        yields = s.clamp_compliance - s.stiff_root / self.bending
        self.root_rotation = yields * root_moment
        self.clamp_rotation = s.clamp_compliance * root_moment
        self.root_sag = s.clamp_sag * root_shear
        # a softer part bends more: the rotation is an integral of the curvature
        self.rotation = self.root_rotation[:, None] + L * self.bend @ _UPTO.T
        self.end_rotation = self.root_rotation + L * self.bend @ GAUSS_WEIGHTS
        stiff = self.bending / self.softness
        self.elastic = L * (self.bend * GAUSS_WEIGHTS * stiff) @ self.bend.T
        self.elastic += L * (self.gamma * GAUSS_WEIGHTS * self.shearing / self.softness) @ self.gamma.T
        self.elastic += yields * np.outer(root_moment, root_moment)
        self.elastic += s.clamp_sag * np.outer(root_shear, root_shear)
        self.cubic = L * GAUSS_WEIGHTS * stiff * 6.0 * s.stiffening * cut.fourth
        self.curved = L * (self.bend * GAUSS_WEIGHTS * stiff).sum(axis=1) * s.curvature
        # resultant of all load beyond a point, (n, 2)
        hung = np.asarray(s.tip_force)
        weight = s.density * cut.area * L * np.asarray(s.gravity)
        self.pull = hung + np.multiply.outer(1.0 - GAUSS_POINTS, weight)
        self.hung = hung
        self.weight = weight
        self.line, self.spin = s.density * cut.area, s.density * cut.inertia
        self.section = s.section

    def forces(self, q: Array) -> tuple[Array, Array]:
        """Elastic forces (k,) at coordinates q, less those of the loads, and their derivatives (k, k)."""
        kappa = q @ self.bend
        elastic = self.elastic @ q + self.bend @ (self.cubic * kappa**3) - self.curved
        stiff = self.tangent(q)
        theta, gamma = q @ self.rotation, q @ self.gamma
        c, s = np.cos(theta), np.sin(theta)
        nx, nz = self.pull.T
        w = self.span * GAUSS_WEIGHTS
        by_theta = nx * (-s - gamma * c) + nz * (c - gamma * s)
        by_gamma = -nx * s + nz * c
        load = self.rotation @ (w * by_theta) + self.gamma @ (w * by_gamma)
        both = nx * (-c) + nz * (-s)
        twice = nx * (-c + gamma * s) + nz * (-s - gamma * c)
        slope = (self.rotation * (w * twice)) @ self.rotation.T
        mixed = (self.rotation * (w * both)) @ self.gamma.T
        slope += mixed + mixed.T
        load += self.root_sag * (self.hung[1] + self.weight[1])
        # the hung weight acts at a height on the end face
        end = float(q @ self.end_rotation)
        h = self.parameters.load_height
        load += h * self.end_rotation * float(-np.cos(end) * self.hung[0] - np.sin(end) * self.hung[1])
        slope += (
            h
            * np.outer(self.end_rotation, self.end_rotation)
            * float(np.sin(end) * self.hung[0] - np.cos(end) * self.hung[1])
        )
        return elastic - load, stiff - slope

    def tangent(self, q: Array) -> Array:
        """Elastic stiffness (k, k) at q."""
        kappa = q @ self.bend
        return np.asarray(self.elastic + (self.bend * (3.0 * self.cubic * kappa**2)) @ self.bend.T)

    def mass(self, q: Array) -> Array:
        """Mass matrix (k, k) at q."""
        theta, gamma = q @ self.rotation, q @ self.gamma
        c, s = np.cos(theta), np.sin(theta)
        slope_x = self.rotation * (-s - gamma * c) - self.gamma * s
        slope_z = self.rotation * (c - gamma * s) + self.gamma * c
        L = self.span
        x, z = L * slope_x @ _UPTO.T, L * slope_z @ _UPTO.T + self.root_sag[:, None]
        w = L * GAUSS_WEIGHTS
        found = (
            self.line * ((x * w) @ x.T + (z * w) @ z.T) + self.spin * (self.rotation * w) @ self.rotation.T
        )
        m = self.parameters.tip_mass
        if m:
            end = float(q @ self.end_rotation)
            h = self.parameters.load_height
            tip_x = L * slope_x @ GAUSS_WEIGHTS - h * np.cos(end) * self.end_rotation
            tip_z = L * slope_z @ GAUSS_WEIGHTS + self.root_sag - h * np.sin(end) * self.end_rotation
            cut = section_of(self.section)
            found += m * (np.outer(tip_x, tip_x) + np.outer(tip_z, tip_z))
            found += m * cut.inertia / cut.area * np.outer(self.end_rotation, self.end_rotation)
        return np.asarray((1.0 + self.parameters.extra_inertia) * found)

    def equilibrium(self) -> Array:
        """Static equilibrium (k,). ValueError where Newton's method finds none."""
        q = np.zeros(len(self.elastic))
        scale = float(np.abs(self.forces(q)[0]).max()) or 1.0
        for _ in range(_ITERATIONS):
            left, slope = self.forces(q)
            if not np.isfinite(left).all():
                break
            if float(np.abs(left).max()) < _TOLERANCE * scale:
                return q
            try:
                move = np.linalg.solve(slope, -left)
            except np.linalg.LinAlgError:
                break
            farthest = float(np.abs(move @ self.rotation).max(initial=0.0))
            q = q + move * min(1.0, 0.3 / farthest if farthest > 0.0 else 1.0)
        raise ValueError("the beam has no equilibrium")
