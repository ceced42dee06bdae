"""Shapes of beams: the mid line of a traced outline, bodies swept along it, bodies of results and files."""

from calibration.shape.body import Units, body_between, body_mesh, read_mesh, sweep
from calibration.shape.centreline import Centreline, centreline

__all__ = ["Centreline", "Units", "body_between", "body_mesh", "centreline", "read_mesh", "sweep"]
