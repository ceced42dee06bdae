"""Effects in homogeneous material tests: changes of the stretch or of the stress."""

from __future__ import annotations

from calibration.diagnosis.effects.homogeneous.energy import (
    ANISOTROPY,
    LAW_FORM,
    LIMITED_EXTENSIBILITY,
    SECOND_INVARIANT,
    STRAIN_STIFFENING,
    TENSION_COMPRESSION_ASYMMETRY,
)
from calibration.diagnosis.effects.homogeneous.history import (
    HYSTERESIS,
    MULLINS,
    PERMANENT_SET,
    RATE_DEPENDENCE,
    RELAXATION,
)
from calibration.diagnosis.effects.homogeneous.rig import (
    GAUGE_LENGTH,
    MACHINE_COMPLIANCE,
    PLATEN_FRICTION,
    SET_BETWEEN_TESTS,
    STRAIN_OFFSET,
    TEST_ORDER,
)
from calibration.measurements.homogeneous._effect import HomogeneousEffect

EFFECTS: dict[str, HomogeneousEffect] = {
    e.name: e
    for e in (
        RATE_DEPENDENCE,
        HYSTERESIS,
        MULLINS,
        ANISOTROPY,
        STRAIN_OFFSET,
        MACHINE_COMPLIANCE,
        PLATEN_FRICTION,
        STRAIN_STIFFENING,
        SECOND_INVARIANT,
        LIMITED_EXTENSIBILITY,
        LAW_FORM,
        SET_BETWEEN_TESTS,
        TEST_ORDER,
        TENSION_COMPRESSION_ASYMMETRY,
        PERMANENT_SET,
        RELAXATION,
        GAUGE_LENGTH,
    )
}
