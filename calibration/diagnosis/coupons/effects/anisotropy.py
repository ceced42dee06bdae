"""The material is stiffer along the direction that is pulled: W gets a term G k/8 (I4 - 1)^2, I4 the squared
stretch of that direction. The amplitude k is the excess of stress there, in shear moduli a unit of strain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _extra(s: Array, amplitude: float, record: Record) -> Array:
    if record.mode == "simple-shear":
        return np.zeros(s.size)
    # equibiaxial: the stress is the mean over two directions, of which one has it
    axes = 2.0 if record.mode == "equibiaxial" else 1.0
    return np.asarray(0.5 * amplitude * s * (s**2 - 1.0) / axes)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Two modes of a material, or a specimen to compare with that was not cut alike."""
    for material in {r.material for r in reached}:
        mine = [r for r in reached if r.material == material]
        others = [r for r in everything if r.material == material and r not in mine]
        if len({r.mode for r in mine}) > 1 or others:
            return True
    return False


EFFECT = CouponEffect(
    name="anisotropy",
    parameter="fibre_excess",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(-1.5, 6.0),
    plausible=0.6,
    sentence="the material is stiffer in one direction than in another",
    remedy="cut specimens along and across, and pull both; add another mode of loading",
    extra=_extra,
    shows=_shows,
)
