"""The deformation of homogeneous tests of which not all is driven, at all times of a course at once.

    strip with fibres     sides carry no stress: the lateral stretch, and the shear where fibres are oblique
    cylinder              platens push and do not pull: it recovers freely where they have left it

At J = 1, F = [[s e^a, g, 0], [0, e^y / r, 0], [0, 0, e^-y / r]] with r = sqrt(s e^a); lines along the pull
stay along it, so that grips which let a long strip shear carry no force across it. What must vanish is linear
in the second Piola-Kirchhoff stress, and that in its own past: later stresses depend on earlier deformations
alone, and Newton's linear system for all times is triangular.
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
ENOUGH = 1e-7  # stress that should vanish, over the shear modulus
LONGEST = 0.2  # step of an unknown
_DIFFERENCE = 1e-6
_AXIS, _OTHER = np.array([0, 1, 2, 0]), np.array([0, 1, 2, 1])  # of the stresses 11, 22, 33, 12


@dataclass(frozen=True, eq=False, kw_only=True)
class Memory:
    """How a stress remembers: total_n = equilibrium S_n + sum Q_n, Q_n = decay_n Q_(n-1) + gain_n (S_n -
    S_(n-1)), each test from rest.

    Attributes
    ----------
    equilibrium : float
    decays, gains : array, shape (n, terms)
        Decays are 0 where a test begins.
    begins : array
        First time of each test, by index.
    """

    equilibrium: float
    decays: Array
    gains: Array
    begins: NDArray[np.intp]

    @property
    def at_once(self) -> Array:
        """Slope of a total stress by its own instantaneous one, shape (n,)."""
        return np.asarray(self.equilibrium + self.gains.sum(axis=1))


def deformed(F: Array, x: Array) -> Array:
    """Driven gradients F (n, 3, 3) with unknowns x (n, 3) other than 0."""
    found, half = F.copy(), np.exp(-0.5 * x[:, AXIAL])
    found[:, 0, 0] *= np.exp(x[:, AXIAL])
    found[:, 1, 1] *= half * np.exp(x[:, LATERAL])
    found[:, 2, 2] *= half * np.exp(-x[:, LATERAL])
    found[:, 0, 1] += x[:, SHEAR]
    return found


def along(F: Array, S: Array) -> Array:
    """Nominal stress (n,) along the first axis, the third side free; S : second Piola-Kirchhoff without its
    pressure, (n, 3, 3)."""
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
    """Gradients (n, 3, 3) with the unknowns found, and times at which none were.

    Parameters
    ----------
    F : as driven, shape (n, 3, 3).
    free : which unknowns there are, shape (n, 3).
    pushed : times of platens that push and do not pull: the axial unknown is theirs where they have left.
    isochoric : gradients -> instantaneous stress without its pressure, (n, 3, 3).
    totals : that stress -> the one with its memory.
    modulus : shear modulus of the stress that counts as none [Pa].
    """
    x = np.zeros((len(F), 3))
    at, lost = F, np.zeros(len(F), dtype=bool)
    for _ in range(PASSES):
        at = deformed(F, x)
        S = isochoric(at)
        total = totals(S)[:, _AXIS, _OTHER]
        weights = _weights(at)
        left = np.einsum("nkc,nc->nk", weights, total)
        open_ = free.copy()
        open_[:, AXIAL] |= pushed & (left[:, AXIAL] - modulus * x[:, AXIAL] > 0.0)
        left = np.where(open_, left, modulus * x)
        lost = np.any(~(np.abs(left) <= ENOUGH * modulus), axis=1)
        if not lost.any() or not np.isfinite(left).all():
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
    return at, lost


def _weights(F: Array) -> Array:
    """Of the stresses 11, 22, 33, 12 in what must vanish: Kirchhoff stress along the axis, that of the second
    less the third side, shear stress; shape (n, 3, 4). The pressure frees the third side."""
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
    """Newton's step (n, 3).

    Parameters
    ----------
    left : what should vanish, shape (n, 3).
    weights : of the four total stresses in it, shape (n, 3, 4).
    slopes : of the instantaneous stresses by the unknowns, shape (n, 4, 3).
    own : slope of `left` by the unknowns where stresses stay, shape (n, 3, 3).

    Raises
    ------
    numpy.linalg.LinAlgError
        At some time what is left does not depend on the unknowns.
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
