"""Cubic spline of the nominal stress of one material in one mode."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from calibration.experiment.model import CouponMode
from calibration.measurements.homogeneous.stress import nominal_stress
from tisim import Material

Array = NDArray[np.float64]

# step of ln stretch: the error for a rubber is 1e-8, and smooth, as finite differences require
STEP = 1.0 / 512
LAST = 2.0  # largest |ln stretch|
_MARGIN = 8  # nodes beyond it: a spline is less accurate at its ends


class Curve:
    """Nominal stress as a function of the stretch.

    If a stretch lies outside [e^-2, e^2], in simple shear, or if the law has no solution at some node, the
    stress is computed by `nominal_stress` at each call.

    Parameters
    ----------
    material : material without parts (the stress must not depend on the history).
    mode : mode of loading.
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
        """Nominal stress [Pa], shape of `stretch`; NaN where the law has no solution."""
        log = np.log(stretch) if self._spline is not None else np.inf
        if self._spline is None or not np.abs(log).max(initial=0.0) <= LAST:
            return nominal_stress(self._material, self._mode, stretch)
        return np.asarray(self._spline(log))
