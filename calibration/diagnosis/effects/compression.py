"""How each effect acts on compressed cylinders: those of homogeneous tests, of platens and of load cells."""

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

# -- platen-bonding --
# The platens hold the end faces: the force is that of a free cylinder times (bonded over free) to the power
# of the amplitude, both simulated (`tisim.Press`), so that 0 slides freely and 1 sticks all over.
#
# Between the two this stands in for Coulomb friction: at small strain the ring that slips does not grow
# with the load, since pressure and shear grow together, so that the amplitude is nearly constant along a
# record.


MOST_BONDED = (
    1.1  # a little beyond bonded: what is bonded is not at a bound, and simulated stresses have an error
)

PLATEN_BONDING = CompressionEffect(
    effect=catalogue.PLATEN_BONDING,
    step=1e-3,
    bounds=(0.0, MOST_BONDED),
    physical_limits=(MOST_BONDED,),
    prior_scale=0.5,
    bonds=True,
    scopes=("mode", "trial"),
)


# -- platen-slip --
# Coulomb friction: where all of an end face slips, the pressure grows exponentially inwards (slab method);
# where friction is enough to hold, the face sticks. The logarithm of the force over a free cylinder's goes
# over from the one to the other, l = l_stuck (1 - exp(-l_slip / l_stuck)).


PLATEN_SLIP = CompressionEffect(
    effect=catalogue.PLATEN_SLIP,
    step=1e-3,
    bounds=(0.0, 2.0),
    physical_limits=(2.0,),  # nothing slips any more
    prior_scale=0.3,
    rubs=True,
    further=True,
    scopes=("mode", "trial"),
)


# -- platen-tilt --
# An end face and its platen are not parallel: one edge touches first, the rest of the face later. Columns
# of the cylinder are pressed side by side, each from where the platen meets it: a foundation of springs,
# which leaves out that neighbours hold each other.


PLATEN_TILT = CompressionEffect(
    effect=catalogue.PLATEN_TILT,
    step=1e-3,
    bounds=(0.0, 0.1),
    prior_scale=0.03,
    tilts=True,
    scopes=("mode", "trial"),
)


# -- stress-offset --
# The zero of the load cell is off, by the same all through a record: the stress that is read is too high by
# the amplitude [Pa].


def _reads_stress_offset(stress: Array, amplitude: float) -> Array:
    return stress + amplitude


STRESS_OFFSET = CompressionEffect(
    effect=catalogue.STRESS_OFFSET,
    step=1.0,
    bounds=(-2e4, 2e4),
    prior_scale=500.0,
    reads=_reads_stress_offset,
    scopes=("mode", "trial"),
)


# -- force-gain --
# The load cell shows a multiple of the force: in all records alike nothing separates this from the modulus.
# One load cell reads all records.


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
# As in homogeneous tests; but the height of a cylinder is known, and with it how far a rig would move. A load
# cell gives way by a twentieth to half a millimetre at the load that it is made for; with the frame and the
# fixtures of a light bench that is a millimetre or so.


MOST_OF_RIG = 1.5e-3  # [m] at the largest load


def _bounds_machine_compliance(records: Sequence[Record]) -> tuple[float, float]:
    largest = max(float(np.abs(r.stress).max()) for r in records)
    return 0.0, MOST_OF_RIG / USUAL.height / largest


MACHINE_COMPLIANCE = replace(homogeneous.MACHINE_COMPLIANCE, bounds_in=_bounds_machine_compliance)

EFFECTS: dict[str, HomogeneousEffect] = {
    # platens that hold are simulated here; and repeats of one sample are compressed along one axis
    **{n: e for n, e in homogeneous.EFFECTS.items() if n != catalogue.PLATEN_FRICTION.name},
    catalogue.ANISOTROPY.name: replace(homogeneous.ANISOTROPY, scopes=("material", "specimen")),
    catalogue.MACHINE_COMPLIANCE.name: MACHINE_COMPLIANCE,
    **{e.name: e for e in (PLATEN_BONDING, PLATEN_SLIP, PLATEN_TILT, STRESS_OFFSET, FORCE_GAIN)},
}
