"""Shapes of beams: the mid line of a traced outline, bodies swept along it, bodies of results and files."""

from calibration.shape.body import body_mesh
from calibration.shape.centreline import Centreline, centreline
from calibration.shape.files import Units, read_mesh
from calibration.shape.sweep import sweep

__all__ = ["Centreline", "Units", "body_mesh", "centreline", "read_mesh", "sweep"]
