"""Uniaxial compression tests of cylinders: identification of material and platen conditions from force."""

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
