"""Effects in cantilever release tests: material and beam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import branches, stiffening
from calibration.measurements._effect import HandedOn, Occurrence, added_to
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release._effect import ReleaseEffect
from calibration.measurements.release._record import reference_time

# -- creep --
# Creep: the relaxation modulus falls by this fraction of its value at 1 s per decade of time, from 1 ms to
# 1000 s (two relaxation times per decade); it damps the vibration as well.


BRANCHES_A_DECADE = 2

CREEP_TIMES = tuple(
    10.0 ** (k / BRANCHES_A_DECADE) for k in range(-3 * BRANCHES_A_DECADE, 3 * BRANCHES_A_DECADE + 1)
)


def _creep_branches(amplitude: float, reference: float) -> float:
    """Fraction of each branch, relative to the storage modulus at the frequency 1 / `reference` [rad/s]."""
    times = np.array(CREEP_TIMES)
    slow = (times / reference) ** 2
    sunk = float(np.sum(slow / (1.0 + slow) - np.exp(-1.0 / times)))  # loss from the vibration's time to 1 s
    return amplitude / (BRANCHES_A_DECADE + amplitude * sunk)


def _alter_creep(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    if amplitude == 0.0:
        return s
    one = _creep_branches(amplitude, s.reference_time)
    return replace(s, branches=s.branches + tuple((one, t) for t in CREEP_TIMES))


def _viscosity_creep(found: Occurrence) -> HandedOn:
    reference = reference_time(found.records)
    one = _creep_branches(found.amplitude, reference)
    return branches(
        np.full(len(CREEP_TIMES), one),
        np.array(CREEP_TIMES),
        reference=reference,
        first=reference,
        last=max(float(np.ptp(r.time)) for r in found.records),
    )


CREEP = ReleaseEffect(
    effect=catalogue.CREEP,
    step=1e-05,
    bounds=(0.0, 0.25),
    prior_scale=0.1,
    alter=_alter_creep,
    action="record ten times as long",
    hands_on=_viscosity_creep,
)


# -- relaxation --
# One further relaxation time, with this fraction of the modulus at times much shorter than it.


def _relaxing_branch(amplitude: float, time: float, reference: float) -> float:
    """Fraction of the branch, relative to the storage modulus at the frequency 1 / `reference` [rad/s]."""
    return amplitude / (1.0 - amplitude / (1.0 + (time / reference) ** 2))


def _alter_relaxation(s: BeamParameters, amplitude: float, time: float | None) -> BeamParameters:
    assert time is not None
    if amplitude == 0.0:
        return s
    return replace(s, branches=(*s.branches, (_relaxing_branch(amplitude, time, s.reference_time), time)))


def _viscosity_relaxation(found: Occurrence) -> HandedOn:
    assert found.variant is not None
    last = max(float(np.ptp(r.time)) for r in found.records)
    reference = reference_time(found.records)
    one = _relaxing_branch(found.amplitude, found.variant, reference)
    return branches(
        np.array([one]), np.array([found.variant]), reference=reference, first=reference, last=last
    )


RELAXATION = ReleaseEffect(
    effect=catalogue.RELAXATION,
    step=1e-05,
    bounds=(0.0, 0.8),
    prior_scale=0.2,
    alter=_alter_relaxation,
    variants=lambda _: (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0),
    variant_label=lambda time: f"relaxation time {time:g} s",
    action="release it with other masses, so that it vibrates at other frequencies",
    hands_on=_viscosity_relaxation,
)


# -- strain-stiffening --
# Strain stiffening (softening if negative): W has an additional term mu/2 a (I1 - 3)^2, which in bending is a
# moment proportional to the cube of the curvature.


STRAIN_STIFFENING = ReleaseEffect(
    effect=catalogue.STRAIN_STIFFENING,
    step=0.001,
    bounds=(-6.0, 10.0),
    prior_scale=1.5,
    alter=added_to(BeamParameters, "stiffening"),
    action="hang a larger mass; pull a coupon to large strain",
    hands_on=stiffening,
)


# -- residual-curvature --
# Residual curvature from casting: the stress-free beam is an arc, curved upwards if positive.


RESIDUAL_CURVATURE = ReleaseEffect(
    effect=catalogue.RESIDUAL_CURVATURE,
    step=0.0001,
    bounds=(-2.0, 2.0),
    prior_scale=0.5,
    alter=added_to(BeamParameters, "curvature"),
    action="turn the beam by 180 degrees about its axis",
)


# -- stiffness-gradient-axial --
# Axial stiffness gradient: the beam is stiffer towards its free end (positive) or its clamp (negative).


STIFFNESS_GRADIENT_AXIAL = ReleaseEffect(
    effect=catalogue.STIFFNESS_GRADIENT_AXIAL,
    step=0.001,
    bounds=(-8.0, 8.0),
    prior_scale=1.5,
    alter=added_to(BeamParameters, "axial_gradient"),
    action="swap the beam's ends",
)


# -- density --
# The density differs from the stated one by this fraction. A known hung mass makes the beam's weight
# identifiable.


def _alter_density(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, density=s.density * (1.0 + amplitude))


DENSITY = ReleaseEffect(
    effect=catalogue.DENSITY,
    step=1e-05,
    bounds=(-0.3, 0.3),
    prior_scale=0.05,
    alter=_alter_density,
)


# -- section-scale --
# The section's dimensions are larger (positive) or smaller than measured by this fraction.


def _alter_section_scale(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, section=s.section.scaled(1.0 + amplitude))


SECTION_SCALE = ReleaseEffect(
    effect=catalogue.SECTION_SCALE,
    step=1e-05,
    bounds=(-0.2, 0.2),
    prior_scale=0.02,
    alter=_alter_section_scale,
)
