"""Calibration: photographs and records in, material cards out. SI units; millimetres only in files.

>>> import calibration
>>> experiment = calibration.read_experiment("lab/monday")  # doctest: +SKIP
>>> fits = calibration.fit(experiment, model="neo-hookean", out="calibrations/monday")  # doctest: +SKIP
>>> fits.best("S1").shear_modulus  # doctest: +SKIP
9700.0
>>> print(calibration.diagnose(experiment).sentence)  # doctest: +SKIP
Found: the material creeps: it sinks further with time (creep).

The same as commands: `python -m calibration` lists them.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.api import diagnose, fit, predict, read_experiment, reconstruct
    from calibration.diagnosis.file import read_diagnosis
    from calibration.errors import InputError
    from calibration.results import DiagnosisResult, Fits, PredictionResult, Reconstruction

__all__ = [
    "DiagnosisResult",
    "Fits",
    "InputError",
    "PredictionResult",
    "Reconstruction",
    "diagnose",
    "fit",
    "predict",
    "read_diagnosis",
    "read_experiment",
    "reconstruct",
]

# imported when asked for, so that a command's help needs no simulator
_HOME = {
    "DiagnosisResult": "calibration.results",
    "Fits": "calibration.results",
    "InputError": "calibration.errors",
    "PredictionResult": "calibration.results",
    "Reconstruction": "calibration.results",
    "diagnose": "calibration.api",
    "fit": "calibration.api",
    "predict": "calibration.api",
    "read_diagnosis": "calibration.diagnosis.file",
    "read_experiment": "calibration.api",
    "reconstruct": "calibration.api",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


class _Package(ModuleType):
    """The package: `calibration.fit` stays the function where the command module of that name is imported.

    Importing a module binds it to its package; `python -m calibration.fit` and `from calibration.fit import
    app` find the module by its name and need no such binding.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
