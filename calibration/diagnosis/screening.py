"""What each candidate would explain, to first order: its column with all that is free projected out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate, Effect
from calibration.diagnosis.fitting import Fit
from calibration.diagnosis.nested import Linear

Array = NDArray[np.float64]

# Part of a column's length that must be left after projection. Less is what finite differences of two exact
# aliases (weight and stiffness) leave: an effect seen by so little would need hundreds of sigmas anyway.
UNSEEN = 5e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Screen:
    """Candidates' columns with u (and the effects already there) projected out.

    directions (m, c): of unit length, zero where the data cannot see the candidate; sizes (c,): length of the
    projected column, so that an amplitude of 1/size is one standard deviation.
    """

    candidates: tuple[Candidate, ...]
    directions: Array
    sizes: Array
    upwards: NDArray[np.bool_]  # (c,): amplitudes may only be positive
    free: Array  # (m, n): orthonormal, what was projected out

    def gains(self, z: Array) -> Array:
        """Improvement of chi-square by each candidate, to first order: (c,) for z (m,), (batch, c) for
        (batch, m)."""
        along = z @ self.directions  # an amplitude is minus this over the size
        return np.asarray(np.where(self.upwards & (along > 0.0), 0.0, along) ** 2)

    def promises(self, z: Array) -> Array:
        """These improvements, less what the choice of a place among several is worth: of two candidates that
        explain alike, the one that leaves less to choose. Shapes as `gains`."""
        return np.asarray(self.gains(z) - np.array([worth(c) for c in self.candidates]))

    def amplitudes(self, z: Array) -> Array:
        """Best amplitude of each candidate alone [SI], to first order."""
        sizes = np.where(self.sizes > 0, self.sizes, np.inf)
        return np.asarray(-(z @ self.directions) / sizes)


def worth(candidate: Candidate) -> float:
    """What the choice of its place, one of several, is worth in chi-square."""
    return float(2.0 * np.log(candidate.rivals))


def screen(linear: Linear, effects: Mapping[str, Effect], *, held: Fit | None = None) -> Screen:
    """Project u, and the columns of the effects that a fit holds already, out of all candidates. What such a
    fit has is there to be taken away as well: its effects may go either way."""
    fixed = linear.by_u if held is None else np.column_stack([linear.by_u, held.linear.columns])
    there = set() if held is None else {c.effect for c in held.candidates}
    upwards = np.array(
        [effects[c.effect].bounds[0] >= 0.0 and c.effect not in there for c in linear.candidates]
    )
    free = basis_of(fixed)
    raw = linear.columns
    left = raw - free @ (free.T @ raw)
    left -= free @ (free.T @ left)  # once more: the first pass leaves rounding of what was large
    sizes, whole = np.linalg.norm(left, axis=0), np.linalg.norm(raw, axis=0)
    seen = sizes > (linear.unseen or UNSEEN) * np.where(whole > 0, whole, 1.0)
    sizes = np.where(seen, sizes, 0.0)
    directions = np.where(seen, left / np.where(seen, sizes, 1.0), 0.0)
    return Screen(
        candidates=linear.candidates,
        directions=directions,
        sizes=sizes,
        upwards=upwards.astype(bool),
        free=free,
    )


def basis_of(columns: Array) -> Array:
    """Orthonormal basis of the columns' span, (m, rank)."""
    size = np.linalg.norm(columns, axis=0)
    used = columns[:, size > 0] / size[size > 0]
    if not used.size:
        return np.zeros((len(columns), 0))
    u, s, _ = np.linalg.svd(used, full_matrices=False)
    return np.asarray(u[:, s > 1e-7 * s[0]])
