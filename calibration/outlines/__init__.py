"""Outlines of beams against simulated ones: the likelihood of what was traced."""

from calibration.outlines._admitted import Admitted, admitted
from calibration.outlines._edges import Feet, edges, feet
from calibration.outlines._noise import contour_root, registration_columns, smooth_basis
from calibration.outlines.objective import (
    COARSE,
    REFERENCE,
    Fidelity,
    OutlineObjective,
    Photograph,
    away_from_clamps,
)

__all__ = [
    "COARSE",
    "REFERENCE",
    "Admitted",
    "Feet",
    "Fidelity",
    "OutlineObjective",
    "Photograph",
    "admitted",
    "away_from_clamps",
    "contour_root",
    "edges",
    "feet",
    "registration_columns",
    "smooth_basis",
]
