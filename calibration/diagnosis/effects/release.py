"""How each effect acts on a cantilever release: on the parameters of the reduced beam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import branches, stiffening
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.release._beam import BeamParameters, Pair
from calibration.measurements.release._effect import ReleaseEffect, hung
from calibration.measurements.release._record import reference_time
from tisim import Circle, Rectangle

# -- clamp-compliance --
# The clamp yields: it turns in proportion to the bending moment that it carries.


def _alter_clamp_compliance(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clamp_compliance=s.clamp_compliance + amplitude)


CLAMP_COMPLIANCE = ReleaseEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1e-05,
    bounds=(0.0, 1.0),
    prior_scale=0.2,
    alter=_alter_clamp_compliance,
    scopes=("load", "trial"),
)


# -- clamp-sag --
# The clamp yields: it sinks in proportion to the force that it carries.


def _alter_clamp_sag(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clamp_sag=s.clamp_sag + amplitude)


CLAMP_SAG = ReleaseEffect(
    effect=catalogue.CLAMP_SAG,
    step=1e-07,
    bounds=(0.0, 3e-3),
    prior_scale=5e-4,
    alter=_alter_clamp_sag,
    scopes=("load", "trial"),
)


# -- grip-length --
# The clamp holds deeper (positive) or shallower than its face: the beam is free that much inside.


def _alter_grip_length(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, grip_depth=s.grip_depth + amplitude)


GRIP_LENGTH = ReleaseEffect(
    effect=catalogue.GRIP_LENGTH,
    step=1e-06,
    bounds=(-1e-2, 1e-2),
    prior_scale=3e-3,
    alter=_alter_grip_length,
    scopes=("load", "trial"),
    action="clamp a metal bar and measure where the clamp holds it",
)


# -- gravity-tilt --
# The whole rig leans in the plane of the vibration: weights do not act as stated. Positive turns them to +x.


def _turned(v: Pair, angle: float) -> Pair:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return c * v[0] - s * v[1], s * v[0] + c * v[1]


def _alter_gravity_tilt(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, gravity=_turned(s.gravity, amplitude), tip_force=_turned(s.tip_force, amplitude))


GRAVITY_TILT = ReleaseEffect(
    effect=catalogue.GRAVITY_TILT,
    step=0.0001,
    bounds=(-0.4, 0.4),
    prior_scale=0.08,
    alter=_alter_gravity_tilt,
    scopes=("load", "trial"),
    action="level the rig, or hang a plumb line in view",
)


# -- creep --
# The material creeps: of its modulus at 1 s this fraction goes with each decade of time, from a millisecond
# to a quarter of an hour (two relaxation times a decade): the vibration loses energy by it too.


BRANCHES_A_DECADE = 2

CREEP_TIMES = tuple(
    10.0 ** (k / BRANCHES_A_DECADE) for k in range(-3 * BRANCHES_A_DECADE, 3 * BRANCHES_A_DECADE + 1)
)


def _creep_branches(amplitude: float, reference: float) -> float:
    """Each branch's fraction of the modulus in a vibration of angular frequency 1 / reference."""
    times = np.array(CREEP_TIMES)
    slow = (times / reference) ** 2
    sunk = float(np.sum(slow / (1.0 + slow) - np.exp(-1.0 / times)))  # from the vibration to 1 s
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
# The material has one more relaxation time: this fraction of the modulus before it goes with it.


def _relaxing_branch(amplitude: float, time: float, reference: float) -> float:
    """The branch's fraction of the modulus in a vibration of angular frequency 1 / reference."""
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


# -- air-drag --
# Something drags on the beam in proportion to its speed and mass (mass-proportional damping).


def _alter_air_drag(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, mass_damping=s.mass_damping + amplitude)


AIR_DRAG = ReleaseEffect(
    effect=catalogue.AIR_DRAG,
    step=0.0002,
    bounds=(0.0, 20.0),
    prior_scale=1.0,
    alter=_alter_air_drag,
    scopes=("load", "trial"),
)


# -- strain-stiffening --
# The material stiffens with strain (softens, where negative): W gets mu/2 a (I1 - 3)^2, in bending a term
# in the cube of the curvature.


def _alter_strain_stiffening(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, stiffening=s.stiffening + amplitude)


STRAIN_STIFFENING = ReleaseEffect(
    effect=catalogue.STRAIN_STIFFENING,
    step=0.001,
    bounds=(-6.0, 10.0),
    prior_scale=1.5,
    alter=_alter_strain_stiffening,
    action="hang a larger mass; pull a coupon to large strain",
    hands_on=stiffening,
)


# -- residual-curvature --
# Residual curvature from casting: free of stress the beam is an arc, upwards where positive.


def _alter_residual_curvature(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, curvature=s.curvature + amplitude)


RESIDUAL_CURVATURE = ReleaseEffect(
    effect=catalogue.RESIDUAL_CURVATURE,
    step=0.0001,
    bounds=(-2.0, 2.0),
    prior_scale=0.5,
    alter=_alter_residual_curvature,
    action="turn the beam by 180 degrees about its axis",
)


# -- stiffness-gradient-axial --
# The beam is stiffer towards its free end (positive) or its clamp.


def _alter_stiffness_gradient_axial(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, axial_gradient=s.axial_gradient + amplitude)


STIFFNESS_GRADIENT_AXIAL = ReleaseEffect(
    effect=catalogue.STIFFNESS_GRADIENT_AXIAL,
    step=0.001,
    bounds=(-8.0, 8.0),
    prior_scale=1.5,
    alter=_alter_stiffness_gradient_axial,
    action="swap the beam's ends",
)


# -- density --
# The beam weighs more or less than stated. Beside a hung mass that is known, its weight is identified.


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
# The section is larger (or smaller) than measured in all directions, by this fraction.


def _alter_section_scale(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    grown = 1.0 + amplitude
    if isinstance(s.section, Circle):
        return replace(s, section=Circle(radius=grown * s.section.radius))
    return replace(s, section=Rectangle(width=grown * s.section.width, height=grown * s.section.height))


SECTION_SCALE = ReleaseEffect(
    effect=catalogue.SECTION_SCALE,
    step=1e-05,
    bounds=(-0.2, 0.2),
    prior_scale=0.02,
    alter=_alter_section_scale,
)


# -- added-mass --
# More (or less) mass hangs on the free end than stated, with its weight and its inertia.


def _alter_added_mass(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    gx, gz = s.gravity
    fx, fz = s.tip_force
    return replace(s, tip_mass=s.tip_mass + amplitude, tip_force=(fx + amplitude * gx, fz + amplitude * gz))


ADDED_MASS = ReleaseEffect(
    effect=catalogue.ADDED_MASS,
    step=2e-06,
    bounds=(-2e-2, 4e-2),
    prior_scale=5e-3,
    alter=_alter_added_mass,
    scopes=("load", "trial"),
    action="weigh what hangs on the free end: markers, string and hook too",
)


# -- load-height --
# The hung mass acts above (or below) the middle of the end face: its arm changes as the face turns.


def _alter_load_height(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, load_height=s.load_height + amplitude)


LOAD_HEIGHT = ReleaseEffect(
    effect=catalogue.LOAD_HEIGHT,
    step=1e-05,
    bounds=(-5e-2, 5e-2),
    prior_scale=2e-2,
    alter=_alter_load_height,
    applies_to=hung,
    scopes=("load", "trial"),
)


# -- loose-load --
# The hung mass is tied loosely: its weight acts, but this part of its inertia does not move with the beam
# (on a string it swings behind).


def _alter_loose_load(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, tip_mass=(1.0 - amplitude) * s.tip_mass)


LOOSE_LOAD = ReleaseEffect(
    effect=catalogue.LOOSE_LOAD,
    step=1e-04,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),
    prior_scale=0.2,
    alter=_alter_loose_load,
    applies_to=hung,
    further=True,
    scopes=("load", "trial"),
)


# -- image-scale --
# The cameras show displacements too large (positive) or too small.


def _alter_image_scale(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, image_scale=s.image_scale + amplitude)


IMAGE_SCALE = ReleaseEffect(
    effect=catalogue.IMAGE_SCALE,
    step=1e-05,
    bounds=(-0.2, 0.2),
    prior_scale=0.01,
    alter=_alter_image_scale,
    scopes=("load", "trial"),
    action="move a marker by a known distance in view",
)


# -- camera-roll --
# The cameras' frame is turned about y against the beam's, in all trials alike.


def _alter_camera_roll(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, camera_roll=s.camera_roll + amplitude)


CAMERA_ROLL = ReleaseEffect(
    effect=catalogue.CAMERA_ROLL,
    step=1e-05,
    bounds=(-0.3, 0.3),
    prior_scale=0.04,
    alter=_alter_camera_roll,
    scopes=("load", "trial"),
    action="put a gauge along the beam in view",
)


# -- clock-rate --
# The cameras' clock is slow (positive: more time has passed than they say) or fast.


def _alter_clock_rate(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clock_rate=s.clock_rate + amplitude)


CLOCK_RATE = ReleaseEffect(
    effect=catalogue.CLOCK_RATE,
    step=1e-06,
    bounds=(-0.2, 0.2),
    prior_scale=0.002,
    alter=_alter_clock_rate,
    scopes=("load", "trial"),
)

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
        IMAGE_SCALE,
        CAMERA_ROLL,
        CLOCK_RATE,
    )
}
