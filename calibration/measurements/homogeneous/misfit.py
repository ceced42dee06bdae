"""Misfit of a law to a measured curve, for tables."""

from __future__ import annotations

import numpy as np

from calibration.experiment.model import CouponTrial
from calibration.measurements.homogeneous.stress import nominal_stress
from tisim import Material


def percent_error(trial: CouponTrial, material: Material) -> float:
    """Root mean square of (model - data) over the curve's points, in percent of its largest |stress|.

    NaN if the law has no solution at some point of the curve. ValueError if all stresses are 0.
    """
    largest = float(np.abs(trial.stress).max(initial=0.0))
    if largest == 0.0:
        raise ValueError(f"coupon {trial.id}: expected some stress that is not 0")
    left = nominal_stress(material, trial.mode, trial.stretch) - trial.stress
    return 100.0 * float(np.sqrt(np.mean(left**2))) / largest
