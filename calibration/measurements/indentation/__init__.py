"""Indentation tests: force against depth of an indenter in a block; a model for fits and diagnoses."""

from calibration.measurements.indentation._noise import TOGETHER, scatter, wandering_modes
from calibration.measurements.indentation._scene import approach, block_names, poke_scene

__all__ = [
    "TOGETHER",
    "approach",
    "block_names",
    "poke_scene",
    "scatter",
    "wandering_modes",
]
