"""Homogeneous material tests (coupons): nominal stress without a mesh, weights and windows of records."""

from calibration.measurements.homogeneous._branches import protocol_window
from calibration.measurements.homogeneous._forward import predicted
from calibration.measurements.homogeneous._scatter import (
    SMALLEST_RELATIVE,
    grows,
    relative_sd,
    slope,
    unstated_sd,
)
from calibration.measurements.homogeneous.stress import MODES, nominal_stress, nominal_stresses, percent_error

__all__ = [
    "MODES",
    "SMALLEST_RELATIVE",
    "grows",
    "nominal_stress",
    "nominal_stresses",
    "percent_error",
    "predicted",
    "protocol_window",
    "relative_sd",
    "slope",
    "unstated_sd",
]
