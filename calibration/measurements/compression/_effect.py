"""Effects in compression tests: those of homogeneous tests, and effects of platens and load cells."""

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
    """An effect in compression tests; by default it applies to records of compression only.

    Attributes
    ----------
    bonds : True if the amplitude is the fraction from free (0) to bonded (1) platens, in the logarithm of the
        force.
    rubs : True if the amplitude is the friction coefficient of the platens.
    tilts : True if the amplitude is the gap across an end face when its first edge touches, over the height.
    reads : function from the true nominal stress [Pa] and the amplitude to the load cell's reading [Pa].
    """

    bonds: bool = False
    rubs: bool = False
    tilts: bool = False
    reads: Callable[[Array, float], Array] | None = None
    applies_to: Callable[[Any], bool] = is_compressed
