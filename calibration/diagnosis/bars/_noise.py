"""The noise of bars' markers: each mean by itself, and nuisances that many share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


@dataclass(frozen=True, eq=False, kw_only=True)
class Noise:
    """sd (rows,) [m]: of each row by itself, inf where nothing was measured; known (rows, n) [m]: one
    standard deviation of each nuisance; kept (rows,): which rows are compared."""

    sd: Array
    known: Array
    kept: Rows

    @classmethod
    def bare(cls, sd: Array) -> Noise:
        """All rows, no nuisance."""
        return cls(sd=sd, known=np.zeros((len(sd), 0)), kept=np.ones(len(sd), dtype=bool))

    def knowing(self, known: Array) -> Noise:
        """The same with other nuisances."""
        return replace(self, known=known)

    def among(self, some: Rows) -> Noise:
        """Of those kept, some (rows,)."""
        return replace(self, kept=self.kept & some)

    @cached_property
    def used(self) -> Rows:
        """(rows,): those of the kept where something was measured, k of them."""
        return self.kept & np.isfinite(self.sd)

    @property
    def points(self) -> int:
        return int(np.count_nonzero(self.used))

    def whiten(self, values: Array) -> Array:
        """Of residuals (rows,) or (rows, m) those that are used, over their noise and the nuisances':
        (1 + A A^T)^(-1/2)."""
        sd = self.sd[self.used]
        v, less = self._whitener
        x = values[self.used] / (sd if values.ndim == 1 else sd[:, None])
        inside = v.T @ x
        return np.asarray(x - v @ (less * inside if values.ndim == 1 else less[:, None] * inside))

    def taken_out(self, residuals: Array) -> Array:
        """(rows,): residuals without the nuisances that those used make most likely."""
        used = self.used
        known = self.known[used] / self.sd[used][:, None]
        system = known.T @ known + np.eye(known.shape[1])
        likely = np.linalg.solve(system, known.T @ (residuals[used] / self.sd[used]))
        return np.asarray(residuals - self.known @ likely)

    @cached_property
    def _whitener(self) -> tuple[Array, Array]:
        v, s, _ = np.linalg.svd(self.known[self.used] / self.sd[self.used][:, None], full_matrices=False)
        return v, 1.0 - 1.0 / np.sqrt(1.0 + s**2)
