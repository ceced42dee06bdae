"""Effects in indentation tests: changes of the scene, the depth or the force."""

from __future__ import annotations

from calibration.diagnosis.effects.indentation.rig import (
    DEPTH_OFFSET,
    FORCE_DRIFT,
    FORCE_GAIN,
    FORCE_OFFSET,
    FRICTION,
    ROD_ANGLE,
)
from calibration.diagnosis.effects.indentation.specimen import (
    ADHESION,
    INCLUSION_DEBONDED,
    INCLUSION_MISPLACED,
    MULLINS,
    RELAXATION,
    THICKNESS,
)
from calibration.measurements.indentation._effect import IndentationEffect

EFFECTS: dict[str, IndentationEffect] = {
    e.name: e
    for e in (
        FRICTION,
        ROD_ANGLE,
        DEPTH_OFFSET,
        FORCE_GAIN,
        FORCE_OFFSET,
        FORCE_DRIFT,
        RELAXATION,
        MULLINS,
        ADHESION,
        INCLUSION_DEBONDED,
        INCLUSION_MISPLACED,
        THICKNESS,
    )
}
