"""The page that people read: filled in by the report's own modules."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from calibration.experiment import Experiment
from calibration.study.calibration import Calibration


def write_report(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> Path:
    """Write report.html into the folder."""
    raise NotImplementedError
