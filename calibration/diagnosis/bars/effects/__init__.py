"""The effects on bars that are let go. A new one is a file with an EFFECT, and its line here."""

from calibration.diagnosis.bars.effects import (
    added_mass,
    air_drag,
    camera_roll,
    clamp_compliance,
    clamp_sag,
    clock_rate,
    creep,
    density,
    gravity_tilt,
    grip_length,
    image_scale,
    load_height,
    radius,
    relaxation,
    residual_curvature,
    stiffness_gradient_axial,
    strain_stiffening,
)
from calibration.diagnosis.bars.effects._effect import BarEffect

_ALL = (
    clamp_compliance,
    clamp_sag,
    grip_length,
    gravity_tilt,
    creep,
    relaxation,
    air_drag,
    strain_stiffening,
    residual_curvature,
    stiffness_gradient_axial,
    density,
    radius,
    added_mass,
    load_height,
    image_scale,
    camera_roll,
    clock_rate,
)

EFFECTS: dict[str, BarEffect] = {module.EFFECT.name: module.EFFECT for module in _ALL}

__all__ = ["EFFECTS", "BarEffect"]
