"""A calibration study: every material of an experiment against every law, on disk, resumable."""

from calibration.study.calibrate import FitOptions, best_so_far, calibrate
from calibration.study.calibration import Calibration, HeldOut
from calibration.study.cards import best, card, usable, write_card
from calibration.study.measurements import Measurements, ObjectiveName, OnSetup, measurements
from calibration.study.run import Progress, Task, run, stopped

__all__ = [
    "Calibration",
    "FitOptions",
    "HeldOut",
    "Measurements",
    "ObjectiveName",
    "OnSetup",
    "Progress",
    "Task",
    "best",
    "best_so_far",
    "calibrate",
    "card",
    "measurements",
    "run",
    "stopped",
    "usable",
    "write_card",
]
