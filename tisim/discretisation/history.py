"""Internal variables at material points: viscous stresses, largest energy so far, energy dissipated.

Over a step of length dt, in which the isochoric stress S is assumed to change at a constant rate, each
viscous term is integrated exactly (Taylor, Pister and Goudreau, Int. J. Numer. Methods Eng. 2, 1970):

    Q_i(n+1) = exp(-h) Q_i(n) + g_i c(h) [S(n+1) - S(n)],    h = dt/tau_i,    c(h) = (1 - exp(-h))/h

(The midpoint rule of Simo and of Holzapfel has exp(-h/2) in place of c(h); the two agree to second order, and
c(h) is accurate for dt above tau_i as well.) A step therefore has the potential s W_iso(C) + 1/2 H : C with

    s = g_inf + sum g_i c(h_i),    H = sum [exp(-h_i) Q_i(n) - g_i c(h_i) S(n)]

A step is defined by s and H alone, which `begin` computes from the last accepted state: a refused step has no
effect on the history.

Energy: a part of the work w_i of a term's stress is stored. In linear viscoelasticity the stored part
Y_i = Q_i : Q_i / (4 g_i G) relaxes twice as fast as the stress,

    dY_i/dt = Q_i : dC/dt / 2 - 2 Y_i / tau_i

This equation is integrated here at finite strain as well (where the stored energy of Simo's model has no
closed form), with a dissipation 2 Y_i / tau_i that is bounded below by 0. The balance
(work = stored + dissipated) is therefore exact at any strain, and the dissipated energy never decreases.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.parts import Softening, Spectrum, ramp_weight

Array = NDArray[np.float64]

Isochoric = tuple[Array, Array, Array]
"""C (m, q, 6), S (m, q, 6) [Pa] and the isochoric energy before softening (m, q) [J/m3]."""

_TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # weight of each component in a double contraction


class History:
    """History of the points (m, q), initially at rest.

    Attributes
    ----------
    state : ndarray of float, shape (m, q, k)
        State of the present step that the kernels read: H, then the largest energy so far.
    scale : float
        s of the present step.
    dissipated : ndarray of float, shape (m, q)
        Energy dissipated so far [J/m3].
    """

    def __init__(
        self, points: tuple[int, int], spectrum: Spectrum | None, softening: Softening | None
    ) -> None:
        self._spectrum, self._softening = spectrum, softening
        self.state = np.zeros((*points, 6 * (spectrum is not None) + (softening is not None)))
        self.dissipated = np.zeros(points)
        self.scale = 1.0
        if spectrum is not None:
            self._C = np.zeros((*points, 6))
            self._C[..., :3] = 1.0
            self._S = np.zeros((*points, 6))
            self._Q = np.zeros((len(spectrum.times), *points, 6))
            self._stored = np.zeros((len(spectrum.times), *points))
            self._lost = np.zeros(points)
            self.begin(0.0)

    def begin(self, dt: float) -> None:
        """Begin a step of length dt [s] from the last accepted state; 0 for an instantaneous step."""
        self._dt = dt
        if self._spectrum is None:
            return
        h = dt / self._spectrum.times
        c = self._spectrum.strengths * ramp_weight(h)
        H = np.tensordot(np.exp(-h), self._Q, axes=1)
        H -= float(c.sum()) * self._S
        self.state[..., :6] = H
        self.scale = self._spectrum.equilibrium + float(c.sum())

    def accept(self, found: Isochoric) -> None:
        """Accept the step that ends at the values `found`, and begin a step of length 0."""
        C, S, energy = found
        lost = np.zeros_like(energy)
        if self._spectrum is not None:
            h = self._dt / self._spectrum.times
            c, decay = self._spectrum.strengths * ramp_weight(h), np.exp(-h)
            moved = 0.25 * (C - self._C) * _TWICE  # the work of the mean stress is (Q + Q')/2 : dC/2
            for i in range(len(h)):
                Q = decay[i] * self._Q[i] + c[i] * (S - self._S)
                work = np.einsum("mqk,mqk->mq", self._Q[i] + Q, moved)
                stored = decay[i] ** 2 * self._stored[i] + ramp_weight(2.0 * h[i : i + 1])[0] * work
                gone = np.maximum(self._stored[i] + work - stored, 0.0)
                self._stored[i] += work - gone
                self._lost += gone
                self._Q[i] = Q
            # copied, since the arrays belong to the caller
            self._C, self._S = C.copy(), S.copy()
            lost += self._lost
        if self._softening is not None:
            largest = self.state[..., -1]
            np.maximum(largest, energy, out=largest)
            lost += self.equilibrium * self._softening.dissipated(largest)
        self.dissipated = lost
        self.begin(0.0)

    @property
    def equilibrium(self) -> float:
        """g_inf, the fraction of the dissipation of softening that counts; 1 without viscosity."""
        return 1.0 if self._spectrum is None else self._spectrum.equilibrium

    def viscous(self) -> Array:
        """Viscous stresses by term [Pa], shape (n, m, q, 6)."""
        return self._Q.copy() if self._spectrum is not None else np.zeros((0, *self.dissipated.shape, 6))

    def stored(self) -> Array:
        """Energy stored in the viscous terms [J/m3], shape (m, q)."""
        return self._stored.sum(axis=0) if self._spectrum is not None else np.zeros(self.dissipated.shape)
