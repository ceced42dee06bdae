"""Surrogates of simulated pokes: the dataset's loader, models, training, evaluation, prediction.

Reads the dataset's file format and imports none of the programs that write it.

>>> import learn
>>> predictor = learn.load("runs/quick")
>>> predictor.predict("datasets/scenes/poke.yaml")

The commands are `python -m learn.train`, `learn.evaluate`, `learn.predict`, `learn.export`,
`learn.page` and `learn.bench`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from learn.metrics import register_metric
    from learn.models import register_model
    from learn.predictor import PokePrediction, Predictor, load

    __version__: str

__all__ = ["PokePrediction", "Predictor", "__version__", "load", "register_metric", "register_model"]

_HOMES = {
    "load": "learn.predictor",
    "Predictor": "learn.predictor",
    "PokePrediction": "learn.predictor",
    "register_metric": "learn.metrics",
    "register_model": "learn.models",
}


def __getattr__(name: str) -> Any:
    """Public names on first use: `--help` of a command, and the package without torch, need none of them."""
    if name == "__version__":
        return _version()
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'learn' has no attribute {name!r}")


def _version() -> str:
    """The installed version; "unknown" in a checkout that is not installed."""
    from importlib import metadata

    try:
        return metadata.version("tisim")
    except metadata.PackageNotFoundError:
        return "unknown"
