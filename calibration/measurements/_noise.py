"""Noise model of measurements: covariance of the data, and nuisances that rows share."""

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
    sd : standard deviation of each row without nuisances [SI], shape (rows,); inf where nothing was measured.
    covariance : C, shape (rows, rows), if rows are correlated; None for diag(sd**2).
    columns : effect of one standard deviation of each nuisance [SI], shape (rows, k).
    names : names of the nuisances, () if they have none; unnamed ones are "".
    kept : mask of the rows that are compared, shape (rows,).
    symmetric : whiten by (1 + A A^T)^(-1/2) with A = columns / sd, at a cost of O(rows k^2), in place of the
        Cholesky factor of the covariance, O(rows^3): for long records with few nuisances. C is then diagonal.
    """

    sd: Array
    columns: Array
    kept: Rows
    covariance: Array | None = None
    names: tuple[str, ...] = ()
    symmetric: bool = False

    @classmethod
    def independent(cls, sd: Array, *, symmetric: bool = False) -> Noise:
        """Noise of independent rows without nuisances; all rows are kept."""
        rows = len(sd)
        return cls(sd=sd, columns=np.zeros((rows, 0)), kept=np.ones(rows, dtype=bool), symmetric=symmetric)

    @classmethod
    def correlated(cls, covariance: Array) -> Noise:
        """Noise of correlated rows without nuisances; all rows are kept."""
        rows = len(covariance)
        return cls(
            sd=np.sqrt(np.diag(covariance)),
            columns=np.zeros((rows, 0)),
            kept=np.ones(rows, dtype=bool),
            covariance=covariance,
        )

    def with_nuisances(self, columns: Array | Sequence[Array], names: Sequence[str] = ()) -> Noise:
        """Copy with other nuisances: columns of shape (rows, k), or k columns of shape (rows,)."""
        whole = columns if isinstance(columns, np.ndarray) else np.column_stack([*columns])
        return replace(self, columns=whole, names=tuple(names))

    def subset(self, some: Rows) -> Noise:
        """Copy that keeps only `some` of the kept rows; mask of shape (rows,)."""
        return replace(self, kept=self.kept & some)

    @cached_property
    def used(self) -> Rows:
        """Mask of the rows that are kept and were measured, shape (rows,); m of them."""
        return self.kept & np.isfinite(self.sd)

    @property
    def points(self) -> int:
        """m, the number of rows that are used."""
        return int(np.count_nonzero(self.used))

    def whiten(self, residuals: Array) -> Array:
        """Whiten residuals (rows,) or (rows, k); return the rows used, shape (m,) or (m, k).

        Values that are not finite count as zero, so that a derivative without a solution explains nothing.
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
        """Most likely nuisances b (k,) for residuals (rows,)."""
        return np.asarray(self._estimator @ residuals[self.used])

    def remove(self, residuals: Array) -> Array:
        """Residuals (rows,) minus the most likely nuisances."""
        if not self.columns.shape[1]:
            return residuals
        return np.asarray(residuals - self.columns @ self.estimate(residuals))

    def removed_variance(self) -> float:
        """Expected sum of squares of the noise after `remove`, over the rows that are used."""
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
