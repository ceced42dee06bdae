"""Uniaxial compression tests of cylinders: identification of material and platen conditions from force."""

from calibration.measurements.compression.curves import SHAPES, Cylinder, Platens, PressCurves, press_curves

__all__ = [
    "SHAPES",
    "Cylinder",
    "Platens",
    "PressCurves",
    "press_curves",
]
