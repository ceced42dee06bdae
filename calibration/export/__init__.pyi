from ._export import Exported, export_card
from ._forms import Form
from ._job import Job, Target, Written
from ._registry import get, names, register, unregister
from ._scene import BeamScene, Prediction
from .command import EXAMPLES, app

__all__ = [
    "EXAMPLES",
    "BeamScene",
    "Exported",
    "Form",
    "Job",
    "Prediction",
    "Target",
    "Written",
    "app",
    "export_card",
    "get",
    "names",
    "register",
    "unregister",
]
