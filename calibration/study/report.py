"""The page that people read, at the end of a study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from calibration.experiment import Experiment
from calibration.report import write_page
from calibration.study.calibration import Calibration


def write_report(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> Path:
    """Write report.html and pictures/ into the folder; the path of the page (see `calibration.report`)."""
    return write_page(folder, results, experiment)
