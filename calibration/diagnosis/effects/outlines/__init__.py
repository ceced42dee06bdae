"""Effects in photographs of beams: changes of the scene or of its image."""

from __future__ import annotations

from calibration.diagnosis.effects.outlines.material import (
    COMPRESSIBILITY,
    CREEP,
    DENSITY,
    STRAIN_STIFFENING,
)
from calibration.diagnosis.effects.outlines.rig import (
    CAMERA_ROLL,
    CLAMP_COMPLIANCE,
    CLAMP_GAP,
    CLAMP_TILT,
    FREE_LENGTH,
    GRAVITY_TILT,
    GRIP_LENGTH,
    GRIP_SQUEEZE,
    IMAGE_SCALE,
    LENS_DISTORTION,
)
from calibration.diagnosis.effects.outlines.simulator import (
    COARSE_MESH,
    LOCKING,
    NOT_AT_EQUILIBRIUM,
)
from calibration.diagnosis.effects.outlines.specimen import (
    ADDED_MASS,
    RADIUS,
    RESIDUAL_CURVATURE,
    SKIN,
    STIFFNESS_GRADIENT_AXIAL,
    STIFFNESS_GRADIENT_TRANSVERSE,
    TAPER,
    VOID,
)
from calibration.measurements.outlines._effect import OutlineEffect

EFFECTS: dict[str, OutlineEffect] = {
    e.name: e
    for e in (
        DENSITY,
        GRIP_LENGTH,
        CLAMP_COMPLIANCE,
        CLAMP_TILT,
        GRAVITY_TILT,
        CAMERA_ROLL,
        FREE_LENGTH,
        GRIP_SQUEEZE,
        RADIUS,
        TAPER,
        STIFFNESS_GRADIENT_AXIAL,
        STIFFNESS_GRADIENT_TRANSVERSE,
        RESIDUAL_CURVATURE,
        VOID,
        STRAIN_STIFFENING,
        COMPRESSIBILITY,
        CREEP,
        CLAMP_GAP,
        IMAGE_SCALE,
        LENS_DISTORTION,
        SKIN,
        ADDED_MASS,
        LOCKING,
        COARSE_MESH,
        NOT_AT_EQUILIBRIUM,
    )
}
