"""Models that answer pokes; each has `encode(scene)` (once a geometry) and `decode(encoded, pokes)`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from learn.data.statistics import Statistics
from learn.errors import InputError
from learn.models._model import Model
from learn.models.cegnn import Cegnn
from learn.models.ensemble import Ensemble
from learn.models.ours import Surrogate
from learn.models.scene import Pokes, Prediction, Scene, make_scene, pokes_of, scene_of

MODELS: dict[str, Callable[[Statistics], Model]] = {
    "ours": Surrogate,
    # for a thousand answers a second, at a larger error
    "ours-small": partial(Surrogate, hidden=32, messages=8, directions=4),
    "cegnn": Cegnn,
}
# of the architectures: weights of another do not fit. Version 1 of ours did not know the rod's surface
VERSIONS = {"ours": 2, "ours-small": 2, "cegnn": 1}


def make_model(name: str, statistics: Statistics) -> Model:
    """A fresh model by name; its weights come from torch's random state."""
    if name not in MODELS:
        raise InputError(f"model {name}: expected one of {', '.join(MODELS)}")
    return MODELS[name](statistics)


__all__ = [
    "MODELS",
    "VERSIONS",
    "Cegnn",
    "Ensemble",
    "Model",
    "Pokes",
    "Prediction",
    "Scene",
    "Surrogate",
    "make_model",
    "make_scene",
    "pokes_of",
    "scene_of",
]
