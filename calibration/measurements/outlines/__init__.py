"""Traced outlines of beams compared with simulations; `.model.OutlineModel` is the measurement model."""

from calibration.measurements.outlines._admitted import Admitted, admitted
from calibration.measurements.outlines._edges import Projection, edges, project
from calibration.measurements.outlines._noise import (
    Nuisances,
    contour_root,
    registration_columns,
    smooth_basis,
)
from calibration.measurements.outlines._photographs import TracedPhotograph, away_from_clamps
from calibration.measurements.outlines.fidelity import COARSE, REFERENCE, Fidelity, beam_scene

__all__ = [
    "COARSE",
    "REFERENCE",
    "Admitted",
    "Fidelity",
    "Nuisances",
    "Projection",
    "TracedPhotograph",
    "admitted",
    "away_from_clamps",
    "beam_scene",
    "contour_root",
    "edges",
    "project",
    "registration_columns",
    "smooth_basis",
]
