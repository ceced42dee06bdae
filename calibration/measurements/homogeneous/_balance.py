"""Free deformations in homogeneous tests by Newton's method, for all times of a course at once.

    strip with fibres     traction-free sides: lateral stretch y, and shear g if the fibres are oblique
    cylinder              platens that push but do not pull: axial stretch a after they lose contact

At J = 1, F = [[s e^a, g, 0], [0, e^y / r, 0], [0, 0, e^-y / r]] with r = sqrt(s e^a). Lines along the pull
keep their direction, so that grips which let a long strip shear carry no transverse force. The residuals are
linear in the second Piola-Kirchhoff stress, and this is linear in its history: stresses depend on earlier
deformations only, and the linear system of Newton's method for all times is lower triangular.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

# unknowns, by column
AXIAL, LATERAL, SHEAR = range(3)
PASSES = 40
ENOUGH = 1e-7  # tolerance of the residual stress, over the shear modulus
LONGEST = 0.2  # largest step of an unknown
_DIFFERENCE = 1e-6
_AXIS, _OTHER = np.array([0, 1, 2, 0]), np.array([0, 1, 2, 1])  # indices of the stresses 11, 22, 33, 12


@dataclass(frozen=True, eq=False, kw_only=True)
class Memory:
    """Coefficients of the viscoelastic recursion; each test starts from rest.

        total_n = equilibrium S_n + sum Q_n,    Q_n = decay_n Q_(n-1) + gain_n (S_n - S_(n-1))

    Attributes
    ----------
    equilibrium : float
        Long-time fraction of the stress.
    decays, gains : array, shape (n, terms)
        Decays are 0 at the first time of a test.
    begins : array
        Index of the first time of each test.
    """

    equilibrium: float
    decays: Array
    gains: Array
    begins: NDArray[np.intp]

    @property
    def at_once(self) -> Array:
        """Derivative of the total stress by the instantaneous stress at the same time, shape (n,)."""
        return np.asarray(self.equilibrium + self.gains.sum(axis=1))


def deformed(F: Array, x: Array) -> Array:
    """Deformation gradients (n, 3, 3) from the driven gradients F and the unknowns x (n, 3)."""
    found, half = F.copy(), np.exp(-0.5 * x[:, AXIAL])
    found[:, 0, 0] *= np.exp(x[:, AXIAL])
    found[:, 1, 1] *= half * np.exp(x[:, LATERAL])
    found[:, 2, 2] *= half * np.exp(-x[:, LATERAL])
    found[:, 0, 1] += x[:, SHEAR]
    return found


def along(F: Array, S: Array) -> Array:
    """Nominal stress (n,) along the first axis with a traction-free third side.

    S : second Piola-Kirchhoff stress without the pressure term, shape (n, 3, 3).
    """
    return np.asarray(np.einsum("nc,nc->n", _weights(F)[:, AXIAL], S[:, _AXIS, _OTHER]) / F[:, 0, 0])


def balanced(
    F: Array,
    free: Rows,
    pushed: Rows,
    *,
    isochoric: Callable[[Array], Array],
    totals: Callable[[Array], Array],
    memory: Memory,
    modulus: float,
) -> tuple[Array, Rows]:
    """Solve for the unknowns; return the gradients (n, 3, 3), and True for times without convergence (n,).

    Parameters
    ----------
    F : driven deformation gradients, shape (n, 3, 3).
    free : mask of the unknowns, shape (n, 3).
    pushed : times with platens that push but do not pull, shape (n,); the axial stretch is unknown there
        after loss of contact.
    isochoric : function from gradients to the instantaneous second Piola-Kirchhoff stress without the
        pressure term, shape (n, 3, 3).
    totals : function from that stress to the stress with its history.
    memory : coefficients of the recursion.
    modulus : shear modulus, the scale of the tolerance [Pa].
    """
    x = np.zeros((len(F), 3))
    at, lost = F, np.zeros(len(F), dtype=bool)
    test = np.searchsorted(memory.begins, np.arange(len(F)), side="right")
    broken = np.zeros(len(F), dtype=bool)  # times of tests without finite stresses: the others go on
    for _ in range(PASSES):
        at = deformed(F, x)
        S = isochoric(at)
        sound = np.asarray(np.isfinite(S).all(axis=(1, 2)))
        S = np.where(sound[:, None, None], S, 0.0)  # totals mix all times
        total = totals(S)[:, _AXIS, _OTHER]
        weights = _weights(at)
        left = np.einsum("nkc,nc->nk", weights, total)
        open_ = free.copy()
        open_[:, AXIAL] |= pushed & (left[:, AXIAL] - modulus * x[:, AXIAL] > 0.0)
        left = np.where(open_, left, modulus * x)
        unsound = ~(sound & np.isfinite(left).all(axis=1))
        if unsound.any():
            broken |= np.isin(test, test[unsound])
            if broken.all():
                break
            F, x = np.where(broken[:, None, None], np.eye(3), F), np.where(broken[:, None], 0.0, x)
            continue
        lost = np.any(~(np.abs(left) <= ENOUGH * modulus), axis=1)
        if not lost.any():
            break
        slopes, own = np.zeros((len(F), 4, 3)), np.zeros((len(F), 3, 3))
        for k in np.flatnonzero((free | (pushed[:, None] & (np.arange(3) == AXIAL))).any(axis=0)):
            beside = x.copy()
            beside[:, k] += _DIFFERENCE
            moved = deformed(F, beside)
            slopes[:, :, k] = ((isochoric(moved) - S) / _DIFFERENCE)[:, _AXIS, _OTHER]
            own[:, :, k] = np.einsum("njc,nc->nj", (_weights(moved) - weights) / _DIFFERENCE, total)
        weights = np.where(open_[:, :, None], weights, 0.0)
        own = np.where(open_[:, :, None], own, modulus * np.eye(3))
        slopes = np.where((free | pushed[:, None])[:, None, :], slopes, 0.0)
        try:
            move = _triangular(left, weights, slopes, own, memory)
        except np.linalg.LinAlgError:
            break
        x = x + np.clip(move, -LONGEST, LONGEST)
    return at, lost | broken


def _weights(F: Array) -> Array:
    """Weights of the stresses 11, 22, 33, 12 in the residuals, shape (n, 3, 4).

    The residuals are Kirchhoff stresses: axial minus third side, second minus third side, and shear. The
    pressure makes the third side traction-free.
    """
    a, b, c, g = F[:, 0, 0], F[:, 1, 1], F[:, 2, 2], F[:, 0, 1]
    found = np.zeros((len(F), 3, 4))
    found[:, AXIAL, 0] = a**2
    found[:, AXIAL, 2] = -(c**2)
    found[:, AXIAL, 3] = a * g
    found[:, LATERAL, 1] = b**2
    found[:, LATERAL, 2] = -(c**2)
    found[:, SHEAR, 1] = b * g
    found[:, SHEAR, 3] = a * b
    return found


def _triangular(left: Array, weights: Array, slopes: Array, own: Array, memory: Memory) -> Array:
    """Newton step (n, 3) by forward substitution in time.

    Parameters
    ----------
    left : residuals, shape (n, 3).
    weights : weights of the four total stresses in the residuals, shape (n, 3, 4).
    slopes : derivatives of the instantaneous stresses by the unknowns, shape (n, 4, 3).
    own : derivatives of the residuals by the unknowns at constant stresses, shape (n, 3, 3).
    memory : coefficients of the recursion.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the system of some time is singular.
    """
    inverse = np.linalg.inv(memory.at_once[:, None, None] * (weights @ slopes) + own)
    moves = np.empty_like(left)
    if not memory.gains.shape[1]:
        return np.asarray(-np.einsum("nij,nj->ni", inverse, left))
    first = set(memory.begins.tolist())
    gains, decays = memory.gains[:, :, None], memory.decays[:, :, None]
    Q, before = np.zeros((memory.gains.shape[1], 4)), np.zeros(4)
    for n in range(len(left)):
        if n in first:
            Q, before = np.zeros_like(Q), np.zeros(4)
        Q = decays[n] * Q - gains[n] * before
        moves[n] = move = -inverse[n] @ (left[n] + weights[n] @ Q.sum(axis=0))
        before = slopes[n] @ move
        Q = Q + gains[n] * before
    return moves
