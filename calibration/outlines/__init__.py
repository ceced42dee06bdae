"""Outlines of beams against simulated ones: the likelihood of what was traced."""

from calibration.outlines._admitted import Admitted, admitted
from calibration.outlines._edges import Feet, edges, feet
from calibration.outlines._noise import Nuisances, contour_root, registration_columns, smooth_basis
from calibration.outlines.fidelity import COARSE, REFERENCE, Fidelity, beam_scene
from calibration.outlines.objective import OutlineObjective, Photograph, away_from_clamps

__all__ = [
    "COARSE",
    "REFERENCE",
    "Admitted",
    "Feet",
    "Fidelity",
    "Nuisances",
    "OutlineObjective",
    "Photograph",
    "admitted",
    "away_from_clamps",
    "beam_scene",
    "contour_root",
    "edges",
    "feet",
    "registration_columns",
    "smooth_basis",
]
