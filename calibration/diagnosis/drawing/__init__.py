"""Figures of a diagnosis for all kinds of measurement: interface, bars, curves and panels."""

from calibration.diagnosis.drawing import homogeneous, indentation, outlines, release
from calibration.diagnosis.drawing._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.drawing._curves import (
    DrawnCurve,
    before_and_after,
    legend_of,
    most_telling,
)
from calibration.diagnosis.drawing._domain import Figure, Section, figures_of
from calibration.diagnosis.drawing._labels import label, label_of_causes
from calibration.diagnosis.drawing._panels import (
    PANELS,
    dots,
    draw_rms,
    legend_handles,
    measured_and_simulated,
    per_trial,
    titled,
)

__all__ = [
    "AFTER",
    "BEFORE",
    "PANELS",
    "DrawnCurve",
    "Figure",
    "Section",
    "before_and_after",
    "dots",
    "draw_rms",
    "figures_of",
    "homogeneous",
    "indentation",
    "label",
    "label_of_causes",
    "legend_handles",
    "legend_of",
    "measured_and_simulated",
    "most_telling",
    "outlines",
    "paired_bars",
    "per_trial",
    "release",
    "titled",
]
