"""Coupons (homogeneous tests): stress without a mesh, an objective, a fit with its certainty."""

from calibration.coupons._noise import SMALLEST_RELATIVE, relative_sd, scatter_scale, slope
from calibration.coupons.fit import CouponFit, FitStatus, fit_coupons
from calibration.coupons.homogeneous import MODES, nominal_stress, nominal_stresses
from calibration.coupons.misfit import percent_error
from calibration.coupons.objective import CouponObjective, Coupons

__all__ = [
    "MODES",
    "SMALLEST_RELATIVE",
    "CouponFit",
    "CouponObjective",
    "Coupons",
    "FitStatus",
    "fit_coupons",
    "nominal_stress",
    "nominal_stresses",
    "percent_error",
    "relative_sd",
    "scatter_scale",
    "slope",
]
