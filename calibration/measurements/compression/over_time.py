"""Time-dependent fits of compression tests: free platens, along each record, with viscosity and softening."""

from __future__ import annotations

from calibration.measurements._over_time import OverTime
from calibration.measurements.homogeneous.over_time import check, window

OVER_TIME = OverTime(
    options=("time", "damage"),
    window=window,
    check=check,
    why_not="whose cylinders shear between their platens where fibres are oblique",
)
