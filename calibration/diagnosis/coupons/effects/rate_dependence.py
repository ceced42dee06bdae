"""The material is stiffer when it is strained faster: its stress grows by this part with each decade of the
rate, from 0.01 per second."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect

REFERENCE = 0.01  # [1/s]: the shear modulus is that of this rate
APART = 1.5  # quotient of two rates from which they differ


def _factor(s: Array, amplitude: float, record: Record) -> Array:
    del s
    decades = np.log10(record.rate / REFERENCE)
    return 1.0 + amplitude * np.where(np.isfinite(decades), decades, 0.0)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Two rates in one material."""
    del everything
    for material in {r.material for r in reached}:
        rates = np.concatenate([r.rate for r in reached if r.material == material])
        rates = rates[np.isfinite(rates)]
        if rates.size and rates.max() > APART * rates.min():
            return True
    return False


EFFECT = CouponEffect(
    name="rate-dependence",
    parameter="per_decade",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 0.3),
    plausible=0.15,
    sentence="the material is stiffer the faster it is strained",
    remedy="repeat a test at a tenth and at ten times the rate, or hold the largest strain, with time",
    factor=_factor,
    shows=_shows,
)
