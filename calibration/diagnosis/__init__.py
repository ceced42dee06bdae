"""Diagnosis of misfit between simulation and measurement: search for the effects that the simulation lacks.

>>> from pathlib import Path
>>> from calibration.diagnosis import diagnose, model_of
>>> from calibration.experiment import read
>>> model = model_of(read(Path("datasets/measured/bench/creeps")))  # doctest: +SKIP
>>> diagnose(model).sentence()  # doctest: +SKIP
'Found: the material creeps: it sinks further with time (creep).'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.diagnosis.engine.rules import Rules
    from calibration.diagnosis.engine.run import diagnose
    from calibration.diagnosis.engine.search import Finding, search
    from calibration.diagnosis.engine.verdict import Diagnosis
    from calibration.diagnosis.model import model_of
    from calibration.measurements._effect import Candidate, Effect
    from calibration.measurements._kinds import kinds
    from calibration.measurements._model import MeasurementModel
    from calibration.measurements.outlines.simulators import SIMULATORS

# imported on first access, so that a command's help needs no simulator
_HOME = {
    "Candidate": "calibration.measurements._effect",
    "Diagnosis": "calibration.diagnosis.engine.verdict",
    "Effect": "calibration.measurements._effect",
    "Finding": "calibration.diagnosis.engine.search",
    "Rules": "calibration.diagnosis.engine.rules",
    "SIMULATORS": "calibration.measurements.outlines.simulators",
    "MeasurementModel": "calibration.measurements._model",
    "diagnose": "calibration.diagnosis.engine.run",
    "kinds": "calibration.measurements._kinds",
    "model_of": "calibration.diagnosis.model",
    "search": "calibration.diagnosis.engine.search",
}

__all__ = [
    "SIMULATORS",
    "Candidate",
    "Diagnosis",
    "Effect",
    "Finding",
    "MeasurementModel",
    "Rules",
    "diagnose",
    "kinds",
    "model_of",
    "search",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
