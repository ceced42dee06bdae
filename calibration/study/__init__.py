"""A calibration study: every material of an experiment against every law, on disk, resumable."""

from calibration.study._store import finished, remove_fits
from calibration.study.calibrate import FitOptions, best_so_far, calibrate
from calibration.study.calibration import Calibration, HeldOut
from calibration.study.cards import best, card, usable, write_card
from calibration.study.measurements import Measurements, ObjectiveName, OnSetup, measurements
from calibration.study.run import run, stopped
from calibration.study.tasks import Task, by_cost, tasks_for

__all__ = [
    "Calibration",
    "FitOptions",
    "HeldOut",
    "Measurements",
    "ObjectiveName",
    "OnSetup",
    "Task",
    "best",
    "best_so_far",
    "by_cost",
    "calibrate",
    "card",
    "finished",
    "measurements",
    "remove_fits",
    "run",
    "stopped",
    "tasks_for",
    "usable",
    "write_card",
]
