"""How an effect enters a compression test: as in homogeneous tests, and what platens and load cells do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.compression._record import is_compressed
from calibration.measurements.homogeneous._effect import HomogeneousEffect

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CompressionEffect(HomogeneousEffect):
    """It applies to records of compression only.

    Attributes
    ----------
    bonds : the amplitude is the fraction of the way from free to bonded platens (in the force's logarithm).
    rubs : the amplitude is the coefficient of friction of the platens.
    tilts : the amplitude is the gap across an end face when its first edge touches, over the height.
    reads : nominal stress [Pa] that the load cell shows, from the true one and the amplitude.
    """

    bonds: bool = False
    rubs: bool = False
    tilts: bool = False
    reads: Callable[[Array, float], Array] | None = None
    applies_to: Callable[[Any], bool] = is_compressed
