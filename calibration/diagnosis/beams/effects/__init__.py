"""The effects on photographed beams. A new one is a file with an EFFECT, and its line here."""

from calibration.diagnosis.beams.effects import (
    added_mass,
    camera_roll,
    clamp_compliance,
    clamp_gap,
    clamp_tilt,
    coarse_mesh,
    compressibility,
    creep,
    density,
    free_length,
    gravity_tilt,
    grip_length,
    grip_squeeze,
    image_scale,
    lens_distortion,
    locking,
    not_at_equilibrium,
    radius,
    residual_curvature,
    skin,
    stiffness_gradient_axial,
    stiffness_gradient_transverse,
    strain_stiffening,
    taper,
    void,
)
from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation

_ALL = (
    density,
    grip_length,
    clamp_compliance,
    clamp_tilt,
    gravity_tilt,
    camera_roll,
    free_length,
    grip_squeeze,
    radius,
    taper,
    stiffness_gradient_axial,
    stiffness_gradient_transverse,
    residual_curvature,
    void,
    strain_stiffening,
    compressibility,
    creep,
    clamp_gap,
    image_scale,
    lens_distortion,
    skin,
    added_mass,
    locking,
    coarse_mesh,
    not_at_equilibrium,
)

EFFECTS: dict[str, BeamEffect] = {module.EFFECT.name: module.EFFECT for module in _ALL}

__all__ = ["EFFECTS", "BeamEffect", "Situation"]
