"""The force falls while the rod rests, and rises with its speed: linear viscoelasticity beside the elastic
force.

F(t) is the elastic force, each of its changes faded since by amplitude times h(time): h = log10(1 + t / 1
s), a part a decade, or of another kind h = 1 - exp(-t / tau), one relaxation time tau.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect

A_DECADE = 4  # relaxation times tried
ONSET = 1.0  # of the logarithm [s]


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    """Never below none: a rod that is not held by the surface leaves it."""
    rise = np.diff(force, prepend=0.0)
    return np.maximum(force - amplitude * (_faded(record, kind) @ rise), 0.0)


@lru_cache(maxsize=512)
def _faded(record: Record, kind: float | None) -> Array:
    """(k, k): mean of h over each change's interval, as seen at each time."""
    end = record.time
    gap = np.diff(end)
    start = np.r_[end[0] - (gap[0] if gap.size else 1.0), end[:-1]]
    early = np.maximum(end[:, None] - start[None, :], 0.0)
    late = np.maximum(end[:, None] - end[None, :], 0.0)
    mean = (_integral(early, kind) - _integral(late, kind)) / (end - start)
    return np.asarray(np.where(end[:, None] >= end[None, :], mean, 0.0))


def _integral(t: Array, kind: float | None) -> Array:
    """Of h from 0 to t."""
    if kind is None:
        x = t / ONSET
        return np.asarray(ONSET * ((1.0 + x) * np.log1p(x) - x) / np.log(10.0))
    return np.asarray(t + kind * np.expm1(-t / kind))


def _kinds(records: Sequence[Record]) -> tuple[float | None, ...]:
    """The logarithm, and times from a few samples to the longest record."""
    longest = max(float(np.ptp(r.time)) for r in records)
    shortest = min(float(np.median(np.diff(r.time))) for r in records if r.points > 1)
    low = int(np.floor(A_DECADE * np.log10(2.0 * shortest)))
    high = int(np.ceil(A_DECADE * np.log10(longest)))
    return (None, *(float(10.0 ** (k / A_DECADE)) for k in range(low, high + 1)))


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """A hold, an unloading, or two rates in one material."""
    del everything
    if any((r.kind < 0).any() or (r.kind == 0).sum() > 2 for r in reached):
        return True
    for material in {r.material for r in reached}:
        times = [
            float(np.ptp(r.time) / max(np.ptp(r.depth), 1e-9)) for r in reached if r.material == material
        ]
        if len(times) > 1 and max(times) > 1.5 * min(times):
            return True
    return False


EFFECT = PokeEffect(
    name="relaxation",
    parameter="loss",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 0.9),
    plausible=0.3,
    sentence="the force relaxes: it falls with time while the rod rests, and depends on its speed",
    remedy="hold the rod at the deepest depth for a minute, or poke at a tenth and ten times the speed",
    force=_force,
    stage=2,
    kinds=_kinds,
    kind_label=lambda kind: f"in {kind:.3g} s",
    shows=_shows,
    reach="material",
)
