"""Reduced model of a beam: Galerkin's method for a planar, inextensible beam with shear (Reissner).

Its shape functions contain the statics of a short thick cantilever exactly, and its lowest modes closely. The
equilibrium is solved with finite rotations; `_vibration` adds the motion about it, `_fem` corrections by FEM.
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
POINTS = 12  # Gauss points along the beam
_ITERATIONS, _TOLERANCE = 30, 1e-12


@dataclass(frozen=True, kw_only=True)
class BeamParameters:
    """Parameters of a beam along x with one clamp, in the plane (x, z), and of its cameras; SI units.

    Effects change these parameters.

    Attributes
    ----------
    section : cross section.
    shear_modulus : storage modulus at the angular frequency 1 / `reference_time` [Pa]; E = 3 G.
    density : [kg/m3].
    length : free length [m].
    relaxation_time : stiffness-proportional damping [s].
    mass_damping : mass-proportional damping [1/s].
    reference_time : see `shear_modulus` [s].
    branches : further relaxation branches, (fraction of `shear_modulus`, time [s]) each.
    grip_depth : length inside the clamp that is free as well [m]; the root is at x = -grip_depth.
    gravity : (x, z) [m/s2].
    tip_force : (x, z) [N].
    tip_mass : mass that moves with the tip [kg].
    load_height : height on the end face at which tip force and mass act [m].
    clamp_compliance : rotation of the clamp per moment [rad/(N m)].
    clamp_sag : displacement of the clamp per force [m/N].
    curvature : curvature of the stress-free beam [1/m].
    stiffening : c2 / c1 of the strain energy.
    axial_gradient : relative change of the modulus along x [1/m], zero in the middle.
    stiff_root : effective rigid length next to the clamp [m], since the clamp also prevents deformation of
        the section; beam theory lacks it, `_fem` determines it.
    extra_inertia : relative excess of the inertia over the mass of the weight.
    image_scale : relative excess of the displacements in the images.
    camera_roll : rotation of the cameras' frame [rad].
    clock_rate : relative excess of true time over the cameras' time.
    held_below : drop of the tip, in the shape of the equilibrium, at which the beam was held [m];
        displacements are relative to that shape.
    rubbing : deflection of the tip that the dry friction of the hung mass could hold [m].
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
    """Timoshenko cantilever of unit length at n points, under k loads of unit size.

    The loads are a tip force, a tip moment, and distributed loads p = 1, x, x^2.

    Attributes
    ----------
    rotation : rotation of the section, the integral of the moment, shape (k, n).
    moment, shear : bending moment and shear force, shape (k, n).
    """

    rotation: Array
    moment: Array
    shear: Array


def _polynomials() -> list[tuple[Polynomial, Polynomial, Polynomial]]:
    """Polynomials of rotation, moment and shear force for each load."""
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
    """Shape functions at x (n,), fractions of the length."""
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
    fourth : ratio of the fourth to the second moment of area [m2].
    shear_coefficient : Cowper's shear coefficient.
    """

    area: float
    inertia: float
    fourth: float
    shear_coefficient: float


def section_of(shape: Circle | Rectangle) -> Section:
    """Moments of a circular or rectangular section."""
    if isinstance(shape, Circle):
        kind, fourth = "circle", shape.radius**2 / 2.0
    else:
        kind, fourth = "rectangle", 0.15 * shape.height**2
    return Section(
        area=shape.area,
        inertia=shape.second_moment("y"),
        fourth=fourth,
        shear_coefficient=SHEAR_COEFFICIENTS[kind],
    )


def _gauss() -> tuple[Array, Array, Array]:
    """Gauss points on (0, 1), weights, and the matrix (n, n) of integration from 0 to each point."""
    x, w = np.polynomial.legendre.leggauss(POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    powers = np.vander(x, increasing=True)
    upto = x[:, None] * powers / np.arange(1, POINTS + 1)
    return np.asarray(x), np.asarray(w), np.asarray(np.linalg.solve(powers.T, upto.T).T, dtype=np.float64)


GAUSS_POINTS, GAUSS_WEIGHTS, _UPTO = _gauss()
_INSIDE = shapes_at(GAUSS_POINTS)
_ENDS = shapes_at(np.array([0.0, 1.0]))


class ReducedBeam:
    """Forces and matrices of a beam in its shape functions; a coordinate q_k [N] is the force of shape k."""

    def __init__(self, parameters: BeamParameters) -> None:
        s, cut = parameters, section_of(parameters.section)
        self.parameters = s
        self.span = s.length + s.grip_depth
        self.bending = YOUNG * s.shear_modulus * cut.inertia
        self.shearing = cut.shear_coefficient * s.shear_modulus * cut.area
        L = self.span
        self.softness = 1.0 / (1.0 + s.axial_gradient * (GAUSS_POINTS * L - 0.5 * L))  # over the mean
        self.bend = L * _INSIDE.moment * self.softness / self.bending  # curvature per coordinate
        self.gamma = _INSIDE.shear * self.softness / self.shearing
        root_moment, root_shear = L * _ENDS.moment[:, 0], _ENDS.shear[:, 0]
        yields = s.clamp_compliance - s.stiff_root / self.bending
        self.root_rotation = yields * root_moment
        self.clamp_rotation = s.clamp_compliance * root_moment
        self.root_sag = s.clamp_sag * root_shear
        # with a variable modulus the rotation is the numerical integral of the curvature
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
        """Elastic minus load forces (k,) at coordinates q (k,), and their derivatives (k, k)."""
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
        """Coordinates of the static equilibrium (k,). ValueError if Newton's method does not converge."""
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
