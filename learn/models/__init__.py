"""Models of the poke response: `encode(scene)` once a geometry, `decode(encoded, pokes)` once a poke."""

from learn.models import cegnn as _cegnn  # noqa: F401 - imported for the models that they register
from learn.models import invariant_gnn as _invariant_gnn  # noqa: F401
from learn.models.base import (
    MODELS,
    OLD_NAMES,
    Ensemble,
    Model,
    make_model,
    register_model,
)
from learn.models.cegnn import Cegnn
from learn.models.invariant_gnn import InvariantGnn
from learn.models.scene import Pokes, Response, Scene, Scenes, make_scene, pokes_of, scene_on

__all__ = [
    "MODELS",
    "OLD_NAMES",
    "Cegnn",
    "Ensemble",
    "InvariantGnn",
    "Model",
    "Pokes",
    "Response",
    "Scene",
    "Scenes",
    "make_model",
    "make_scene",
    "pokes_of",
    "register_model",
    "scene_on",
]
