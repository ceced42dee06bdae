"""How effects act on homogeneous material tests: grips, platens, the machine, and the order of tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects.homogeneous._pressed import PRESSED
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import slab_factor

Array = NDArray[np.float64]

# -- strain-offset --
# The zero of the strain is off: the specimen was slack, or preloaded, when its stretch was called 1.


def _shift_strain_offset(s: Array, amplitude: float, record: Record) -> Array:
    del record
    return np.full(s.size, amplitude)


STRAIN_OFFSET = HomogeneousEffect(
    effect=catalogue.STRAIN_OFFSET,
    step=1e-4,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    shift=_shift_strain_offset,
    scopes=("mode", "trial"),
)


# -- machine-compliance --
# The rig gives way: part of the stretch that is written down is its own, in proportion to the stress. A stiff
# frame gives way by 0.001 to 0.02 strains/MPa; one that takes MOST_OF_RIG of the specimen's length at the
# largest stress would be seen to.


MOST_OF_RIG = 0.25


def _bounds_machine_compliance(records: Sequence[Record]) -> tuple[float, float]:
    largest = min(float(np.abs(r.stress).max()) for r in records)
    return 0.0, MOST_OF_RIG / largest


MACHINE_COMPLIANCE = HomogeneousEffect(
    effect=catalogue.MACHINE_COMPLIANCE,
    step=1e-9,
    bounds=(0.0, 1e-5),
    prior_scale=2e-8,
    bounds_in=_bounds_machine_compliance,
    yields=1.0,
    scopes=("mode", "trial"),
)


# -- platen-friction --
# Platens hold a compressed cylinder by friction (slab method: the pressure grows exponentially inwards):
# its stress is 2 (e^x - 1 - x) / x^2 times higher with x = 3 a s^(-3/2), where a is the coefficient of
# friction times diameter over three times the height at rest, and s the stretch. For small a that is 1 + a
# s^(-3/2).


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
    applies_to=lambda record: record.mode == "uniaxial" and bool(record.stretch.min() < PRESSED),
    scopes=("mode", "trial"),
)


# -- gauge-length --
# The strain of a pulled strip is taken from its grips: ends that are wider, or that slip, stretch less
# (more), and its middle stretches by this part more (less) than the record says.


def _shift_gauge_length(s: Array, amplitude: float, record: Record) -> Array:
    del s
    return np.asarray(np.where(record.stretch > 1.0, amplitude * (record.stretch - 1.0), 0.0))


def _compared(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some other record of the same material."""
    return any(r.material == q.material and r not in reached for q in reached for r in everything)


GAUGE_LENGTH = HomogeneousEffect(
    effect=catalogue.GAUGE_LENGTH,
    step=1e-3,
    bounds=(-0.3, 0.5),
    prior_scale=0.1,
    shift=_shift_gauge_length,
    applies_to=lambda record: record.mode == "uniaxial" and bool(record.stretch.max() > 2.0 - PRESSED),
    identifiable=_compared,
    further=True,
    scopes=("material", "trial"),
)


# -- set-between-tests --
# What is loaded again and again keeps part of its strain: it starts each test shorter (longer, where it was
# pulled) by this part than the test before, while its strain is still counted from the first length. Its own
# strain is the larger (smaller) one.


REPEATS = 3  # tests alike: with two, one that is odd would look like what goes on from test to test


def _shift_set_between_tests(s: Array, amplitude: float, record: Record) -> Array:
    sign = np.where(record.stretch < 1.0, -1.0, 1.0)
    return np.asarray((s - 1.0) * (1.0 / (1.0 + sign * amplitude * record.earlier) - 1.0))


def _repeated(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some test that was repeated often enough."""
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
# The stress grows, or falls, by the same part from each test to the next at all strains: what heals, dries or
# wears between them, or a load cell that wanders.


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
