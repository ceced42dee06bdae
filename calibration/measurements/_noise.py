"""The noise of measurements: the data's covariance, and nuisances that many rows share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


@dataclass(frozen=True, eq=False, kw_only=True)
class Noise:
    """Residuals r = e + columns b, with e ~ N(0, C) and nuisances b ~ N(0, 1).

    Attributes
    ----------
    sd : standard deviation of each row by itself [SI], shape (rows,); inf where nothing was measured.
    covariance : C, shape (rows, rows), where rows are correlated; None for diag(sd**2).
    columns : one standard deviation of each nuisance [SI], shape (rows, k).
    names : of the nuisances, where they have names.
    kept : rows that are compared, shape (rows,).
    symmetric : whiten by (1 + A A^T)^(-1/2) with A = columns / sd, which costs rows times k^2, in place of
        the triangular factor of the covariance, which costs rows^3: for long records with few nuisances.
    """

    sd: Array
    columns: Array
    kept: Rows
    covariance: Array | None = None
    names: tuple[str, ...] = ()
    symmetric: bool = False

    @classmethod
    def independent(cls, sd: Array, *, symmetric: bool = False) -> Noise:
        """Rows that are independent, without nuisances; all are kept."""
        rows = len(sd)
        return cls(sd=sd, columns=np.zeros((rows, 0)), kept=np.ones(rows, dtype=bool), symmetric=symmetric)

    @classmethod
    def correlated(cls, covariance: Array) -> Noise:
        """Correlated rows, without nuisances; all are kept."""
        rows = len(covariance)
        return cls(
            sd=np.sqrt(np.diag(covariance)),
            columns=np.zeros((rows, 0)),
            kept=np.ones(rows, dtype=bool),
            covariance=covariance,
        )

    def with_nuisances(self, columns: Array | Sequence[Array], names: Sequence[str] = ()) -> Noise:
        """The same with other nuisances: columns (rows, k), or k of shape (rows,)."""
        whole = columns if isinstance(columns, np.ndarray) else np.column_stack([*columns])
        return replace(self, columns=whole, names=tuple(names))

    def subset(self, some: Rows) -> Noise:
        """Of the rows that are kept, some, shape (rows,)."""
        return replace(self, kept=self.kept & some)

    @cached_property
    def used(self) -> Rows:
        """Rows that are kept and were measured, shape (rows,); m of them."""
        return self.kept & np.isfinite(self.sd)

    @property
    def points(self) -> int:
        """m, the number of rows that are used."""
        return int(np.count_nonzero(self.used))

    def whiten(self, residuals: Array) -> Array:
        """Residuals (rows,) or (rows, k) -> those used, uncorrelated and of unit variance, (m,) or (m, k).

        What is not finite counts as zero: a difference without an answer explains nothing.
        """
        x = residuals[self.used]
        x = np.where(np.isfinite(x), x, 0.0)
        if self._plain:
            sd = self.sd[self.used]
            return np.asarray(x / (sd if x.ndim == 1 else sd[:, None]))
        if self.symmetric:
            sd = self.sd[self.used]
            v, less = self._symmetric
            x = x / (sd if x.ndim == 1 else sd[:, None])
            inside = v.T @ x
            return np.asarray(x - v @ (less * inside if x.ndim == 1 else less[:, None] * inside))
        return np.asarray(solve_triangular(self._root, x, lower=True, check_finite=False))

    def estimate(self, residuals: Array) -> Array:
        """Most likely nuisances b (k,) of residuals (rows,)."""
        return np.asarray(self._estimator @ residuals[self.used])

    def remove(self, residuals: Array) -> Array:
        """Residuals (rows,) without the most likely nuisances."""
        if not self.columns.shape[1]:
            return residuals
        return np.asarray(residuals - self.columns @ self.estimate(residuals))

    def removed_variance(self) -> float:
        """Expected squared sum of what `remove` leaves of the noise alone, over the rows that are used."""
        if self._plain:
            return float(np.sum(self.sd[self.used] ** 2))
        known = self.columns[self.used]
        whole = self.data_covariance() + known @ known.T
        taken = np.eye(len(whole)) - known @ self._estimator
        return float(np.einsum("ij,jk,ik->", taken, whole, taken))

    def data_covariance(self) -> Array:
        """C of the rows that are used, shape (m, m)."""
        if self.covariance is None:
            return np.diag(self.sd[self.used] ** 2)
        return self.covariance[np.ix_(self.used, self.used)]

    @property
    def _plain(self) -> bool:
        return self.covariance is None and not self.columns.shape[1]

    @cached_property
    def _root(self) -> Array:
        known = self.columns[self.used]
        return np.asarray(cholesky(self.data_covariance() + known @ known.T, lower=True))

    @cached_property
    def _symmetric(self) -> tuple[Array, Array]:
        scaled = self.columns[self.used] / self.sd[self.used][:, None]
        v, s, _ = np.linalg.svd(scaled, full_matrices=False)
        return v, 1.0 - 1.0 / np.sqrt(1.0 + s**2)

    @cached_property
    def _estimator(self) -> Array:
        """(k, m): (A^T C^-1 A + 1)^-1 A^T C^-1."""
        known = self.columns[self.used]
        if self.covariance is None:
            inside: Array = np.asarray(known / self.sd[self.used][:, None] ** 2)
        else:
            inside = np.asarray(np.linalg.solve(self.data_covariance(), known), dtype=np.float64)
        return np.asarray(np.linalg.solve(known.T @ inside + np.eye(known.shape[1]), inside.T))
