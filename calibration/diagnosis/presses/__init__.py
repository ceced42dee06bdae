"""Diagnosis of cylinders pressed between platens: friction, rig and material nested in their force."""

from calibration.diagnosis.presses import pictures as _pictures  # noqa: F401 - registers them
from calibration.diagnosis.presses._pressed import all_pressed, holds_pressed
from calibration.diagnosis.presses.effects import EFFECTS, PressEffect
from calibration.diagnosis.presses.model import PressModel

__all__ = ["EFFECTS", "PressEffect", "PressModel", "all_pressed", "holds_pressed"]
