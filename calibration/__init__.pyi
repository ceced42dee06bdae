from .api import diagnose, fit, predict, read_experiment, reconstruct
from .diagnosis.file import read_diagnosis
from .errors import InputError
from .results import DiagnosisResult, Fits, PredictionResult, Reconstruction

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
