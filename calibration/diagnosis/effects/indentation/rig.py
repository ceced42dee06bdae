"""Effects in indentation tests: indenter and sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._identifiable import compared_with_others
from calibration.measurements.indentation._effect import IndentationEffect
from calibration.measurements.indentation._record import Record
from calibration.measurements.indentation._scene import FRICTION as BELIEVED
from tisim import Mesh, Poke

Array = NDArray[np.float64]

SCOPES = ("rod", "trial")

# -- friction --
# The coefficient of friction is lower (or higher) than assumed: the surface slips along the indenter's tip.


NO_FRICTION, LITTLE_FRICTION = -BELIEVED, -0.5


def _scene_friction(poke: Poke, mesh: Mesh | None, amplitude: float, variant: float | None) -> Poke:
    del variant
    return replace(poke, friction=max(0.0, BELIEVED + amplitude), mesh=mesh)


FRICTION = IndentationEffect(
    effect=catalogue.FRICTION,
    step=0.01,
    bounds=(-BELIEVED, 0.4),
    physical_limits=(-BELIEVED,),
    prior_scale=BELIEVED,
    start_fraction=1.0,  # the effect is strongest near the bound
    scene=_scene_friction,
    # from 0.4 on there is hardly any slip
    nodes=(NO_FRICTION, LITTLE_FRICTION, -0.35, 0.0, 0.4),
    # frictionless contact dissipates nothing in unloading, contact with a little friction does
    variants=lambda _: (LITTLE_FRICTION, NO_FRICTION),
    variant_label=lambda variant: "some slip" if variant == LITTLE_FRICTION else "free slip",
    chords=True,
    straight=True,
    finer=True,
    retracts=True,
    scopes=SCOPES,
)


# -- rod-angle --
# The inclination of the indenter's axis differs from the assumed one: in the plane of its travel (x-z if it
# is upright), or perpendicular to that plane.


ALONG, ACROSS = 0.0, 1.0

STEEPEST = np.radians(45.0)

DEGREE = float(np.radians(1.0))


def _scene_rod_angle(poke: Poke, mesh: Mesh | None, amplitude: float, variant: float | None) -> Poke:
    axis = np.asarray(poke.direction) / np.linalg.norm(poke.direction)
    level = np.array([axis[0], axis[1], 0.0])
    away = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(level) < 1e-9 else level / np.linalg.norm(level)
    if variant == ACROSS:
        away = np.array([-away[1], away[0], 0.0])
    side = away - (away @ axis) * axis
    side /= np.linalg.norm(side)
    turned = np.cos(amplitude) * axis + np.sin(amplitude) * side
    return replace(poke, direction=(float(turned[0]), float(turned[1]), float(turned[2])), mesh=mesh)


def _variants_rod_angle(records: Sequence[Record]) -> tuple[float | None, ...]:
    """The direction across the plane is included only if a record has forces across the indenter."""
    return (ALONG, ACROSS) if any(r.across is not None for r in records) else (ALONG,)


def _fits_rod_angle(poke: Poke) -> bool:
    axis = np.asarray(poke.direction) / np.linalg.norm(poke.direction)
    return float(np.arccos(np.clip(-axis[2], -1.0, 1.0))) <= STEEPEST


ROD_ANGLE = IndentationEffect(
    effect=catalogue.ROD_ANGLE,
    step=0.1 * DEGREE,
    bounds=(-10.0 * DEGREE, 10.0 * DEGREE),
    prior_scale=10.0 * DEGREE,
    scene=_scene_rod_angle,
    nodes=(-10.0 * DEGREE, -5.0 * DEGREE, 0.0, 5.0 * DEGREE, 10.0 * DEGREE),
    chord=5.0 * DEGREE,
    fits=_fits_rod_angle,
    variants=_variants_rod_angle,
    variant_label=lambda variant: "across its plane" if variant == ACROSS else "in its plane",
    scopes=SCOPES,
)


# -- depth-offset --
# Zero error of the depth: first contact was earlier or later than recorded.


def _shift_depth_offset(amplitude: float, record: Record) -> float:
    del record
    return amplitude


DEPTH_OFFSET = IndentationEffect(
    effect=catalogue.DEPTH_OFFSET,
    step=1e-6,
    bounds=(-2e-3, 2e-3),
    prior_scale=0.5e-3,
    shift=_shift_depth_offset,
    scopes=SCOPES,
)


# -- force-gain --
# Gain error of the load cell; a gain common to all records of a material is an alias of the modulus.


def _force_gain(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    del record, variant
    return (1.0 + amplitude) * force


FORCE_GAIN = IndentationEffect(
    effect=catalogue.FORCE_GAIN,
    step=1e-3,
    bounds=(-0.6, 0.6),
    prior_scale=0.3,
    force=_force_gain,
    stage=4,
    identifiable=compared_with_others,
    scopes=SCOPES,
    action="hang a known weight on the load cell",
)


# -- force-offset --
# Constant zero error of the force in a record.


def _force_offset(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    del record, variant
    return force + amplitude


FORCE_OFFSET = IndentationEffect(
    effect=catalogue.FORCE_OFFSET,
    step=1e-4,
    bounds=(-5.0, 5.0),
    prior_scale=0.1,
    force=_force_offset,
    stage=5,
    scopes=SCOPES,
)


# -- force-drift --
# The zero of the force drifts linearly in time (warming load cell).


def _force_drift(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    del variant
    return force + amplitude * (record.time - record.time[0])


FORCE_DRIFT = IndentationEffect(
    effect=catalogue.FORCE_DRIFT,
    step=1e-6,
    bounds=(-1.0, 1.0),
    prior_scale=0.02,
    force=_force_drift,
    stage=5,
    scopes=SCOPES,
)
