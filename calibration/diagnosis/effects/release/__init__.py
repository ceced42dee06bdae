"""Effects in cantilever release tests: changes of the parameters of the reduced beam model."""

from __future__ import annotations

from calibration.diagnosis.effects.release.material import (
    CREEP,
    DENSITY,
    RELAXATION,
    RESIDUAL_CURVATURE,
    SECTION_SCALE,
    STIFFNESS_GRADIENT_AXIAL,
    STRAIN_STIFFENING,
)
from calibration.diagnosis.effects.release.rig import (
    ADDED_MASS,
    AIR_DRAG,
    CAMERA_ROLL,
    CLAMP_COMPLIANCE,
    CLAMP_SAG,
    CLOCK_RATE,
    GRAVITY_TILT,
    GRIP_LENGTH,
    HELD_POSE,
    IMAGE_SCALE,
    LOAD_HEIGHT,
    LOOSE_LOAD,
    RUBBING_LOAD,
)
from calibration.measurements.release._effect import ReleaseEffect

EFFECTS: dict[str, ReleaseEffect] = {
    e.name: e
    for e in (
        CLAMP_COMPLIANCE,
        CLAMP_SAG,
        GRIP_LENGTH,
        GRAVITY_TILT,
        CREEP,
        RELAXATION,
        AIR_DRAG,
        STRAIN_STIFFENING,
        RESIDUAL_CURVATURE,
        STIFFNESS_GRADIENT_AXIAL,
        DENSITY,
        SECTION_SCALE,
        ADDED_MASS,
        LOAD_HEIGHT,
        LOOSE_LOAD,
        RUBBING_LOAD,
        HELD_POSE,
        IMAGE_SCALE,
        CAMERA_ROLL,
        CLOCK_RATE,
    )
}
