"""Predictions: a calibrated model against trials that it was not fitted to, with intervals.

Cards, or a fit to some trials of an experiment, predict other trials through the model of their kind of
measurement (`calibration.measurements`); a baseline stands beside what extends it.
"""

from __future__ import annotations

from calibration.prediction.run import Prediction, from_cards
from calibration.prediction.trials import from_trials

__all__ = ["Prediction", "from_cards", "from_trials"]
