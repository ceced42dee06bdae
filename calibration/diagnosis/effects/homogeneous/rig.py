"""Effects in homogeneous material tests: grips, platens, testing machine and order of tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._identifiable import compared_with_others
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import (
    goes_into_compression,
    goes_into_tension,
    slab_factor,
)

Array = NDArray[np.float64]

SCOPES = ("mode", "trial")

# -- strain-offset --
# Zero error of the strain: the specimen was slack, or preloaded, at the recorded stretch 1.


def _shift_strain_offset(s: Array, amplitude: float, record: Record) -> Array:
    del record
    return np.full(s.size, amplitude)


STRAIN_OFFSET = HomogeneousEffect(
    effect=catalogue.STRAIN_OFFSET,
    step=1e-4,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    shift=_shift_strain_offset,
    scopes=SCOPES,
)


# -- machine-compliance --
# Machine compliance: the recorded stretch includes a deflection of the rig proportional to the stress. A
# stiff frame has 0.001 to 0.02 strain/MPa. The bound is a deflection of MOST_OF_RIG of the specimen's length
# at the largest stress of the least stressed record, which would be visible.


MOST_OF_RIG = 0.25
MOST_COMPLIANT = 1e-5  # [1/Pa], if no record has a stress


def _bounds_machine_compliance(records: Sequence[Record]) -> tuple[float, float]:
    largest = [size for r in records if (size := float(np.abs(r.stress).max())) > 0.0]
    return 0.0, MOST_OF_RIG / min(largest) if largest else MOST_COMPLIANT


MACHINE_COMPLIANCE = HomogeneousEffect(
    effect=catalogue.MACHINE_COMPLIANCE,
    step=1e-9,
    bounds=(0.0, MOST_COMPLIANT),
    prior_scale=2e-8,
    bounds_in=_bounds_machine_compliance,
    yields=1.0,
    scopes=SCOPES,
)


# -- platen-friction --
# Platen friction in compression of a cylinder (slab method: the pressure grows exponentially inwards): the
# stress is multiplied by 2 (e^x - 1 - x) / x^2 with x = 3 a s^(-3/2), where a is the coefficient of friction
# times the diameter over three times the height at rest, and s the stretch; 1 + a s^(-3/2) for small a.


def _factor_platen_friction(s: Array, amplitude: float, record: Record) -> Array:
    del record
    whole = slab_factor(3.0 * amplitude * np.maximum(s, 1e-3) ** -1.5)
    return np.where(s < 1.0, whole, 1.0)


PLATEN_FRICTION = HomogeneousEffect(
    effect=catalogue.PLATEN_FRICTION,
    step=1e-3,
    bounds=(0.0, 1.0),
    prior_scale=0.2,
    factor=_factor_platen_friction,
    applies_to=lambda record: goes_into_compression(record.mode, record.stretch),
    scopes=SCOPES,
)


# -- gauge-length --
# The strain in tension is measured between the grips: the middle of the specimen stretches by this fraction
# more (less) than recorded, since the ends are wider (or slip).


def _shift_gauge_length(s: Array, amplitude: float, record: Record) -> Array:
    del s
    return np.asarray(np.where(record.stretch > 1.0, amplitude * (record.stretch - 1.0), 0.0))


GAUGE_LENGTH = HomogeneousEffect(
    effect=catalogue.GAUGE_LENGTH,
    step=1e-3,
    bounds=(-0.3, 0.5),
    prior_scale=0.1,
    shift=_shift_gauge_length,
    applies_to=lambda record: goes_into_tension(record.mode, record.stretch),
    identifiable=compared_with_others,
    further=True,
    scopes=("material", "trial"),
)


# -- set-between-tests --
# Permanent set under repeated loading: at the start of each test the specimen is shorter (in tension longer)
# by this fraction than before the previous one, while strain is still relative to the original length. The
# actual strain is therefore larger (smaller).


REPEATS = 3  # least number of equal tests: with two, one outlier would look like a trend


def _shift_set_between_tests(s: Array, amplitude: float, record: Record) -> Array:
    sign = np.where(record.stretch < 1.0, -1.0, 1.0)
    return np.asarray((s - 1.0) * (1.0 / (1.0 + sign * amplitude * record.earlier) - 1.0))


def _repeated(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if a test that the candidate reaches is a repeat, of at least `REPEATS` equal tests."""
    del everything
    return any(r.alike >= REPEATS and r.earlier > 0 for r in reached)


SET_BETWEEN_TESTS = HomogeneousEffect(
    effect=catalogue.SET_BETWEEN_TESTS,
    step=1e-5,
    bounds=(0.0, 0.05),
    prior_scale=5e-3,
    shift=_shift_set_between_tests,
    identifiable=_repeated,
    further=True,
)


# -- test-order --
# The stress changes by the same fraction of the first test from each test to the next, at all strains:
# healing, drying or wear between the tests, or drift of the load cell.


def _factor_test_order(s: Array, amplitude: float, record: Record) -> Array:
    return np.full(s.shape, 1.0 + amplitude * record.earlier)


TEST_ORDER = HomogeneousEffect(
    effect=catalogue.TEST_ORDER,
    step=1e-4,
    bounds=(-0.15, 0.3),
    prior_scale=0.01,
    factor=_factor_test_order,
    identifiable=_repeated,
    further=True,
)
