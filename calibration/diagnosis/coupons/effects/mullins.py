"""Once strained, the material is softer below the largest strain that it has seen: by this part at rest, by
nothing at that strain (a pseudo-elastic damage linear in what is left of the energy)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.coupons._kinematics import first_excess
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _factor(s: Array, amplitude: float, record: Record) -> Array:
    del s
    if not record.reloaded:
        return np.ones(record.points)
    with np.errstate(invalid="ignore", divide="ignore"):
        below = 1.0 - first_excess(record.mode, record.stretch) / record.peak
    return 1.0 - amplitude * np.where(np.isfinite(below), np.clip(below, 0.0, 1.0), 0.0)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some second loading."""
    del everything
    return any(r.reloaded for r in reached)


EFFECT = CouponEffect(
    name="mullins",
    parameter="softening",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 0.95),
    plausible=0.5,
    sentence="the first loading softens the material (Mullins): the second one needs less stress",
    remedy="load the same specimen twice to the same strain",
    factor=_factor,
    shows=_shows,
)
