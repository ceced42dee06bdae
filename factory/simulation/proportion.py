"""Results of pokes that share another's solve: its arrays, with the forces in proportion."""

from __future__ import annotations

import io

import numpy as np

from factory.plan.poke import PlannedPoke
from factory.simulation.record import Arrays, Outcome, encode

FORCES = ("rod_force", "base_force")


def in_proportion(arrays: Arrays, poke: PlannedPoke) -> Outcome:
    """Outcome of a derived poke from the arrays of its solve: forces scaled, solver counters 0."""
    scaled = {name: np.asarray(values) for name, values in arrays.items()}
    for name in FORCES:
        scaled[name] = poke.force_factor * np.asarray(scaled[name], dtype=np.float64)
    scaled["counters"] = np.zeros_like(scaled["counters"])
    scaled["poke"] = np.array(poke.index, dtype=np.int64)
    return Outcome(index=poke.index, payload=encode(scaled), error=None)


def arrays_of(outcome: Outcome) -> Arrays:
    """Arrays of a successful outcome."""
    assert outcome.payload is not None
    with np.load(io.BytesIO(outcome.payload), allow_pickle=False) as file:
        return dict(file)
