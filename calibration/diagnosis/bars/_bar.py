"""The reduced bar: where it settles with finite rotations, and how it swings about there.

Galerkin's method on a planar beam with shear (Reissner) whose axis does not stretch. The equilibrium is
solved with finite rotations; the motion is linear about it, mode by mode with the viscoelastic memory of the
material, and goes to the markers through the finite kinematics. What three dimensions add comes from FEM
(`_fem`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars._shapes import YOUNG, gauss, section_of, shapes_at

Array = NDArray[np.float64]

_X, _W, _UPTO = gauss()
_INSIDE = shapes_at(_X)
_ENDS = shapes_at(np.array([0.0, 1.0]))
_ITERATIONS, _TOLERANCE = 30, 1e-12
_ALONG = 6  # quadrature points from the clamp to a marker
_G6, _W6 = (0.5 * (v + s) for v, s in zip(np.polynomial.legendre.leggauss(_ALONG), (1.0, 0.0), strict=True))


@dataclass(frozen=True, eq=False, kw_only=True)
class Swing:
    """A solved bar. settled (k,): coordinates where it would settle if nothing relaxed any further than at
    the setting's reference; modes (k, k), one a column; rates, starts: beside the settled coordinates, in
    modes, y_i(t) = rest_i + Re sum_j starts_ij exp(rates_ij t). frequencies (k,): of the undamped modes
    [Hz]."""

    setting: Setting
    settled: Array
    modes: Array
    rates: NDArray[np.complex128]
    starts: NDArray[np.complex128]
    rest: Array
    frequencies: Array

    def coordinates(self, time: Array) -> Array:
        """(t, k) at times since the release [s]."""
        t = np.maximum(np.asarray(time, dtype=float), 0.0)
        y = np.einsum("ij,tij->ti", self.starts, np.exp(np.multiply.outer(t, self.rates))).real + self.rest
        return self.settled + y @ self.modes.T


class Reduced:
    """A bar's matrices in its shapes; see `swing`."""

    def __init__(self, setting: Setting) -> None:
        s, cut = setting, section_of(setting.section)
        self.setting = s
        self.span = s.length + s.depth
        self.bending = YOUNG * s.shear * cut.inertia
        self.shearing = cut.sheared * s.shear * cut.area
        # the coordinate of a shape is the force [N] that makes it
        L = self.span
        self.softness = 1.0 / (1.0 + s.gradient * (_X * L - 0.5 * L))  # of a place, over the mean
        self.bend = L * _INSIDE.moment * self.softness / self.bending  # curvature by coordinate
        self.gamma = _INSIDE.shear * self.softness / self.shearing
        root_moment, root_shear = L * _ENDS.moment[:, 0], _ENDS.shear[:, 0]
        yields = s.clamp_turn - s.stiff_root / self.bending
        self.root_turn = yields * root_moment
        self.clamp_turn = s.clamp_turn * root_moment
        self.root_sag = s.clamp_sag * root_shear
        # a softer place bends more: the turn is integrated where the modulus is not one
        self.turn = self.root_turn[:, None] + L * self.bend @ _UPTO.T
        self.end_turn = self.root_turn + L * self.bend @ _W
        stiff = self.bending / self.softness
        self.elastic = L * (self.bend * _W * stiff) @ self.bend.T
        self.elastic += L * (self.gamma * _W * self.shearing / self.softness) @ self.gamma.T
        self.elastic += yields * np.outer(root_moment, root_moment)
        self.elastic += s.clamp_sag * np.outer(root_shear, root_shear)
        self.cubic = L * _W * stiff * 6.0 * s.stiffening * cut.fourth
        self.curved = L * (self.bend * _W * stiff).sum(axis=1) * s.curvature
        # resultant of all load beyond a place, (n, 2)
        hung = np.asarray(s.tip_force)
        weight = s.density * cut.area * L * np.asarray(s.gravity)
        self.pull = hung + np.multiply.outer(1.0 - _X, weight)
        self.hung = hung
        self.weight = weight
        self.line, self.spin = s.density * cut.area, s.density * cut.inertia
        self.section = s.section

    def forces(self, q: Array) -> tuple[Array, Array]:
        """Elastic forces of coordinates q, less those of the loads, and their slope (k, k)."""
        kappa = q @ self.bend
        elastic = self.elastic @ q + self.bend @ (self.cubic * kappa**3) - self.curved
        stiff = self.tangent(q)
        theta, gamma = q @ self.turn, q @ self.gamma
        c, s = np.cos(theta), np.sin(theta)
        nx, nz = self.pull.T
        w = self.span * _W
        by_theta = nx * (-s - gamma * c) + nz * (c - gamma * s)
        by_gamma = -nx * s + nz * c
        load = self.turn @ (w * by_theta) + self.gamma @ (w * by_gamma)
        both = nx * (-c) + nz * (-s)
        twice = nx * (-c + gamma * s) + nz * (-s - gamma * c)
        slope = (self.turn * (w * twice)) @ self.turn.T
        mixed = (self.turn * (w * both)) @ self.gamma.T
        slope += mixed + mixed.T
        load += self.root_sag * (self.hung[1] + self.weight[1])
        # the hung weight acts at a height on the end face
        end = float(q @ self.end_turn)
        h = self.setting.load_height
        load += h * self.end_turn * float(-np.cos(end) * self.hung[0] - np.sin(end) * self.hung[1])
        slope += (
            h
            * np.outer(self.end_turn, self.end_turn)
            * float(np.sin(end) * self.hung[0] - np.cos(end) * self.hung[1])
        )
        return elastic - load, stiff - slope

    def tangent(self, q: Array) -> Array:
        """Elastic stiffness at q."""
        kappa = q @ self.bend
        return np.asarray(self.elastic + (self.bend * (3.0 * self.cubic * kappa**2)) @ self.bend.T)

    def mass(self, q: Array) -> Array:
        """At q, (k, k)."""
        theta, gamma = q @ self.turn, q @ self.gamma
        c, s = np.cos(theta), np.sin(theta)
        slope_x = self.turn * (-s - gamma * c) - self.gamma * s
        slope_z = self.turn * (c - gamma * s) + self.gamma * c
        L = self.span
        x, z = L * slope_x @ _UPTO.T, L * slope_z @ _UPTO.T + self.root_sag[:, None]
        w = L * _W
        found = self.line * ((x * w) @ x.T + (z * w) @ z.T) + self.spin * (self.turn * w) @ self.turn.T
        m = self.setting.tip_mass
        if m:
            end = float(q @ self.end_turn)
            h = self.setting.load_height
            tip_x = L * slope_x @ _W - h * np.cos(end) * self.end_turn
            tip_z = L * slope_z @ _W + self.root_sag - h * np.sin(end) * self.end_turn
            cut = section_of(self.section)
            found += m * (np.outer(tip_x, tip_x) + np.outer(tip_z, tip_z))
            found += m * cut.inertia / cut.area * np.outer(self.end_turn, self.end_turn)
        return np.asarray((1.0 + self.setting.inertia) * found)

    def settled(self) -> Array:
        """Equilibrium (k,). ValueError where Newton's method finds none."""
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
            farthest = float(np.abs(move @ self.turn).max(initial=0.0))
            q = q + move * min(1.0, 0.3 / farthest if farthest > 0.0 else 1.0)
        raise ValueError("the bar has no equilibrium")


def swing(setting: Setting, *, start: float = 0.0) -> Swing:
    """The bar let go at rest from `start` times its settled pose. ValueError where it has no equilibrium, or
    none that is stable."""
    bar = Reduced(setting)
    q = bar.settled()
    elastic = bar.tangent(q)
    whole = bar.forces(q)[1]
    mass = bar.mass(q)
    squares, modes = eigh(whole, mass)
    if squares[0] <= 0.0:
        raise ValueError("the bar's equilibrium is not stable")
    kappa = np.einsum("ki,kl,li->i", modes, elastic, modes)
    held = modes.T @ (bar.elastic @ q + bar.bend @ (bar.cubic * (q @ bar.bend) ** 3) - bar.curved)
    parts = np.array([p for p, _ in setting.branches])
    times = np.array([t for _, t in setting.branches])
    # storage modulus of the branches at the reference: it belongs to the modulus there
    slow = (times / setting.reference) ** 2
    last = 1.0 - float(np.sum(parts * slow / (1.0 + slow)))
    first = last + float(parts.sum())
    k, b = len(q), len(parts)
    system = np.zeros((k, 2 + b, 2 + b))
    system[:, 0, 1] = 1.0
    system[:, 1, 0] = -(squares - kappa) - kappa * first
    system[:, 1, 1] = -setting.drag - kappa * setting.viscous
    system[:, 1, 2:] = np.multiply.outer(kappa, parts)
    for j in range(b):
        system[:, 2 + j, 0] = 1.0 / times[j]
        system[:, 2 + j, 2 + j] = -1.0 / times[j]
    relaxed = kappa * last + squares - kappa
    if (relaxed <= 0.0).any():
        raise ValueError("the bar's modulus relaxes to nothing")
    rest = (1.0 - last) * held / relaxed
    begin = np.zeros((k, 2 + b))
    begin[:, 0] = (start - 1.0) * (modes.T @ mass @ q) - rest
    # held straight for long, its memory is of that pose
    begin[:, 2:] = begin[:, :1]
    rates, vectors = np.linalg.eig(system)
    weights = np.linalg.solve(vectors.astype(complex), begin[:, :, None].astype(complex))[:, :, 0]
    return Swing(
        setting=setting,
        settled=q,
        modes=modes,
        rates=rates,
        starts=vectors[:, 0, :] * weights,
        rest=rest,
        frequencies=np.sqrt(squares) / (2.0 * np.pi),
    )


@dataclass(frozen=True, eq=False)
class Carried:
    """displacement (m, t, 2): of markers, x and z [m]; turn (m, t): of what carries them [rad]."""

    displacement: Array
    turn: Array


def carried(setting: Setting, coordinates: Array, places: Sequence[tuple[float, float]]) -> Carried:
    """Markers at (x, z) of the straight bar, as if on rigid stalks; coordinates (t, k)."""
    bar = Reduced(setting)
    moved = np.zeros((len(places), len(coordinates), 2))
    turns = np.zeros((len(places), len(coordinates)))
    for i, (x, z) in enumerate(places):
        s = float(np.clip(x + setting.depth, 0.0, bar.span))
        theta, sheared = _along(bar, coordinates, s)
        c, n = np.cos(theta), np.sin(theta)
        w = s * _W6
        at_x = (c - sheared * n) @ w - s
        at_z = (n + sheared * c) @ w + coordinates @ bar.root_sag
        end = coordinates @ _turn_at(bar, s)
        moved[i, :, 0] = at_x - z * np.sin(end)
        moved[i, :, 1] = at_z + z * (np.cos(end) - 1.0)
        turns[i] = end
    return Carried(moved, turns)


def clamp_motion(setting: Setting, coordinates: Array, places: Sequence[tuple[float, float]]) -> Carried:
    """The same of markers that sit on the clamp."""
    bar = Reduced(setting)
    theta, sag = coordinates @ bar.clamp_turn, coordinates @ bar.root_sag
    moved = np.zeros((len(places), len(coordinates), 2))
    for i, (x, z) in enumerate(places):
        moved[i, :, 0] = x * (np.cos(theta) - 1.0) - z * np.sin(theta)
        moved[i, :, 1] = sag + x * np.sin(theta) + z * (np.cos(theta) - 1.0)
    return Carried(moved, np.tile(theta, (len(places), 1)))


def _along(bar: Reduced, coordinates: Array, s: float) -> tuple[Array, Array]:
    """Rotation and shear (t, n) at quadrature points between the clamp and s [m]."""
    at = s / bar.span * _G6
    if bar.setting.gradient == 0.0:
        turn = bar.root_turn[:, None] + bar.span**2 * shapes_at(at).turn / bar.bending
    else:
        turn = np.column_stack([_turn_at(bar, bar.span * p) for p in at])
    soft = _softness(bar, at)
    gamma = shapes_at(at).shear * soft / bar.shearing
    return coordinates @ turn, coordinates @ gamma


def _turn_at(bar: Reduced, s: float) -> Array:
    """Rotation by each coordinate at s [m], (k,)."""
    part = s / bar.span
    if bar.setting.gradient == 0.0:
        return np.asarray(bar.root_turn + bar.span**2 * shapes_at(np.array([part])).turn[:, 0] / bar.bending)
    inner = part * _X
    moment = shapes_at(inner).moment * _softness(bar, inner)
    return np.asarray(bar.root_turn + bar.span**2 * part * (moment @ _W) / bar.bending)


def _softness(bar: Reduced, part: Array) -> Array:
    return 1.0 / (1.0 + bar.setting.gradient * bar.span * (part - 0.5))
