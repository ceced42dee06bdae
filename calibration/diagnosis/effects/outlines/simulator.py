"""Errors of the simulator itself: interpolation between its beams and those of a better discretisation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.measurements.outlines import COARSE
from calibration.measurements.outlines._effect import (
    OutlineEffect,
)
from tisim import Beam

Array = NDArray[np.float64]

# -- locking --
# Locking elements. The amplitude interpolates linearly from the simulator's beams (0) to those of a mixed
# element (1).


def _instead_locking(beam: Beam) -> Beam:
    return replace(beam, element="default", axial_element_size=COARSE.axial_element_size, radial_elements=2)


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
# Mesh too coarse. The amplitude interpolates linearly to a mesh with axial elements of a third of the size
# and one more radial element.


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
# The simulator stops before equilibrium. The amplitude interpolates linearly from its final state to the
# static equilibrium.


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
