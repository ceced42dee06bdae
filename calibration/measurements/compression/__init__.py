"""Cylinders pressed between platens: how they were held, and what they are made of, from force and height."""

from calibration.measurements.compression.curves import SHAPES, Cylinder, Platens, PressCurves, press_curves
from calibration.measurements.compression.fit import PressFit, Repeats, fit_press, repeats

__all__ = [
    "SHAPES",
    "Cylinder",
    "Platens",
    "PressCurves",
    "PressFit",
    "Repeats",
    "fit_press",
    "press_curves",
    "repeats",
]
