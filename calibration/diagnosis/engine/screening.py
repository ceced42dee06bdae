"""Screening: first-order improvement by each candidate, with all free coordinates projected out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit
from calibration.measurements._effect import Candidate, EffectModel
from calibration.measurements._state import Linearisation

Array = NDArray[np.float64]

# Fraction of a column's length that must remain after projection. Finite differences of two exact aliases
# (weight and stiffness) leave less; an effect that is so nearly aliased would need hundreds of sigmas anyway.
ALIAS_TOLERANCE = 5e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Screen:
    """Candidates' columns, with u and the effects of a given fit projected out.

    Attributes
    ----------
    candidates : candidates of the columns.
    directions : projected columns normalised to unit length, shape (m, c); zero for undetectable candidates.
    sizes : lengths of the projected columns, shape (c,), 0 for undetectable candidates. One standard
        deviation of an amplitude is 1/size.
    upwards : True for amplitudes that may only be positive, shape (c,).
    free : orthonormal basis of the subspace that was projected out, shape (m, rank).
    """

    candidates: tuple[Candidate, ...]
    directions: Array
    sizes: Array
    upwards: NDArray[np.bool_]
    free: Array

    def improvements(self, z: Array) -> Array:
        """Reduction of chi-square by each candidate alone, to first order.

        Shape (c,) for z of shape (m,), shape (batch, c) for (batch, m).
        """
        along = z @ self.directions  # the amplitude is -along / size
        return np.asarray(np.where(self.upwards & (along > 0.0), 0.0, along) ** 2)

    def penalised(self, z: Array) -> Array:
        """Improvements minus each candidate's multiplicity penalty. Shapes as `improvements`."""
        return np.asarray(self.improvements(z) - np.array([multiplicity_penalty(c) for c in self.candidates]))

    def amplitudes(self, z: Array) -> Array:
        """Best amplitude of each candidate alone [SI], to first order."""
        sizes = np.where(self.sizes > 0, self.sizes, np.inf)
        return np.asarray(-(z @ self.directions) / sizes)


def multiplicity_penalty(candidate: Candidate) -> float:
    """Penalty in chi-square for the choice of scope, position and variant: 2 ln(number of alternatives)."""
    return float(2.0 * np.log(candidate.alternatives))


def screen(linear: Linearisation, effects: Mapping[str, EffectModel], *, held: Fit | None = None) -> Screen:
    """Project u and the columns of the causes in the fit `held` out of the columns of all candidates.

    Amplitudes of effects that the fit has already may change in either direction.
    """
    fixed = linear.by_u if held is None else np.column_stack([linear.by_u, held.linear.columns])
    there = set() if held is None else {c.effect for c in held.candidates}
    upwards = np.array(
        [effects[c.effect].bounds[0] >= 0.0 and c.effect not in there for c in linear.candidates]
    )
    free = basis_of(fixed)
    raw = linear.columns
    left = raw - free @ (free.T @ raw)
    left -= free @ (free.T @ left)  # reorthogonalise: the first pass leaves rounding errors of large columns
    sizes, whole = np.linalg.norm(left, axis=0), np.linalg.norm(raw, axis=0)
    seen = sizes > (linear.alias_tolerance or ALIAS_TOLERANCE) * np.where(whole > 0, whole, 1.0)
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
    """Orthonormal basis of the span of the columns, shape (m, rank)."""
    size = np.linalg.norm(columns, axis=0)
    used = columns[:, size > 0] / size[size > 0]
    if not used.size:
        return np.zeros((len(columns), 0))
    u, s, _ = np.linalg.svd(used, full_matrices=False)
    return np.asarray(u[:, s > 1e-7 * s[0]])
