"""Free vibration of a released beam, and the motion of markers on it.

The motion is linear about the static equilibrium, in uncoupled viscoelastic modes; markers follow by the
finite kinematics of the reduced beam (`_beam`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from calibration.measurements.release._beam import (
    GAUSS_POINTS,
    GAUSS_WEIGHTS,
    BeamParameters,
    ReducedBeam,
    shapes_at,
)

Array = NDArray[np.float64]

_ALONG = 6  # quadrature points from the clamp to a marker
_G6, _W6 = (0.5 * (v + s) for v, s in zip(np.polynomial.legendre.leggauss(_ALONG), (1.0, 0.0), strict=True))


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeVibration:
    """Solution of the motion, y_i(t) = offset_i + Re sum_j amplitudes_ij exp(rates_ij t) for mode i.

    Attributes
    ----------
    parameters : parameters of the beam.
    equilibrium : coordinates of the equilibrium with the storage modulus at the reference time, shape (k,).
    modes : modes as columns, shape (k, k).
    rates : [1/s], shape (k, j).
    amplitudes : shape (k, j).
    offset : displacement of the modes by relaxation, shape (k,).
    frequencies : frequencies of the undamped modes [Hz], shape (k,).
    rubbed : deflection that dry friction can hold, as a fraction of the first mode's initial amplitude; the
        amplitude decreases by as much in each quarter of a period.
    """

    parameters: BeamParameters
    equilibrium: Array
    modes: Array
    rates: NDArray[np.complex128]
    amplitudes: NDArray[np.complex128]
    offset: Array
    frequencies: Array
    rubbed: float = 0.0

    def coordinates(self, time: Array) -> Array:
        """Coordinates (t, k) at times since the release [s]."""
        t = np.maximum(np.asarray(time, dtype=float), 0.0)
        parts = self.amplitudes * np.exp(np.multiply.outer(t, self.rates))
        if self.rubbed:
            oscillates = np.abs(self.rates[0].imag) > 0.0
            parts[:, 0, oscillates] *= self._left_by_friction(t)[:, None]
        y = parts.sum(axis=2).real
        return self.equilibrium + (y + self.offset) @ self.modes.T

    def _left_by_friction(self, t: Array) -> Array:
        """Factor on the first mode's oscillation by dry friction, shape (t,).

        The amplitude A follows dA/dt = -d A - 4 f r, with damping d, frequency f and r = `rubbed`.
        """
        first = self.rates[0][np.argmax(np.abs(self.rates[0].imag))]
        damping, frequency = -float(first.real), abs(float(first.imag)) / (2.0 * np.pi)
        grown = np.expm1(damping * t) / damping if damping > 0.0 else t
        return np.asarray(np.maximum(1.0 - 4.0 * frequency * self.rubbed * grown, 0.0))


def free_vibration(parameters: BeamParameters, *, start: float = 0.0) -> FreeVibration:
    """Free vibration of a beam released at rest from `start` times its equilibrium.

    ValueError if there is no stable equilibrium, or the relaxed stiffness of a mode is not positive.
    """
    beam = ReducedBeam(parameters)
    q = beam.equilibrium()
    elastic = beam.tangent(q)
    whole = beam.forces(q)[1]
    mass = beam.mass(q)
    squares, modes = eigh(whole, mass)
    if squares[0] <= 0.0:
        raise ValueError("the beam's equilibrium is not stable")
    kappa = np.einsum("ki,kl,li->i", modes, elastic, modes)
    held = modes.T @ (beam.elastic @ q + beam.bend @ (beam.cubic * (q @ beam.bend) ** 3) - beam.curved)
    parts = np.array([p for p, _ in parameters.branches])
    times = np.array([t for _, t in parameters.branches])
    # the storage modulus of the branches at the reference time is included in the shear modulus
    slow = (times / parameters.reference_time) ** 2
    last = 1.0 - float(np.sum(parts * slow / (1.0 + slow)))
    first = last + float(parts.sum())
    k, b = len(q), len(parts)
    system = np.zeros((k, 2 + b, 2 + b))
    system[:, 0, 1] = 1.0
    system[:, 1, 0] = -(squares - kappa) - kappa * first
    system[:, 1, 1] = -parameters.mass_damping - kappa * parameters.relaxation_time
    system[:, 1, 2:] = np.multiply.outer(kappa, parts)
    for j in range(b):
        system[:, 2 + j, 0] = 1.0 / times[j]
        system[:, 2 + j, 2 + j] = -1.0 / times[j]
    relaxed = kappa * last + squares - kappa
    if (relaxed <= 0.0).any():
        raise ValueError("the beam's modulus relaxes to nothing")
    rest = (1.0 - last) * held / relaxed
    begin = np.zeros((k, 2 + b))
    begin[:, 0] = (start - 1.0) * (modes.T @ mass @ q) - rest
    # the beam was held for a long time, so that the branches are relaxed in the initial shape
    begin[:, 2:] = begin[:, :1]
    rates, vectors = np.linalg.eig(system)
    weights = np.linalg.solve(vectors.astype(complex), begin[:, :, None].astype(complex))[:, :, 0]
    return FreeVibration(
        parameters=parameters,
        equilibrium=q,
        modes=modes,
        rates=rates,
        amplitudes=vectors[:, 0, :] * weights,
        offset=rest,
        frequencies=np.sqrt(squares) / (2.0 * np.pi),
    )


@dataclass(frozen=True, eq=False)
class MarkerMotion:
    """Motion of m markers.

    Attributes
    ----------
    displacement : displacement in x and z [m], shape (m, t, 2).
    rotation : rotation of the section or clamp that carries them [rad], shape (m, t).
    """

    displacement: Array
    rotation: Array


def beam_markers(
    parameters: BeamParameters, coordinates: Array, positions: Sequence[tuple[float, float]]
) -> MarkerMotion:
    """Motion of markers at (x, z) of the straight beam, as if on rigid stalks; coordinates (t, k)."""
    beam = ReducedBeam(parameters)
    moved = np.zeros((len(positions), len(coordinates), 2))
    turns = np.zeros((len(positions), len(coordinates)))
    for i, (x, z) in enumerate(positions):
        s = float(np.clip(x + parameters.grip_depth, 0.0, beam.span))
        theta, sheared = _along(beam, coordinates, s)
        c, n = np.cos(theta), np.sin(theta)
        w = s * _W6
        at_x = (c - sheared * n) @ w - s
        at_z = (n + sheared * c) @ w + coordinates @ beam.root_sag
        end = coordinates @ _rotation_at(beam, s)
        moved[i, :, 0] = at_x - z * np.sin(end)
        moved[i, :, 1] = at_z + z * (np.cos(end) - 1.0)
        turns[i] = end
    return MarkerMotion(moved, turns)


def clamp_markers(
    parameters: BeamParameters, coordinates: Array, positions: Sequence[tuple[float, float]]
) -> MarkerMotion:
    """Motion of markers that sit on the clamp; arguments as in `beam_markers`."""
    beam = ReducedBeam(parameters)
    theta, sag = coordinates @ beam.clamp_rotation, coordinates @ beam.root_sag
    moved = np.zeros((len(positions), len(coordinates), 2))
    for i, (x, z) in enumerate(positions):
        moved[i, :, 0] = x * (np.cos(theta) - 1.0) - z * np.sin(theta)
        moved[i, :, 1] = sag + x * np.sin(theta) + z * (np.cos(theta) - 1.0)
    return MarkerMotion(moved, np.tile(theta, (len(positions), 1)))


def _along(beam: ReducedBeam, coordinates: Array, s: float) -> tuple[Array, Array]:
    """Rotation and shear (t, n) at the quadrature points between the root and s [m]."""
    at = s / beam.span * _G6
    if beam.parameters.axial_gradient == 0.0:
        turn = beam.root_rotation[:, None] + beam.span**2 * shapes_at(at).rotation / beam.bending
    else:
        turn = np.column_stack([_rotation_at(beam, beam.span * p) for p in at])
    soft = _softness(beam, at)
    gamma = shapes_at(at).shear * soft / beam.shearing
    return coordinates @ turn, coordinates @ gamma


def _rotation_at(beam: ReducedBeam, s: float) -> Array:
    """Rotation per coordinate at s [m], shape (k,)."""
    part = s / beam.span
    if beam.parameters.axial_gradient == 0.0:
        return np.asarray(
            beam.root_rotation + beam.span**2 * shapes_at(np.array([part])).rotation[:, 0] / beam.bending
        )
    inner = part * GAUSS_POINTS
    moment = shapes_at(inner).moment * _softness(beam, inner)
    return np.asarray(beam.root_rotation + beam.span**2 * part * (moment @ GAUSS_WEIGHTS) / beam.bending)


def _softness(beam: ReducedBeam, part: Array) -> Array:
    return 1.0 / (1.0 + beam.parameters.axial_gradient * beam.span * (part - 0.5))
