"""The nominal stress of one material in one mode, as a spline through stresses that are solved for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from calibration.experiment.model import CouponMode
from calibration.measurements.homogeneous.stress import nominal_stress
from tisim import Material

Array = NDArray[np.float64]

# of ln stretch: a rubber's stress is met to 1e-8, and smoothly, which is what finite differences need
STEP = 1.0 / 512
LAST = 2.0  # of ln stretch on either side of rest
_MARGIN = 8  # nodes beyond: a spline is less sharp at its ends


class Curve:
    """Stress at any stretch. Beyond e^2 and e^-2, and in simple shear, it is solved for each time.

    Parameters
    ----------
    material : without parts, which would remember.
    mode : of loading.
    """

    def __init__(self, material: Material, mode: CouponMode) -> None:
        self._material, self._mode = material, mode
        self._spline: CubicSpline | None = None
        if mode != "simple-shear":
            count = int(LAST / STEP) + _MARGIN
            nodes = STEP * np.arange(-count, count + 1)
            stress = nominal_stress(material, mode, np.exp(nodes))
            if np.isfinite(stress).all():
                self._spline = CubicSpline(nodes, stress)

    def at(self, stretch: Array) -> Array:
        """[Pa], shape of the stretch; NaN where the law has none."""
        log = np.log(stretch) if self._spline is not None else np.inf
        if self._spline is None or not np.abs(log).max(initial=0.0) <= LAST:
            return nominal_stress(self._material, self._mode, stretch)
        return np.asarray(self._spline(log))
