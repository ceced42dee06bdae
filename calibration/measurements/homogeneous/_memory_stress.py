"""Nominal stress of a material that remembers, along the course of each test. No mesh, and no volume change.

At J = 1 the deformation is known beforehand, so that all times are evaluated at once by tisim's own material
points: the isochoric stress S at its deformation and the largest energy so far, then

    Q_i(n+1) = exp(-h) Q_i(n) + g_i c(h) [S(n+1) - S(n)],    h = dt/tau_i,    c(h) = (1 - exp(-h))/h

which is how tisim integrates each term (`tisim.discretisation.history`). The pressure follows from the free
side. With fibres the two free sides of a strip differ, and the lateral stretch is found from their stresses;
the axes do not turn: of fibres off the axes the grips take up the shear stress.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from calibration.experiment.model import CouponMode
from calibration.measurements.homogeneous._course import Course
from calibration.measurements.homogeneous.stress import DRIVEN
from tisim import Material, laws
from tisim.parts import MaterialPoints

Array = NDArray[np.float64]
Test = tuple[CouponMode, Course, Array]  # mode, course, stretch (f,) along it

# of a stress, those components that a test sees: the driven ones and the sides
_AXIS, _OTHER = np.array([0, 0, 1, 2]), np.array([0, 2, 1, 2])
PASSES = 40
ENOUGH = 1e-7  # stress of a free side, over the shear modulus
LONGEST = 0.2  # step of ln of a lateral stretch
_DIFFERENCE = 1e-6


def stresses_along(material: Material, tests: Sequence[Test]) -> list[Array]:
    """Nominal stress along each test [Pa], shape (f,). A test begins at rest, what it first reaches at once.

    NaN where no lateral stretch was found, which fibres ask for. ValueError, in one sentence: unsound
    material.
    """
    sizes = np.array([s.size for _, _, s in tests])
    begins = np.cumsum(sizes) - sizes
    F = np.concatenate([_gradients(mode, s) for mode, _, s in tests])
    modes = np.repeat([mode for mode, _, _ in tests], sizes)
    sheared, lost = modes == "simple-shear", np.zeros(len(F), dtype=bool)
    if material.fibres is not None and (modes == "uniaxial").any():
        F, lost = _balanced(material, tests, F, begins, modes == "uniaxial")
    S = _relaxing(material, tests, _isochoric(material, tests, F, begins), begins)
    pulled = F[:, 0, 0] * S[:, 0, 0] - F[:, 2, 2] ** 2 / F[:, 0, 0] * S[:, 2, 2]
    stress = np.where(sheared, S[:, 0, 2] + F[:, 0, 2] * S[:, 2, 2], pulled)
    stress[lost] = np.nan
    return np.split(stress, begins[1:])


def _balanced(
    material: Material,
    tests: Sequence[Test],
    F: Array,
    begins: NDArray[np.intp],
    free: NDArray[np.bool_],
) -> tuple[Array, NDArray[np.bool_]]:
    """F with the lateral stretches at which both sides are free of stress, and rows where none was found.

    Newton's method for all times at once: later stresses depend on earlier stretches, so that its linear
    system is triangular. The largest energy so far is taken along from pass to pass.
    """
    modulus = laws.get(material.law).moduli(material.parameters).shear_modulus
    by = np.zeros(len(F))
    for _ in range(PASSES):
        at, beside = _squeezed(F, by), _squeezed(F, by + _DIFFERENCE)
        S = _isochoric(material, tests, at, begins)
        slope = (_isochoric(material, tests, beside, begins) - S) / _DIFFERENCE
        total = _relaxing(material, tests, S, begins)
        side, other = (at[:, k, k] ** 2 * total[:, k, k] for k in (1, 2))
        left = np.where(free, side - other, 0.0)
        lost = ~(np.abs(left) <= ENOUGH * modulus)
        if not lost.any() or not np.isfinite(left).all():
            break
        weights = np.stack([at[:, 1, 1] ** 2, -(at[:, 2, 2] ** 2)], axis=1)
        slopes = weights * np.stack([slope[:, 1, 1], slope[:, 2, 2]], axis=1)
        move = _triangular(material, tests, left, weights, slopes, 2.0 * (side + other), begins)
        by = by + np.clip(np.where(free, move, 0.0), -LONGEST, LONGEST)
    return at, lost


def _squeezed(F: Array, by: Array) -> Array:
    """F with axis 2 longer by the factor exp(by) (n,), and axis 3 shorter."""
    found = F.copy()
    found[:, 1, 1] *= np.exp(by)
    found[:, 2, 2] *= np.exp(-by)
    return found


def _triangular(
    material: Material,
    tests: Sequence[Test],
    left: Array,
    weights: Array,
    slopes: Array,
    own: Array,
    begins: NDArray[np.intp],
) -> Array:
    """Newton's step (n,): what is left (n,), weights of both stresses in it (n, 2), these times the slopes of
    both isochoric stresses (n, 2), and its slope where stresses stay (n,)."""
    dt = _steps(tests)
    if material.viscosity is None:
        return np.asarray(-left / (slopes.sum(axis=1) + own))
    spectrum = material.viscosity.spectrum()
    h = dt[:, None] / spectrum.times
    decay, gain = np.exp(-h), spectrum.strengths * _weight(h)
    decay[begins] = 0.0
    scale = spectrum.equilibrium + gain.sum(axis=1)
    bottom = scale * slopes.sum(axis=1) + own
    # plain numbers: a pass over all times in Python is faster so than by arrays of two
    pure, sides, rest = (slopes / weights).tolist(), weights.tolist(), left.tolist()
    decays, gains, first = decay.tolist(), gain.tolist(), set(begins.tolist())
    moves = np.zeros(len(left))
    Q = [(0.0, 0.0)] * len(spectrum.times)
    a = b = 0.0
    for n, divisor in enumerate(bottom.tolist()):
        if n in first:
            a = b = 0.0
        Q = [(e * x - g * a, e * y - g * b) for e, g, (x, y) in zip(decays[n], gains[n], Q, strict=True)]
        kept = sides[n][0] * sum(x for x, _ in Q) + sides[n][1] * sum(y for _, y in Q)
        moves[n] = move = -(rest[n] + kept) / divisor
        a, b = pure[n][0] * move, pure[n][1] * move
        Q = [(x + g * a, y + g * b) for g, (x, y) in zip(gains[n], Q, strict=True)]
    return moves


def _gradients(mode: CouponMode, stretch: Array) -> Array:
    """F (f, 3, 3) at J = 1."""
    F = np.zeros((stretch.size, 3, 3))
    axis = np.arange(3)
    if mode == "simple-shear":
        F[:, axis, axis] = 1.0
        F[:, 0, 2] = stretch - 1.0
    else:
        F[:, axis, axis] = stretch[:, None] ** np.array(DRIVEN[mode])
    return F


def _isochoric(material: Material, tests: Sequence[Test], F: Array, begins: NDArray[np.intp]) -> Array:
    """S_iso (n, 3, 3), softened, without viscosity."""
    plain = replace(material, viscosity=None, softening=None)
    if material.softening is None:
        P = _evaluate(plain, F)[1]
    else:
        before = np.concatenate([_gradients(mode, np.array([c.before])) for mode, c, _ in tests])
        everything = np.concatenate([F, before])
        energy = _evaluate(plain, everything)[0]
        peaks = np.empty(len(F), dtype=np.intp)
        for k, begin in enumerate(begins):
            end = begin + tests[k][2].size
            own = np.concatenate([[len(F) + k], np.arange(begin, end)])  # the largest of earlier tests first
            top = np.maximum.accumulate(energy[own])
            latest = np.maximum.accumulate(np.where(energy[own] >= top, np.arange(len(own)), 0))
            peaks[begin:end] = own[latest[1:]]
        points = MaterialPoints(replace(plain, softening=material.softening), len(F))
        points.begin(0.0)
        points.accept(everything[peaks])
        P = points.evaluate(F)[1]
    C = np.einsum("nki,nkj->nij", F, F)
    S = np.linalg.solve(F, P)
    pressure = np.einsum("nij,nij->n", S, C) / 3.0
    return np.asarray(S - pressure[:, None, None] * np.linalg.inv(C))


def _evaluate(material: Material, F: Array) -> tuple[Array, Array]:
    """Energy (n,) and first Piola-Kirchhoff stress (n, 3, 3) of a material that remembers nothing."""
    if material.has_parts:
        energy, P, _ = MaterialPoints(material, len(F)).evaluate(F)
    else:
        energy, P, _ = laws.evaluate(material.law, material.parameters, F)
    return energy, P


def _relaxing(material: Material, tests: Sequence[Test], S: Array, begins: NDArray[np.intp]) -> Array:
    """Long-time part of S (n, 3, 3) and its viscous terms."""
    if material.viscosity is None:
        return S
    spectrum = material.viscosity.spectrum()
    dt, flat = _steps(tests), S[:, _AXIS, _OTHER]
    change = np.diff(flat, axis=0, prepend=0.0)
    change[begins] = flat[begins]  # from rest
    total = spectrum.equilibrium * flat
    for strength, tau in zip(spectrum.strengths, spectrum.times, strict=True):
        decay = np.exp(-dt / tau)
        decay[begins] = 0.0
        bands = np.ones((2, len(S)))
        bands[1, :-1] = -decay[1:]
        own = strength * _weight(dt / tau)[:, None] * change
        total = total + solve_banded((1, 0), bands, own, check_finite=False)
    found = np.zeros_like(S)
    found[:, _AXIS, _OTHER] = total
    return found


def _steps(tests: Sequence[Test]) -> Array:
    """Lengths of time steps [s], the first of each test 0."""
    return np.concatenate([np.diff(c.time, prepend=c.time[0]) for _, c, _ in tests])


def _weight(h: Array) -> Array:
    """(1 - exp(-h))/h, 1 at h = 0."""
    safe = np.where(h > 0.0, h, 1.0)
    return np.where(h > 0.0, -np.expm1(-safe) / safe, 1.0)
