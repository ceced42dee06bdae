"""GMRES in double precision, preconditioned by a single-precision factor of an older matrix.

A factorisation costs about as much as forty solves, and a poke's matrix changes slowly: one factor serves
several Newton iterations and load steps. GMRES is needed since friction makes the matrix unsymmetric. Deep
under a rod, where the surface snaps from one fold to another, the matrix becomes indefinite, as the inertia
of the factor shows. It is then shifted until it is positive definite, so that the step is a descent direction
towards a stable equilibrium. The shift decreases near equilibrium, and the residual does not include it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tisim.linear.blocks import Pattern
from tisim.linear.direct import DirectSolver

Array = NDArray[np.float64]
SMALLEST_SHIFT, LARGEST_SHIFT = 1e-3, 0.5


class FactorGMRES:
    """Solver for blocks of one pattern; the factor is renewed after a solve of over `patience` iterations.

    Parameters
    ----------
    pattern : Pattern
    joined : callable (blocks) -> blocks, optional
        Applied to the blocks before they are factorised.
    patience : int
        Number of iterations above which the next solve renews the factor.
    limit : int
        Largest number of iterations.

    Attributes
    ----------
    shift : float
        Multiple of the identity in the factor, in units of the mean diagonal: 0 while the matrix is positive
        definite and no shift was requested (`stiffen`, `relax`, `reset`). While the requested shift
        decreases, the matrix has a smaller shift than the factor, which is kept as long as it serves.
    factorisations, iterations : int
        Numbers of factorisations and of GMRES iterations.
    """

    def __init__(
        self,
        pattern: Pattern,
        *,
        joined: Callable[[Array], Array] | None = None,
        patience: int = 14,
        limit: int = 20,
    ) -> None:
        self._pattern, self._joined = pattern, joined
        self._factor = DirectSolver(pattern.indptr, pattern.indices, single=True)
        self._patience, self._limit = patience, limit
        self._stale = True
        self._added = self._scale = 0.0
        self._wanted = 0.0
        self.shift = 0.0
        self.factorisations = 0
        self.iterations = 0

    @property
    def can_stiffen(self) -> bool:
        return self._wanted < LARGEST_SHIFT

    def stiffen(self) -> None:
        """Request a larger shift from the next solve on."""
        self._wanted = max(8.0 * self._wanted, SMALLEST_SHIFT)
        self._stale = True

    def relax(self) -> None:
        """Request a smaller shift from the next solve on."""
        self._wanted = self._wanted / 4.0 if self._wanted > SMALLEST_SHIFT else 0.0

    def reset(self) -> None:
        """Request no shift."""
        self._wanted = 0.0

    def solve(
        self,
        blocks: Array,
        rhs: Array,
        *,
        tolerance: float,
        multiply: Callable[[Array], Array],
    ) -> Array:
        """A^-1 rhs to a relative residual, or to the result of `limit` iterations with a new factor.

        Parameters
        ----------
        blocks : ndarray of float, shape (nb, 3, 3)
            Approximation of A's symmetric part, to be factorised.
        rhs : ndarray of float, shape (n, 3)
        tolerance : float
            Residual relative to rhs.
        multiply : callable (v) -> A v
            Product with vectors of shape (3 n,).

        Raises
        ------
        LinearSolveError
            If the factorisation fails.
        """
        fresh = self._stale
        if fresh:
            self._refresh(blocks)
        self._added = self._wanted * self._scale
        x, used, good = self._gmres(rhs, tolerance, multiply)
        if not good and not fresh:
            self._refresh(blocks)
            self._added = self._wanted * self._scale
            x, used, good = self._gmres(rhs, tolerance, multiply)
        self._stale = used > self._patience
        return x

    def _refresh(self, blocks: Array) -> None:
        if self._joined is not None:
            blocks = self._joined(blocks)
        diagonal = self._pattern.indptr[:-1]
        scale = float(np.abs(self._pattern.diagonal(blocks)).mean())
        self.shift = self._wanted
        for _ in range(8):
            matrix = blocks
            if self.shift:
                matrix = blocks.copy()
                matrix[diagonal] += self.shift * scale * np.eye(3)
            self._factor.factorise(matrix)
            self.factorisations += 1
            if self._factor.negative == 0:
                break
            self.shift = max(8.0 * self.shift, SMALLEST_SHIFT)
        self._wanted, self._scale = self.shift, scale

    def _gmres(
        self, rhs: Array, tolerance: float, multiply: Callable[[Array], Array]
    ) -> tuple[Array, int, bool]:
        """One cycle, right-preconditioned, so that it minimises the true residual."""
        beta = float(np.linalg.norm(rhs))
        basis = np.empty((self._limit + 1, rhs.size))
        images = np.empty((self._limit, rhs.size))
        basis[0] = rhs.ravel() / beta
        triangle = np.zeros((self._limit, self._limit))
        left = [beta]  # projected right-hand side
        turns: list[tuple[float, float]] = []  # Givens rotations that make the projected matrix triangular
        for k in range(self._limit):
            images[k] = self._factor.solve(basis[k].reshape(rhs.shape)).ravel()
            v = multiply(images[k])
            if self._added:
                v += self._added * images[k]
            column = basis[: k + 1] @ v
            v = v - column @ basis[: k + 1]
            below = float(np.linalg.norm(v))
            h = column.tolist()
            for j, (c, s) in enumerate(turns):
                h[j], h[j + 1] = c * h[j] + s * h[j + 1], c * h[j + 1] - s * h[j]
            size = math.hypot(h[k], below)
            c, s = (h[k] / size, below / size) if size > 0.0 else (1.0, 0.0)
            turns.append((c, s))
            h[k] = size
            triangle[: k + 1, k] = h
            left[k:] = [c * left[k], -s * left[k]]
            if abs(left[-1]) <= tolerance * beta or below <= 1e-14 * beta:
                break
            basis[k + 1] = v / below
        used = len(turns)
        self.iterations += used
        y, *_ = np.linalg.lstsq(triangle[:used, :used], np.array(left[:used]))
        x: Array = (y @ images[:used]).reshape(rhs.shape)
        return x, used, abs(left[-1]) <= tolerance * beta
