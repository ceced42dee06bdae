"""Nominal stress of an isochoric homogeneous test over a course.

The internal stresses are expressed by memory variables: Q_i = g_i (S - M_i) with tau_i dM_i/dt + M_i = S, S
the softened isochoric stress. If the lateral stretch is free and the material has fibres, it is solved for
zero stress on the free sides at each evaluation; otherwise it follows from the volume. The M_i are integrated
by Radau's implicit Runge-Kutta method (order 5, error control), piece by piece of the course.

A uniaxial specimen with fibres off its axes is a long strip: it shears in its plane, lines along axis 1 keep
their direction, and all of its stress is along axis 1. The grips of other modes prevent that shear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Solid

Array = NDArray[np.float64]
MODES = ("uniaxial", "equibiaxial", "planar")
TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """Response of a specimen at given times.

    Attributes
    ----------
    time, stretch : ndarray, shape (t,)
        Time [s] and stretch of axis 1.
    lateral, shear : ndarray, shape (t,)
        Stretch of axis 2, and its shear along axis 1.
    stress : ndarray, shape (t,)
        Nominal stress on axis 1 [Pa].
    energy, largest : ndarray, shape (t,)
        W and its largest value so far [J/m3].
    """

    time: Array
    stretch: Array
    lateral: Array
    shear: Array
    stress: Array
    energy: Array
    largest: Array


def respond(
    solid: Solid, mode: str, course: Course, times: Array | None = None, *, tolerance: float = TOLERANCE
) -> Response:
    """Response to a course at ascending `times` [s], by default those of the record.

    Raises
    ------
    RuntimeError
        If the integration failed, or W of a softening material had a maximum within a piece of the course.
    ValueError
        If the mode is unknown or a time is beyond the course.
    """
    if mode not in MODES:
        raise ValueError(f"mode: expected one of {', '.join(MODES)}, got {mode!r}")
    test = _Test(solid, mode)
    wanted = course.record_times() if times is None else np.asarray(times, dtype=float)
    corner_times, corner_values = course.corners()
    if len(wanted) and wanted[-1] > corner_times[-1] * (1.0 + 1e-12):
        raise ValueError(f"times: {wanted[-1]} s is beyond the end of the course, {corner_times[-1]} s")
    wanted = np.minimum(wanted, corner_times[-1])
    memory = np.zeros((len(solid.prony.times), 4))
    largest = 0.0
    rows: list[tuple[float, ...]] = []
    for piece in range(len(corner_times) - 1):
        begin, end = corner_times[piece], corner_times[piece + 1]
        first, slope = corner_values[piece], np.diff(corner_values)[piece] / (end - begin)
        inside = wanted[(wanted > begin) & (wanted <= end)]
        if piece == 0:
            inside = np.concatenate([wanted[wanted == begin], inside])
        at = np.unique(np.concatenate([inside, np.linspace(begin, end, 33)]))
        memories = _integrate(test, memory, largest, at - begin, first, slope, tolerance)
        points = [test.at(first + slope * (t - begin), m, largest) for t, m in zip(at, memories, strict=True)]
        energies = np.array([p.energy for p in points])
        peak = np.maximum.accumulate(np.maximum(energies, largest))
        if (peak > np.maximum(energies, largest) * (1.0 + 1e-9)).any() and solid.softening is not None:
            raise RuntimeError("coupon: the energy rose to a new maximum and fell within one piece")
        for t, p in zip(at, points, strict=True):
            if t in inside:
                stretch = first + slope * (t - begin)
                rows.append((t, stretch, p.lateral, p.shear, p.stress, p.energy, max(p.energy, largest)))
        memory, largest = memories[-1], float(peak[-1])
    table = np.array(rows).T
    time, stretch, lateral, shear, stress, energy, peaks = table
    return Response(
        time=time,
        stretch=stretch,
        lateral=lateral,
        shear=shear,
        stress=stress,
        energy=energy,
        largest=peaks,
    )


def _integrate(
    test: _Test, memory: Array, largest: float, at: Array, first: float, slope: float, tolerance: float
) -> Array:
    """Memory variables (t, n, 4) at times after the piece's start; `largest`: maximum of W before it."""
    tau = test.solid.prony.tau
    if not len(tau):
        return np.zeros((len(at), 0, 4))

    def rate(t: float, flat: Array) -> Array:
        m = flat.reshape(-1, 4)
        softened = test.at(first + slope * t, m, largest).softened
        return np.asarray(((softened - m) / tau[:, None]).ravel())

    found = solve_ivp(
        rate,
        (0.0, float(at[-1])),
        memory.ravel(),
        method="Radau",
        t_eval=at,
        rtol=tolerance,
        atol=tolerance * test.solid.shear_modulus,
    )
    if not found.success:
        raise RuntimeError(f"coupon: {found.message}")
    return np.asarray(found.y.T.reshape(len(at), -1, 4))


@dataclass(frozen=True, eq=False)
class _Point:
    lateral: float
    shear: float
    stress: float
    energy: float
    softened: Array


class _Test:
    """One mode of a solid: stresses at a stretch, memory variables and largest energy.

    Stresses have the components 11, 22, 33, 12; F = [[stretch, shear, 0], [0, lateral, 0], [0, 0, third]].
    """

    def __init__(self, solid: Solid, mode: str) -> None:
        self.solid, self.mode = solid, mode
        f = solid.fibres
        self.shears = mode == "uniaxial" and f is not None and abs(np.sin(2.0 * f.angle)) > 1e-12
        self._free = 0 if mode != "uniaxial" or f is None else 1 + self.shears
        # initial guess of lateral times sqrt(stretch), and of shear
        self._guess, self._inverse = np.array([1.0, 0.0])[: self._free], np.zeros((0, 0))

    def at(self, stretch: float, memory: Array, largest: float) -> _Point:
        lateral, shear = self._sides(stretch, memory, largest)
        softened, total, energy = self._stresses(stretch, lateral, shear, memory, largest)
        return _Point(lateral, shear, stretch * float(total[0]), energy, softened)

    def _stresses(
        self, stretch: float, lateral: float, shear: float, memory: Array, largest: float
    ) -> tuple[Array, Array, float]:
        """Softened S_iso, total S with the pressure that frees axis 3, and W."""
        solid, prony = self.solid, self.solid.prony
        if self.shears:
            plane = np.array([[stretch**2, stretch * shear], [stretch * shear, shear**2 + lateral**2]])
            energy, softened = solid.sheared(plane)
            inverse = np.linalg.inv(plane)
            volume = np.array([inverse[0, 0], inverse[1, 1], (stretch * lateral) ** 2, inverse[0, 1]])
        else:
            stretches = np.array([stretch, lateral, 1.0 / (stretch * lateral)])
            energy = float(solid.energy(stretches))
            softened = np.append(solid.deviator(stretches), 0.0)
            volume = np.append(stretches**-2, 0.0)
        if solid.softening is not None:
            softened = softened * solid.softening.eta(np.array(energy), np.array(max(energy, largest)))
        extra = prony.instantaneous * softened - prony.g @ memory
        return softened, extra - extra[2] / volume[2] * volume, energy

    def _sides(self, stretch: float, memory: Array, largest: float) -> tuple[float, float]:
        """Lateral stretch and shear without stress on free sides, by Newton's method with a kept Jacobian.

        RuntimeError if it does not converge.
        """
        if self.mode != "uniaxial":
            return (stretch if self.mode == "equibiaxial" else 1.0), 0.0
        thin = float(stretch**-0.5)
        if not self._free:
            return thin, 0.0

        def unbalanced(x: Array) -> Array:
            shear = float(x[1]) if self.shears else 0.0
            _, total, _ = self._stresses(stretch, thin * float(x[0]), shear, memory, largest)
            return np.asarray(total[[1, 3]][: self._free] / self.solid.shear_modulus)

        x = self._guess.copy()
        for k in range(80):
            if k % 8 == 7 or not len(self._inverse):
                h = 1e-6 * np.eye(self._free)
                slope = [(unbalanced(x + d) - unbalanced(x - d)) / 2e-6 for d in h]
                self._inverse = np.linalg.inv(np.column_stack(slope))
            move = -self._inverse @ unbalanced(x)
            x = x + np.clip(move, -0.1, 0.1)
            if np.abs(move).max() < 1e-11:
                self._guess = x
                return thin * float(x[0]), float(x[1]) if self.shears else 0.0
        self._inverse = np.zeros((0, 0))
        raise RuntimeError(f"coupon: no lateral stretch at stretch {stretch:.4g}")
