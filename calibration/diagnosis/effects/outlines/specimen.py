"""Effects of the specimen in photographs of beams: section, shape and stiffness distribution."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.measurements._effect import added_to
from calibration.measurements.outlines._effect import (
    OutlineEffect,
    Situation,
    cantilever,
)
from tisim import Beam, Void

Array = NDArray[np.float64]

# -- radius --
# The section is larger (positive) or smaller than stated, along the whole beam; swelling has the same effect.


def _bend_radius(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, section=beam.section.grown(amplitude))


RADIUS = OutlineEffect(
    effect=catalogue.RADIUS,
    step=5e-5,
    bounds=(-2e-3, 2e-3),
    prior_scale=5e-4,
    bend=_bend_radius,
)


# -- taper --
# Taper: the section grows (positive) or shrinks linearly along the beam, about the middle of its free length.


TAPER = OutlineEffect(
    effect=catalogue.TAPER,
    step=0.1,
    bounds=(-1.5, 1.5),
    prior_scale=0.5,
    bend=added_to(Beam, "imperfections.taper"),
)


# -- stiffness-gradient-axial --
# The modulus varies linearly along the beam (a mixture that settled), about the middle of its free length.


STIFFNESS_GRADIENT_AXIAL = OutlineEffect(
    effect=catalogue.STIFFNESS_GRADIENT_AXIAL,
    step=0.5,
    bounds=(-9.0, 9.0),
    prior_scale=4.0,
    bend=added_to(Beam, "imperfections.axial_gradient"),
)


# -- stiffness-gradient-transverse --
# The modulus varies linearly from the lower to the upper side (a filler that settled while curing).


STIFFNESS_GRADIENT_TRANSVERSE = OutlineEffect(
    effect=catalogue.STIFFNESS_GRADIENT_TRANSVERSE,
    step=2.0,
    bounds=(-80.0, 80.0),
    prior_scale=40.0,
    bend=added_to(Beam, "imperfections.transverse_gradient"),
)


# -- residual-curvature --
# Residual curvature from casting: the stress-free beam is an arc, curved upwards if positive.


RESIDUAL_CURVATURE = OutlineEffect(
    effect=catalogue.RESIDUAL_CURVATURE,
    step=0.1,
    bounds=(-4.0, 4.0),
    prior_scale=1.0,
    bend=added_to(Beam, "imperfections.curvature"),
)


# -- void --
# A bubble or a cut: over 15 mm of a beam, a fraction of its bending stiffness and of its weight is missing.
#
# The amplitude is that of a void with sharp ends. `tisim.Void` sets in gradually over `edge`, since a mesh
# cannot represent a jump. The two bend the beam by the same angle if the added flexibility, the integral of
# 1 / (1 - loss) - 1 along the beam, is equal. For a loss f over the length L it is L f / (1 - f); for a loss
# of peak p with half a cosine over E at either end it is (L - E) (w^2 - 1) + 2 E (w - 1) with
# w = 1 / sqrt(1 - p).


def hole(loss: float, *, position: float) -> Void:
    """Smooth void equivalent to a sharp-ended one of this loss (below 1) at this position [m]."""
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
    scopes=("material", "trial"),  # in one beam, or in its batch
    in_all=False,
)


# -- skin --
# A surface layer of 1 mm is stiffer than the core by this fraction; locking elements have the same effect.


SKIN = OutlineEffect(
    effect=catalogue.SKIN,
    step=0.1,
    bounds=(-0.9, 3.0),
    prior_scale=1.0,
    bend=added_to(Beam, "imperfections.skin"),
)


# -- added-mass --
# Additional mass on the free end of one cantilever: a blob, a hook, a label.


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
