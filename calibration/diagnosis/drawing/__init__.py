"""What the pictures of a diagnosis share, whatever was measured: how a domain hands them in, bars, curves."""

from calibration.diagnosis.drawing._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.drawing._curves import (
    DrawnCurve,
    legend_of,
    missing,
    most_telling,
    shown_explanation,
)
from calibration.diagnosis.drawing._domain import Figure, noise_of, pictures_of
from calibration.diagnosis.drawing._labels import label, label_of_causes
from calibration.diagnosis.drawing._panels import dots, draw_rms, legend, panels, titled

__all__ = [
    "AFTER",
    "BEFORE",
    "DrawnCurve",
    "Figure",
    "dots",
    "draw_rms",
    "label",
    "label_of_causes",
    "legend",
    "legend_of",
    "missing",
    "most_telling",
    "noise_of",
    "paired_bars",
    "panels",
    "pictures_of",
    "shown_explanation",
    "titled",
]
