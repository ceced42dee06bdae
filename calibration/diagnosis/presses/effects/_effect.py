"""An effect on a pressed cylinder: what an effect on a coupon may be, and what platens and load cells do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons import CouponEffect
from calibration.diagnosis.presses._pressed import is_pressed

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PressEffect(CouponEffect):
    """holds: the amplitude is the part of the way from free to bonded platens (in the force's logarithm).
    tilts: the amplitude is the gap across an end face when its first edge touches, over the height.
    reads: what the load cell makes of the nominal stress [Pa], with the amplitude.

    It touches records of compression only.
    """

    holds: bool = False
    tilts: bool = False
    reads: Callable[[Array, float], Array] | None = None
    touches: Callable[..., bool] = is_pressed
