"""Diagnosis of bars that are let go: markers through time, effects nested in a reduced bar."""

from calibration.diagnosis.bars import pictures as _pictures  # noqa: F401 - registers them
from calibration.diagnosis.bars._record import all_let_go, holds_let_go
from calibration.diagnosis.bars.effects import EFFECTS, BarEffect
from calibration.diagnosis.bars.model import BarModel

__all__ = ["EFFECTS", "BarEffect", "BarModel", "all_let_go", "holds_let_go"]
