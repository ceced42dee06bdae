"""How each effect acts on photographed beams: on the scene, or on its picture."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import stiffening, viscosity_of
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.outlines import COARSE
from calibration.measurements.outlines._effect import (
    OutlineEffect,
    Situation,
    bridge,
    cantilever,
    with_moduli,
)
from tisim import Beam, Circle, Void, laws

Array = NDArray[np.float64]

# -- density --
# The specimen weighs more or less than the lab says: stiffness and weight enter by their ratio alone.


def _bend_density(beam: Beam, amplitude: float, _: Situation) -> Beam:
    heavier = beam.material.density * (1.0 + amplitude)
    return replace(beam, material=replace(beam.material, density=heavier))


DENSITY = OutlineEffect(
    effect=catalogue.DENSITY,
    # the opposite of the baseline's own step in ln G: the two are one, and so must their differences be
    step=-0.003,
    bounds=(-0.3, 0.3),
    prior_scale=0.05,
    bend=_bend_density,
)


# -- grip-length --
# The grips hold deeper (positive) or shallower than their faces: the material is free that much inside.


def _bend_grip_length(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    ends = 2.0 if situation.trial.supports == "clamped-clamped" else 1.0
    return replace(beam, length=beam.length + ends * amplitude)


def _image_grip_length(points: Array, amplitude: float, _: Situation) -> Array:
    # the scene's x = 0 is where the material gets free, behind the face that the picture's x = 0 is
    return points - np.array([amplitude, 0.0])


GRIP_LENGTH = OutlineEffect(
    effect=catalogue.GRIP_LENGTH,
    step=1e-4,
    bounds=(-5e-3, 8e-3),
    prior_scale=3e-3,
    bend=_bend_grip_length,
    image=_image_grip_length,
)


# -- clamp-compliance --
# The clamps yield: they turn in proportion to the bending moment that they carry.


def _bend_clamp_compliance(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(
            beam.clamp_imperfections, compliance=beam.clamp_imperfections.compliance + amplitude
        ),
    )


CLAMP_COMPLIANCE = OutlineEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1.0,
    bounds=(0.0, 20.0),
    prior_scale=8.0,
    bend=_bend_clamp_compliance,
)


# -- clamp-tilt --
# The clamp is mounted askew: its face is turned, the beam leaves it upwards (positive) or downwards.


def _bend_clamp_tilt(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(beam.clamp_imperfections, tilt=beam.clamp_imperfections.tilt + amplitude),
    )


CLAMP_TILT = OutlineEffect(
    effect=catalogue.CLAMP_TILT,
    step=5e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.05,
    bend=_bend_clamp_tilt,
)


# -- gravity-tilt --
# The whole rig leans in the plane of the picture: gravity is not along -z. Positive turns it towards +x.


def _bend_gravity_tilt(beam: Beam, amplitude: float, _: Situation) -> Beam:
    x, y, z = beam.gravity
    c, s = float(np.cos(amplitude)), float(np.sin(amplitude))
    return replace(beam, gravity=(c * x - s * z, y, s * x + c * z))


GRAVITY_TILT = OutlineEffect(
    effect=catalogue.GRAVITY_TILT,
    step=1e-2,
    bounds=(-0.2, 0.2),
    prior_scale=0.08,
    bend=_bend_gravity_tilt,
)


# -- camera-roll --
# The camera is rolled against the rig's horizontal, in all photographs alike: positive lifts large x.


def _image_camera_roll(points: Array, amplitude: float, _: Situation) -> Array:
    c, s = np.cos(amplitude), np.sin(amplitude)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


CAMERA_ROLL = OutlineEffect(
    effect=catalogue.CAMERA_ROLL,
    step=3e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    image=_image_camera_roll,
    scopes=(),
)


# -- free-length --
# A cantilever has slipped out of its grip: its free length is longer (positive) than measured.


def _bend_free_length(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, length=beam.length + amplitude)


FREE_LENGTH = OutlineEffect(
    effect=catalogue.FREE_LENGTH,
    step=5e-4,
    bounds=(-8e-3, 8e-3),
    prior_scale=2e-3,
    bend=_bend_free_length,
    applies_to=cantilever,
)


# -- grip-squeeze --
# The grip squeezes the section that it holds: lower by this part, and wider by the same.


def _bend_grip_squeeze(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(
            beam.clamp_imperfections, squeeze=beam.clamp_imperfections.squeeze + amplitude
        ),
    )


GRIP_SQUEEZE = OutlineEffect(
    effect=catalogue.GRIP_SQUEEZE,
    step=0.02,
    bounds=(0.0, 0.25),
    prior_scale=0.1,
    bend=_bend_grip_squeeze,
)


# -- radius --
# The section is larger (positive) or smaller than stated, all along the beam; swelling looks the same.


def _bend_radius(beam: Beam, amplitude: float, _: Situation) -> Beam:
    if isinstance(beam.section, Circle):
        return replace(beam, section=Circle(radius=beam.section.radius + amplitude))
    s = beam.section
    return replace(
        beam, section=replace(s, width=s.width + 2.0 * amplitude, height=s.height + 2.0 * amplitude)
    )


RADIUS = OutlineEffect(
    effect=catalogue.RADIUS,
    step=5e-5,
    bounds=(-2e-3, 2e-3),
    prior_scale=5e-4,
    bend=_bend_radius,
)


# -- taper --
# The section grows (positive) or shrinks along the beam, linearly, about the middle of its free length.


def _bend_taper(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam, imperfections=replace(beam.imperfections, taper=beam.imperfections.taper + amplitude)
    )


TAPER = OutlineEffect(
    effect=catalogue.TAPER,
    step=0.1,
    bounds=(-1.5, 1.5),
    prior_scale=0.5,
    bend=_bend_taper,
)


# -- stiffness-gradient-axial --
# The modulus changes linearly along the beam (a mixture that settled), about its free length's middle.


def _bend_stiffness_gradient_axial(beam: Beam, amplitude: float, _: Situation) -> Beam:
    grown = beam.imperfections.axial_gradient + amplitude
    return replace(beam, imperfections=replace(beam.imperfections, axial_gradient=grown))


STIFFNESS_GRADIENT_AXIAL = OutlineEffect(
    effect=catalogue.STIFFNESS_GRADIENT_AXIAL,
    step=0.5,
    bounds=(-9.0, 9.0),
    prior_scale=4.0,
    bend=_bend_stiffness_gradient_axial,
)


# -- stiffness-gradient-transverse --
# The modulus changes linearly from the lower to the upper side (a filler that settled while curing).


def _bend_stiffness_gradient_transverse(beam: Beam, amplitude: float, _: Situation) -> Beam:
    grown = beam.imperfections.transverse_gradient + amplitude
    return replace(beam, imperfections=replace(beam.imperfections, transverse_gradient=grown))


STIFFNESS_GRADIENT_TRANSVERSE = OutlineEffect(
    effect=catalogue.STIFFNESS_GRADIENT_TRANSVERSE,
    step=2.0,
    bounds=(-80.0, 80.0),
    prior_scale=40.0,
    bend=_bend_stiffness_gradient_transverse,
)


# -- residual-curvature --
# The beam was bent in its mould: free of stress it is an arc, upwards where positive.


def _bend_residual_curvature(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam, imperfections=replace(beam.imperfections, curvature=beam.imperfections.curvature + amplitude)
    )


RESIDUAL_CURVATURE = OutlineEffect(
    effect=catalogue.RESIDUAL_CURVATURE,
    step=0.1,
    bounds=(-4.0, 4.0),
    prior_scale=1.0,
    bend=_bend_residual_curvature,
)


# -- void --
# A bubble or a cut: over 15 mm of one beam part of its bending stiffness, and of its weight, is missing.
#
# The amplitude is that of a void with sharp ends. `tisim.Void` sets in over `edge`, since a mesh cannot
# follow a jump; both bend the beam by the same angle where the flexibility that they add along it, the
# integral of 1 / (1 - loss) - 1, is the same. That of a loss f over the length L is L f / (1 - f); that of
# one of peak p, half a cosine over E at either end, is (L - E) (w^2 - 1) + 2 E (w - 1) with w = 1 / sqrt(1
# - p).


def hole(loss: float, *, position: float) -> Void:
    """The void that bends a beam as much as a loss with sharp ends."""
    flat = Void(position=position, fraction=0.0)
    length, edge = flat.length, flat.edge
    core = length - edge
    w = (sqrt(edge**2 + core * (length + edge + length * loss / (1.0 - loss))) - edge) / core
    return replace(flat, fraction=1.0 - w**-2.0)


def _bend_void(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    assert situation.position is not None, "a void sits somewhere"
    void = hole(amplitude, position=situation.position * situation.trial.free_length)
    return replace(beam, imperfections=replace(beam.imperfections, void=void))


VOID = OutlineEffect(
    effect=catalogue.VOID,
    step=0.1,
    bounds=(0.0, 0.9),
    prior_scale=0.5,
    bend=_bend_void,
    positions=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7),
    scopes=("material", "trial"),  # one beam's, or its batch's
    in_all=False,
)


# -- strain-stiffening --
# The material stiffens with strain: W gets a term mu/2 a (I1bar - 3)^2 beside the baseline's.


def _bend_strain_stiffening(beam: Beam, amplitude: float, _: Situation) -> Beam:
    known = beam.material.parameters["stiffening"]  # the baseline's law has it, at zero
    assert isinstance(known, float)
    parameters = {**beam.material.parameters, "stiffening": known + amplitude}
    return replace(beam, material=replace(beam.material, parameters=parameters))


STRAIN_STIFFENING = OutlineEffect(
    effect=catalogue.STRAIN_STIFFENING,
    step=0.1,
    bounds=(0.0, 4.0),
    prior_scale=1.5,
    bend=_bend_strain_stiffening,
    hands_on=stiffening,
)


# -- compressibility --
# The material gives way in volume: Poisson's ratio is lower than the baseline's by this much.


def _bend_compressibility(beam: Beam, amplitude: float, _: Situation) -> Beam:
    moduli = laws.get(beam.material.law).moduli(beam.material.parameters)
    g, k = moduli.shear_modulus, moduli.bulk_modulus
    nu = (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g) - amplitude
    bulk = 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
    return replace(beam, material=with_moduli(beam.material, shear=g, bulk=bulk))


COMPRESSIBILITY = OutlineEffect(
    effect=catalogue.COMPRESSIBILITY,
    step=0.03,
    bounds=(0.0, 0.3),
    prior_scale=0.05,
    bend=_bend_compressibility,
)


# -- creep --
# The material creeps: its modulus falls by this part with each decade of time since release, from 1 s.


def _bend_creep(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    moduli = laws.get(beam.material.law).moduli(beam.material.parameters)
    part = 1.0 - amplitude * float(np.log10(situation.time))
    softer = with_moduli(beam.material, shear=part * moduli.shear_modulus, bulk=part * moduli.bulk_modulus)
    return replace(beam, material=softer)


def _viscosity_creep(found: Occurrence) -> HandedOn:
    """The modulus at each time taken for the relaxation function there: under a constant load the difference
    is a fraction of (pi c / 2.3)^2 / 6 of it, for a fraction c a decade (0.3 % for 10 %)."""
    times = [r.time for r in found.records if r.time > 0.0]
    first, last = min(times), max(times)
    if not last > first:
        return HandedOn(field="viscosity", part=None, remarks=("no relaxation spectrum: one time only",))
    if found.amplitude < 0.0:
        text = "no relaxation spectrum: the beam stiffens with time"
        return HandedOn(field="viscosity", part=None, remarks=(text,))
    return viscosity_of(lambda t: 1.0 - found.amplitude * np.log10(t), first=first, last=last)


CREEP = OutlineEffect(
    effect=catalogue.CREEP,
    step=0.01,
    bounds=(-0.15, 0.25),
    prior_scale=0.1,
    bend=_bend_creep,
    timed=True,
    hands_on=_viscosity_creep,
)


# -- clamp-gap --
# The bridge is slack (positive: its clamps are nearer to each other than its free length) or stretched.


def _bend_clamp_gap(beam: Beam, amplitude: float, _: Situation) -> Beam:
    # the clamps stay where they are seen; more material hangs between them
    dx, dz = beam.clamp_imperfections.far_shift
    return replace(
        beam,
        length=beam.length + amplitude,
        clamp_imperfections=replace(beam.clamp_imperfections, far_shift=(dx - amplitude, dz)),
    )


CLAMP_GAP = OutlineEffect(
    effect=catalogue.CLAMP_GAP,
    step=2e-4,
    bounds=(-5e-3, 5e-3),
    prior_scale=1.5e-3,
    bend=_bend_clamp_gap,
    applies_to=bridge,
)


# -- image-scale --
# The scale of all photographs is off by this part: things look larger where positive.


def _image_scale(points: Array, amplitude: float, _: Situation) -> Array:
    return points * (1.0 + amplitude)


IMAGE_SCALE = OutlineEffect(
    effect=catalogue.IMAGE_SCALE,
    step=3e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    image=_image_scale,
    scopes=(),
)


# -- lens-distortion --
# The lens distorts: points move away from the picture's middle by k r^2 of their distance r from it.


def _image_lens_distortion(points: Array, amplitude: float, situation: Situation) -> Array:
    # the middle of the picture is not in the file: the middle of the unbent beam stands for it
    away = points - np.array([0.5 * situation.trial.free_length, 0.0])
    return points + away * amplitude * (away**2).sum(axis=1, keepdims=True)


LENS_DISTORTION = OutlineEffect(
    effect=catalogue.LENS_DISTORTION,
    step=1.0,
    bounds=(-20.0, 20.0),
    prior_scale=8.0,
    image=_image_lens_distortion,
    scopes=(),
)


# -- skin --
# A layer of 1 mm at the surface is stiffer than the core by this part; locking elements look the same.


def _bend_skin(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, imperfections=replace(beam.imperfections, skin=beam.imperfections.skin + amplitude))


SKIN = OutlineEffect(
    effect=catalogue.SKIN,
    step=0.1,
    bounds=(-0.9, 3.0),
    prior_scale=1.0,
    bend=_bend_skin,
)


# -- added-mass --
# Something hangs on the free end of one cantilever: a blob, a hook, a label.


def _bend_added_mass(beam: Beam, amplitude: float, _: Situation) -> Beam:
    force = np.asarray(beam.tip_force) + amplitude * np.asarray(beam.gravity)
    return replace(beam, tip_force=(float(force[0]), float(force[1]), float(force[2])))


ADDED_MASS = OutlineEffect(
    effect=catalogue.ADDED_MASS,
    step=2e-4,
    bounds=(0.0, 2e-2),
    prior_scale=2e-3,
    bend=_bend_added_mass,
    applies_to=cantilever,
    scopes=("trial",),
    in_all=False,
)


# -- locking --
# The simulator's elements lock: this part of the way from its beams to those of a mixed element.


def _instead_locking(beam: Beam) -> Beam:
    return replace(beam, element="default", axial_element_size=COARSE.layer, radial_elements=2)


LOCKING = OutlineEffect(
    effect=catalogue.LOCKING,
    step=1.0,
    bounds=(-1.0, 3.0),
    prior_scale=1.0,
    instead=_instead_locking,
    faulty=lambda simulator: simulator.fidelity.element == "tet4",
    scopes=(),
)


# -- coarse-mesh --
# The simulator's mesh is too coarse: this part of the way to a mesh three times finer.


def _instead_coarse_mesh(beam: Beam) -> Beam:
    return replace(
        beam, axial_element_size=beam.axial_element_size / 3.0, radial_elements=beam.radial_elements + 1
    )


COARSE_MESH = OutlineEffect(
    effect=catalogue.COARSE_MESH,
    step=1.0,
    bounds=(-1.0, 3.0),
    prior_scale=1.0,
    instead=_instead_coarse_mesh,
    faulty=lambda simulator: simulator.reference is None and simulator.fidelity.element != "tet4",
    scopes=(),
)


# -- not-at-equilibrium --
# The simulator stops before equilibrium: this part of the way from where it stops to the equilibrium.


def _instead_not_at_equilibrium(beam: Beam) -> Beam:
    return replace(beam, solver=COARSE.solver)


NOT_AT_EQUILIBRIUM = OutlineEffect(
    effect=catalogue.NOT_AT_EQUILIBRIUM,
    step=1.0,
    bounds=(-1.0, 3.0),
    prior_scale=1.0,
    instead=_instead_not_at_equilibrium,
    faulty=lambda simulator: simulator.fidelity.solver.method != "static",
    scopes=(),
)

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
