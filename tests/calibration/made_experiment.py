"""An experiment of synthetic trials in memory; the folders of the measurements add their own trials."""

from __future__ import annotations

from pathlib import Path

from calibration.experiment import Experiment, MaterialBelief
from calibration.experiment.model import Trial


def experiment(*trials: Trial) -> Experiment:
    return Experiment(
        name="made",
        folder=Path("made"),
        notes="",
        materials={t.material: MaterialBelief(name=t.material) for t in trials},
        trials=trials,
        digest="0" * 64,
    )
