"""Derivatives of bars' whitened residuals, by finite differences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate, Effect
from calibration.diagnosis.nested import Linear, State

Array = NDArray[np.float64]

# What changes a frequency has a long column, of which a modulus takes nearly all; the closed forms of the
# reduced bar leave nothing else to finite differences.
UNSEEN = 1e-4
STEP = 1e-5  # of a coordinate u, in a finite difference


def linearised(
    whole: Callable[[State], Array | None],
    state: State,
    candidates: Sequence[Candidate],
    effects: Mapping[str, Effect],
) -> Linear:
    """whole: all rows at a state, None where a bar has no equilibrium; ValueError where that is here."""
    z = whole(state)
    if z is None:
        raise ValueError("the bar has no equilibrium at this state")
    by_u = np.zeros((z.size, len(state.u)))
    for k in range(len(state.u)):
        for step in (STEP, -STEP):
            u = state.u.copy()
            u[k] += step
            moved = whole(replace(state, u=u))
            if moved is not None:
                by_u[:, k] = (moved - z) / step
                break
    columns = np.zeros((z.size, len(candidates)))
    for k, c in enumerate(candidates):
        now = state.amplitudes.get(c, 0.0)
        effect = effects[c.effect]
        step = effect.step if now + effect.step <= effect.bounds[1] else -effect.step
        moved = whole(replace(state, amplitudes={**state.amplitudes, c: now + step}))
        if moved is not None:  # a candidate without an equilibrium one step on explains nothing
            columns[:, k] = (moved - z) / step
    return Linear(
        state=state,
        z=z,
        by_u=by_u,
        columns=columns,
        candidates=tuple(candidates),
        unseen=UNSEEN,
    )
