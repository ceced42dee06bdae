"""Nominal stress of a history-dependent material along the course of each test, at constant volume, no mesh.

At J = 1 the deformation is known in advance, so that all times are evaluated at once by tisim's material
points: the isochoric stress S at the deformation and the largest energy so far, then

    Q_i(n+1) = exp(-h) Q_i(n) + g_i c(h) [S(n+1) - S(n)],    h = dt/tau_i,    c(h) = (1 - exp(-h))/h

as tisim integrates each term (`tisim.discretisation.history`). The pressure follows from the traction-free
side. `_balance` solves for the free deformations of a strip with fibres, and of a cylinder after its platens
lose contact; in planar and equibiaxial tests the grips carry the shear stress of fibres off the axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from calibration.experiment.model import CouponMode
from calibration.measurements.homogeneous._balance import LATERAL, SHEAR, Memory, along, balanced
from calibration.measurements.homogeneous._course import Course
from calibration.measurements.homogeneous.stress import DRIVEN
from tisim import Material, laws
from tisim.parts import MaterialPoints, ramp_weight

Array = NDArray[np.float64]
Test = tuple[CouponMode, Course, Array]  # mode, course, stretch (f,) along it

# components of the stress that enter a test: those of the driven directions and of the sides
_AXIS, _OTHER = np.array([0, 0, 0, 1, 2]), np.array([0, 1, 2, 1, 2])


def stresses_along(material: Material, tests: Sequence[Test]) -> list[Array]:
    """Nominal stress along each test [Pa], shape (f,).

    A test begins at rest; its first deformation is applied as a jump. NaN at times for which `_balance` does
    not converge. ValueError, in one sentence, for an invalid material.
    """
    sizes = np.array([s.size for _, _, s in tests])
    begins = np.cumsum(sizes) - sizes
    F = np.concatenate([_gradients(mode, s) for mode, _, s in tests])
    modes = np.repeat([mode for mode, _, _ in tests], sizes)
    sheared, strips = modes == "simple-shear", modes == "uniaxial"
    pushed = np.repeat([course.pushes for _, course, _ in tests], sizes) & strips
    lost = np.zeros(len(F), dtype=bool)
    memory = _memory(material, tests, begins)
    free = np.zeros((len(F), 3), dtype=bool)
    if material.fibres is not None:
        free[:, LATERAL] = strips
        free[:, SHEAR] = strips & _oblique(material)
    if free.any() or pushed.any():
        F, lost = balanced(
            F,
            free,
            pushed,
            isochoric=lambda at: _isochoric(material, tests, at, begins),
            totals=lambda S: _relaxing(S, memory),
            memory=memory,
            modulus=laws.get(material.law).moduli(material.parameters).shear_modulus,
        )
    S = _relaxing(_isochoric(material, tests, F, begins), memory)
    stress = np.where(sheared, S[:, 0, 2] + F[:, 0, 2] * S[:, 2, 2], along(F, S))
    stress[lost] = np.nan
    return np.split(stress, begins[1:])


def _oblique(material: Material) -> bool:
    """True if the fibres lie along none of the axes of a test."""
    direction = np.abs(np.asarray(getattr(material.fibres, "direction", (1.0, 1.0, 1.0)), dtype=float))
    return bool(np.sort(direction)[1] > 1e-12 * direction.max())


def _gradients(mode: CouponMode, stretch: Array) -> Array:
    """Deformation gradients (f, 3, 3) at J = 1."""
    F = np.zeros((stretch.size, 3, 3))
    axis = np.arange(3)
    if mode == "simple-shear":
        F[:, axis, axis] = 1.0
        F[:, 0, 2] = stretch - 1.0
    else:
        F[:, axis, axis] = stretch[:, None] ** np.array(DRIVEN[mode])
    return F


def _isochoric(material: Material, tests: Sequence[Test], F: Array, begins: NDArray[np.intp]) -> Array:
    """Isochoric second Piola-Kirchhoff stress (n, 3, 3), with softening, without viscosity."""
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
            own = np.concatenate([[len(F) + k], np.arange(begin, end)])  # the peak of earlier tests first
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
    """Energy (n,) and first Piola-Kirchhoff stress (n, 3, 3), without viscosity and softening."""
    if material.has_parts:
        energy, P, _ = MaterialPoints(material, len(F)).evaluate(F)
    else:
        energy, P, _ = laws.evaluate(material.law, material.parameters, F)
    return energy, P


def _memory(material: Material, tests: Sequence[Test], begins: NDArray[np.intp]) -> Memory:
    steps = np.concatenate([np.diff(c.time, prepend=c.time[0]) for _, c, _ in tests])
    if material.viscosity is None:
        none = np.zeros((len(steps), 0))
        return Memory(equilibrium=1.0, decays=none, gains=none, begins=begins)
    spectrum = material.viscosity.spectrum()
    h = steps[:, None] / spectrum.times
    decays = np.exp(-h)
    decays[begins] = 0.0
    return Memory(
        equilibrium=spectrum.equilibrium,
        decays=decays,
        gains=spectrum.strengths * ramp_weight(h),
        begins=begins,
    )


def _relaxing(S: Array, memory: Memory) -> Array:
    """Sum of the long-time part of S (n, 3, 3) and its viscous terms (`Memory`)."""
    flat = S[:, _AXIS, _OTHER]
    change = np.diff(flat, axis=0, prepend=0.0)
    change[memory.begins] = flat[memory.begins]  # from rest
    total = memory.equilibrium * flat
    for decay, gain in zip(memory.decays.T, memory.gains.T, strict=True):
        bands = np.ones((2, len(S)))
        bands[1, :-1] = -decay[1:]
        total = total + solve_banded((1, 0), bands, gain[:, None] * change, check_finite=False)
    found = np.zeros_like(S)
    found[:, _AXIS, _OTHER] = total
    return found
