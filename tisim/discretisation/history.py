"""Internal variables at material points: viscous stresses, the largest energy so far, energy dissipated.

Over a step of length dt, in which the isochoric stress S is taken to change at a constant rate, each viscous
term is integrated exactly (Taylor, Pister and Goudreau, Int. J. Numer. Methods Eng. 2, 1970):

    Q_i(n+1) = exp(-h) Q_i(n) + g_i c(h) [S(n+1) - S(n)],    h = dt/tau_i,    c(h) = (1 - exp(-h))/h

(Simo's and Holzapfel's midpoint rule has exp(-h/2) for c(h); the two agree to second order, and c(h) is
right for dt above tau_i as well.) So a step has the potential s W_iso(C) + 1/2 H : C with

    s = g_inf + sum g_i c(h_i),    H = sum [exp(-h_i) Q_i(n) - g_i c(h_i) S(n)]

and all that belongs to a step is s and H, made anew by `begin` from the last accepted state: a step that is
refused leaves nothing behind.

Energy: of the work that a term's stress does, w_i, a part is stored. In linear viscoelasticity the stored
part Y_i = Q_i : Q_i / (4 g_i G) relaxes twice as fast as the stress,

    dY_i/dt = Q_i : dC/dt / 2 - 2 Y_i / tau_i

and this is what is integrated here, at finite strain too (where a stored energy of Simo's model has no closed
form), with a dissipation 2 Y_i / tau_i that is not allowed below 0. The balance (work = stored + dissipated)
therefore closes whatever the strain, and what is dissipated never falls.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.parts import Softening, Spectrum

Array = NDArray[np.float64]

Isochoric = tuple[Array, Array, Array]
"""C (m, q, 6), S (m, q, 6) [Pa] and the isochoric energy before softening (m, q) [J/m3] at some positions."""

_TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # of each component in a double contraction


def weight(h: Array) -> Array:
    """c(h) = (1 - exp(-h))/h, 1 at h = 0."""
    safe = np.where(h > 0.0, h, 1.0)
    return np.where(h > 0.0, -np.expm1(-safe) / safe, 1.0)


class History:
    """History of points (m, q), at rest to begin with.

    Attributes
    ----------
    state : ndarray of float, shape (m, q, k)
        What the kernels read, of the present step.
    scale : float
        s of the present step.
    dissipated : ndarray of float, shape (m, q)
        Energy lost so far [J/m3].
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
        """A step of length dt [s] from the last accepted state; 0: at once."""
        self._dt = dt
        if self._spectrum is None:
            return
        h = dt / self._spectrum.times
        c = self._spectrum.strengths * weight(h)
        H = np.tensordot(np.exp(-h), self._Q, axes=1)
        H -= float(c.sum()) * self._S
        self.state[..., :6] = H
        self.scale = self._spectrum.equilibrium + float(c.sum())

    def accept(self, found: Isochoric) -> None:
        """Take the step; found: at the positions it ends at. The present step is then one of no length."""
        C, S, energy = found
        lost = np.zeros_like(energy)
        if self._spectrum is not None:
            h = self._dt / self._spectrum.times
            c, decay = self._spectrum.strengths * weight(h), np.exp(-h)
            moved = 0.25 * (C - self._C) * _TWICE  # half of the mean stress' work: (Q + Q')/2 : dC/2
            for i in range(len(h)):
                Q = decay[i] * self._Q[i] + c[i] * (S - self._S)
                work = np.einsum("mqk,mqk->mq", self._Q[i] + Q, moved)
                stored = decay[i] ** 2 * self._stored[i] + weight(2.0 * h[i : i + 1])[0] * work
                gone = np.maximum(self._stored[i] + work - stored, 0.0)
                self._stored[i] += work - gone
                self._lost += gone
                self._Q[i] = Q
            # replaced, not written to: the caller's arrays are its own
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
        """Part of the softened energy that is there in the long run; viscous terms count their own work."""
        return 1.0 if self._spectrum is None else self._spectrum.equilibrium

    def viscous(self) -> Array:
        """Viscous stresses by term, (n, m, q, 6) [Pa]."""
        return self._Q.copy() if self._spectrum is not None else np.zeros((0, *self.dissipated.shape, 6))

    def stored(self) -> Array:
        """Energy that the viscous terms hold, (m, q) [J/m3]."""
        return self._stored.sum(axis=0) if self._spectrum is not None else np.zeros(self.dissipated.shape)
