"""On the way back the stress lies below that of the way out: by this part once all energy is given back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.coupons._kinematics import first_excess
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _factor(s: Array, amplitude: float, record: Record) -> Array:
    del s
    back = np.clip(1.0 - first_excess(record.mode, record.stretch) / record.turn, 0.0, 1.0)
    return 1.0 - amplitude * np.where(np.isfinite(back), back, 0.0)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some unloading."""
    del everything
    return any(r.unloads for r in reached)


EFFECT = CouponEffect(
    name="hysteresis",
    parameter="unloading_loss",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 0.95),
    plausible=0.5,
    sentence="the material gives back less than was put in: unloading lies below loading",
    remedy="record the unloading too",
    factor=_factor,
    shows=_shows,
)
