"""Pokes as an objective: force against depth of a rod in a block, not simulated for each candidate."""

from calibration.pokes._branch import LoadingBranch, loading_branch
from calibration.pokes._errors import TOGETHER, scatter, wandering_modes
from calibration.pokes._run import PokeRun
from calibration.pokes._scene import approach, block_names, poke_scene
from calibration.pokes.objective import PokeObjective

__all__ = [
    "TOGETHER",
    "LoadingBranch",
    "PokeObjective",
    "PokeRun",
    "approach",
    "block_names",
    "loading_branch",
    "poke_scene",
    "scatter",
    "wandering_modes",
]
