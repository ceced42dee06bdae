"""Effects in uniaxial compression of cylinders: those of homogeneous tests, platens and load cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects import homogeneous
from calibration.measurements.compression._bonded import USUAL
from calibration.measurements.compression._effect import CompressionEffect
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

SCOPES = ("mode", "trial")

# -- platen-bonding --
# The end faces are restrained by the platens: the force is that of a cylinder with free platens times the
# bonded-to-free force ratio to the power of the amplitude; both are simulated (`tisim.Press`). Amplitude 0 is
# free sliding, 1 is bonded.
#
# Values in between approximate Coulomb friction: at small strain the slipping ring does not grow with the
# load, since pressure and shear are proportional, so that the amplitude is nearly constant along a record.


MOST_BONDED = (
    1.1  # slightly above 1: bonded platens are then not at a bound, and simulated stresses have an error
)

PLATEN_BONDING = CompressionEffect(
    effect=catalogue.PLATEN_BONDING,
    step=1e-3,
    bounds=(0.0, MOST_BONDED),
    physical_limits=(MOST_BONDED,),
    prior_scale=0.5,
    bonds=True,
    scopes=SCOPES,
)


# -- platen-slip --
# Coulomb friction: if the whole end face slips, the pressure grows exponentially inwards (slab method); if
# friction suffices, the face sticks. The logarithm l of the force relative to free platens interpolates
# between the two, l = l_stuck (1 - exp(-l_slip / l_stuck)).


PLATEN_SLIP = CompressionEffect(
    effect=catalogue.PLATEN_SLIP,
    step=1e-3,
    bounds=(0.0, 2.0),
    physical_limits=(2.0,),  # no slip from here on
    prior_scale=0.3,
    rubs=True,
    further=True,
    scopes=SCOPES,
)


# -- platen-tilt --
# An end face and its platen are not parallel: one edge touches first, the rest of the face later. Columns of
# the cylinder are compressed independently, each from its own contact on (Winkler foundation): shear between
# neighbouring columns is neglected.


PLATEN_TILT = CompressionEffect(
    effect=catalogue.PLATEN_TILT,
    step=1e-3,
    bounds=(0.0, 0.1),
    prior_scale=0.03,
    tilts=True,
    scopes=SCOPES,
)


# -- stress-offset --
# Constant zero error of the load cell in a record: the measured stress is too high by the amplitude [Pa].


def _reads_stress_offset(stress: Array, amplitude: float) -> Array:
    return stress + amplitude


STRESS_OFFSET = CompressionEffect(
    effect=catalogue.STRESS_OFFSET,
    step=1.0,
    bounds=(-2e4, 2e4),
    prior_scale=500.0,
    reads=_reads_stress_offset,
    scopes=SCOPES,
)


# -- force-gain --
# Gain error of the load cell. One load cell measures all records, and a gain common to all records is an
# alias of the modulus.


def _reads_force_gain(stress: Array, amplitude: float) -> Array:
    return (1.0 + amplitude) * stress


FORCE_GAIN = CompressionEffect(
    effect=catalogue.FORCE_GAIN,
    step=1e-3,
    bounds=(-0.6, 0.6),
    prior_scale=0.1,
    reads=_reads_force_gain,
    scopes=(),
)


# -- machine-compliance --
# As in homogeneous tests, but with bounds from the height of a standard cylinder. A load cell deflects by
# 0.05 to 0.5 mm at its rated load; with the frame and fixtures of a light bench the total is about 1 mm.


MOST_OF_RIG = 1.5e-3  # largest displacement of the rig [m], at the largest stress


def _bounds_machine_compliance(records: Sequence[Record]) -> tuple[float, float]:
    largest = max(float(np.abs(r.stress).max()) for r in records)
    return 0.0, MOST_OF_RIG / USUAL.height / largest


MACHINE_COMPLIANCE = replace(homogeneous.MACHINE_COMPLIANCE, bounds_in=_bounds_machine_compliance)

EFFECTS: dict[str, HomogeneousEffect] = {
    # bonding is simulated here instead of friction; repeats of one sample are compressed along one axis
    **{n: e for n, e in homogeneous.EFFECTS.items() if n != catalogue.PLATEN_FRICTION.name},
    catalogue.ANISOTROPY.name: replace(homogeneous.ANISOTROPY, scopes=("material", "specimen")),
    catalogue.MACHINE_COMPLIANCE.name: MACHINE_COMPLIANCE,
    **{e.name: e for e in (PLATEN_BONDING, PLATEN_SLIP, PLATEN_TILT, STRESS_OFFSET, FORCE_GAIN)},
}
