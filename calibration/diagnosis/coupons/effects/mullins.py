"""Once strained, the material is softer below the largest strain that it has seen: by this part at rest, by
nothing at that strain. The pseudo-elastic softening of Ogden and Roxburgh, Proc. R. Soc. Lond. A 455 (1999):
1 - erf((W_m - W) / m) / r with W_m the largest energy so far, here of a Neo-Hookean solid, and with m = W_m,
so that the amplitude is erf(1) / r. One record seldom tells m, by which the amplitude changes a little."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import erf

from calibration.diagnosis.coupons._kinematics import first_excess
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects._effect import Array, CouponEffect


def _factor(s: Array, amplitude: float, record: Record) -> Array:
    del s
    if not record.reloaded:
        return np.ones(record.points)
    with np.errstate(invalid="ignore", divide="ignore"):
        below = 1.0 - first_excess(record.mode, record.stretch) / record.peak
    left = np.where(np.isfinite(below), np.clip(below, 0.0, 1.0), 0.0)
    return 1.0 - amplitude * erf(left) / erf(1.0)


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
