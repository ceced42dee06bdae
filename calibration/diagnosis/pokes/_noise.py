"""The noise of pokes: each value by itself, and nuisances that many share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from calibration.diagnosis.pokes._curve import Curve
from calibration.diagnosis.pokes._nuisances import columns_of, point_sd, side_sd
from calibration.diagnosis.pokes._record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Noise:
    """sd (rows,) [N]: of each value by itself; known (rows, n) [N]: one standard deviation of each nuisance;
    kept (rows,): which values are compared, k of them."""

    sd: Array
    known: Array
    kept: NDArray[np.bool_]

    def among(self, kept: NDArray[np.bool_]) -> Noise:
        """The same for other values."""
        return replace(self, kept=kept)

    def covariance(self) -> Array:
        """(k, k) [N2]."""
        known = self.known[self.kept]
        return np.asarray(np.diag(self.sd[self.kept] ** 2) + known @ known.T)

    def whiten(self, raw: Array) -> Array:
        """Of residuals (rows,) or (rows, m) those that are kept, uncorrelated and of unit variance."""
        return np.asarray(solve_triangular(self._root, raw[self.kept], lower=True))

    def taken_out(self) -> Array:
        """(k, k): takes the most likely nuisances out of residuals."""
        sd, known = self.sd[self.kept], self.known[self.kept]
        inside = known / sd[:, None] ** 2
        estimate = np.linalg.solve(known.T @ inside + np.eye(known.shape[1]), inside.T)
        return np.asarray(np.eye(len(sd)) - known @ estimate)

    @cached_property
    def _root(self) -> Array:
        return np.asarray(cholesky(self.covariance(), lower=True))


def noise_of(
    records: Sequence[Record],
    curves: Sequence[Curve],
    forces: Sequence[Array],
    slopes: Sequence[Array],
    kept: NDArray[np.bool_],
) -> Noise:
    """Of all forces along the rod, then of all across it; forces [N] and slopes [N/m]: as simulated, by the
    curve of each record."""
    along = [point_sd(r, c, f, s) for r, c, f, s in zip(records, curves, forces, slopes, strict=True)]
    across = [
        np.repeat(side_sd(r, f), 2) for r, f in zip(records, forces, strict=True) if r.across is not None
    ]
    columns = columns_of(records, curves, forces, slopes)
    none = np.zeros((len(kept) - len(columns), columns.shape[1]))  # nuisances are along the rod
    return Noise(np.concatenate([*along, *across]), np.vstack([columns, none]), kept)
