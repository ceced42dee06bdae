"""Effects in indentation tests: block and material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._identifiable import different_rates, loads_again, unloads
from calibration.diagnosis.effects._material_parts import one_time, seen, softening_of, viscosity_of
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.indentation._effect import IndentationEffect
from calibration.measurements.indentation._record import Record
from tisim import Mesh, Poke

Array = NDArray[np.float64]

# -- relaxation --
# Linear viscoelasticity: the force falls during a hold, and rises with the speed.
#
# F(t) = Fe(t) - amplitude int h(t - s) dFe(s), where Fe is the elastic force and h(t) = log10(1 + t / 1 s),
# an equal fraction per decade; in other variants h(t) = 1 - exp(-t / tau) with one relaxation time tau.


TIMES_A_DECADE = 4  # relaxation times tried per decade

LOG_ONSET = 1.0  # time scale in the logarithm [s]


def _force_relaxation(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    """Relaxed force, not below zero, since contact is lost without adhesion."""
    rise = np.diff(force, prepend=0.0)
    return np.maximum(force - amplitude * (_faded(record, variant) @ rise), 0.0)


@lru_cache(maxsize=512)
def _faded(record: Record, variant: float | None) -> Array:
    """Matrix (k, k) whose row i has the mean of h(t_i - s) over the interval of each force increment."""
    end = record.time
    gap = np.diff(end)
    start = np.r_[end[0] - (gap[0] if gap.size else 1.0), end[:-1]]
    early = np.maximum(end[:, None] - start[None, :], 0.0)
    late = np.maximum(end[:, None] - end[None, :], 0.0)
    mean = (_integral(early, variant) - _integral(late, variant)) / (end - start)
    return np.asarray(np.where(end[:, None] >= end[None, :], mean, 0.0))


def _integral(t: Array, variant: float | None) -> Array:
    """Integral of h from 0 to t."""
    if variant is None:
        x = t / LOG_ONSET
        return np.asarray(LOG_ONSET * ((1.0 + x) * np.log1p(x) - x) / np.log(10.0))
    return np.asarray(t + variant * np.expm1(-t / variant))


def _variants_relaxation(records: Sequence[Record]) -> tuple[float | None, ...]:
    """None for the logarithm, and relaxation times from two samples to the duration of the longest record."""
    longest = max(float(np.ptp(r.time)) for r in records)
    shortest = min(float(np.median(np.diff(r.time))) for r in records if r.points > 1)
    low = int(np.floor(TIMES_A_DECADE * np.log10(2.0 * shortest)))
    high = int(np.ceil(TIMES_A_DECADE * np.log10(longest)))
    return (None, *(float(10.0 ** (k / TIMES_A_DECADE)) for k in range(low, high + 1)))


def _identifiable_relaxation(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if there is a hold, an unloading, or two different rates in one material."""
    held = any((r.direction == 0).sum() > 2 for r in reached)
    return unloads(reached, everything) or held or different_rates(reached, _speed)


def _speed(record: Record) -> Array:
    """Range of the depth over the duration of the record [m/s], shape (1,)."""
    return np.array([max(np.ptp(record.depth), 1e-9) / np.ptp(record.time)])


def _viscosity_relaxation(found: Occurrence) -> HandedOn:
    first, last = seen([r.time for r in found.records])
    a, variant = found.amplitude, found.variant
    if variant is None:
        return viscosity_of(lambda t: 1.0 - a * np.log10(1.0 + t / LOG_ONSET), first=first, last=last)
    return one_time(a, variant, first=first, last=last)


RELAXATION = IndentationEffect(
    effect=catalogue.RELAXATION,
    step=1e-3,
    bounds=(0.0, 0.9),
    prior_scale=0.3,
    force=_force_relaxation,
    stage=2,
    variants=_variants_relaxation,
    variant_label=lambda variant: f"in {variant:.3g} s",
    identifiable=_identifiable_relaxation,
    action="hold the indenter at the largest depth for a minute, or indent at a tenth and ten times the"
    " speed",
    hands_on=_viscosity_relaxation,
)


# -- mullins --
# After an indentation the force is lower up to the largest depth so far: by the fraction `amplitude` near the
# surface, decreasing to zero at that depth; or, in another variant, by the same fraction at all depths from
# the second loading on.


FADING_SOFTENING, EVEN_SOFTENING = 0.0, 1.0


def _force_mullins(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    if variant == EVEN_SOFTENING:
        softened = np.maximum(record.cycle > 1, record.unloaded[0])
    else:
        below = 1.0 - record.depth / np.maximum(record.peak, 1e-9)
        softened = record.unloaded * np.clip(below, 0.0, 1.0)
    return force * (1.0 - amplitude * softened)


def _softening_mullins(found: Occurrence) -> HandedOn:
    """Softening of the material equivalent to that of the force.

    Energy is proportional to the square of the depth (flat indenter at small strain). The largest energy is
    1.5 G strain^2 with the strain taken as depth over indenter radius, at most 1.
    """
    strain = max(min(float(r.peak.max()) / r.geometry.rod.radius, 1.0) for r in found.records)

    def lost(ratio: Array) -> Array:
        below = np.ones(ratio.size) if found.variant == EVEN_SOFTENING else 1.0 - np.sqrt(ratio)
        return np.asarray(found.amplitude * np.where(ratio < 1.0, below, 0.0))

    return softening_of(
        lost,
        energy=1.5 * found.shear_modulus * strain**2,
        remarks=("the softening of the force is taken for that of the stress at each point",),
    )


MULLINS = IndentationEffect(
    effect=catalogue.MULLINS,
    step=1e-3,
    bounds=(0.0, 0.95),
    prior_scale=0.5,
    force=_force_mullins,
    stage=1,
    variants=lambda _: (FADING_SOFTENING, EVEN_SOFTENING),
    variant_label=lambda variant: "all the way" if variant == EVEN_SOFTENING else "below the deepest depth",
    applies_to=lambda record: record.reloaded,
    identifiable=loads_again,
    hands_on=_softening_mullins,
    action="indent the same point twice to the same depth",
)


# -- adhesion --
# Adhesion: in unloading the force is smaller, and tensile before the indenter detaches.
#
# The adhesive force develops within a tenth of the largest depth after the reversal, and decays above the
# surface; in another variant it acts near the surface only.


EVERYWHERE, SHALLOW = 0.0, 1.0

ADHESION_TURNS = 0.1  # fraction of the largest depth over which the adhesive force develops

# Decay lengths in indenter radii: above the surface, and below it (shallow variant).
ADHESION_LIFT, ADHESION_DEPTH = 0.15, 0.3


def _force_adhesion(force: Array, amplitude: float, record: Record, variant: float | None) -> Array:
    return force - amplitude * _pull(record, variant)


def _pull(record: Record, variant: float | None) -> Array:
    radius = record.geometry.rod.radius
    d = record.depth
    grown = np.clip((record.peak - d) / np.maximum(ADHESION_TURNS * record.peak, 1e-9), 0.0, 1.0)
    below = np.exp(-np.maximum(d, 0.0) / (ADHESION_DEPTH * radius)) if variant == SHALLOW else np.ones(d.size)
    above = np.exp(-((np.minimum(d, 0.0) / (ADHESION_LIFT * radius)) ** 2))
    return np.asarray((record.direction < 0) * grown * below * above)


ADHESION = IndentationEffect(
    effect=catalogue.ADHESION,
    step=1e-4,
    bounds=(0.0, 2.0),
    prior_scale=0.1,
    force=_force_adhesion,
    stage=3,
    variants=lambda _: (EVERYWHERE, SHALLOW),
    variant_label=lambda variant: "near the surface" if variant == SHALLOW else "all the way back",
    applies_to=lambda record: record.unloads,
    identifiable=unloads,
)


# -- inclusion-debonded --
# The inclusion is debonded from the soft material: the force is in part that of a block without inclusion.
#
# The amplitude is that fraction; 1 is the block without its inclusion, which is softer than a block with any
# debonded one. The force is assumed to be linear in it: opening and closing of a gap are not simulated.


def _scene_inclusion_debonded(poke: Poke, mesh: Mesh | None, amplitude: float, variant: float | None) -> Poke:
    del mesh, amplitude, variant
    return replace(poke, block=replace(poke.block, inclusion=None))


INCLUSION_DEBONDED = IndentationEffect(
    effect=catalogue.INCLUSION_DEBONDED,
    step=0.01,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),
    prior_scale=1.0,
    scene=_scene_inclusion_debonded,
    nodes=(0.0, 1.0),
    chord=1.0,
    applies_to=lambda record: record.geometry.block.inclusion is not None,
)


# -- inclusion-misplaced --
# The position of the rigid inclusion differs from the assumed one, along x, y or z.


X, Y, Z = 0.0, 1.0, 2.0

SHIFT = 1.5e-3  # [m]


def _scene_inclusion_misplaced(
    poke: Poke, mesh: Mesh | None, amplitude: float, variant: float | None
) -> Poke:
    """The block is meshed again, since the inclusion's outline lies in other cells.

    The change by the mesh is covered by the discretisation error.
    """
    del mesh
    inclusion = poke.block.inclusion
    assert inclusion is not None
    centre = np.asarray(inclusion.centre) + amplitude * np.eye(3)[int(variant or 0.0)]
    moved = replace(inclusion, centre=(float(centre[0]), float(centre[1]), float(centre[2])))
    return replace(poke, block=replace(poke.block, inclusion=moved))


def _variants_inclusion_misplaced(records: Sequence[Record]) -> tuple[float | None, ...]:
    """All three directions if there are several contact points, only z otherwise."""
    sites = {r.geometry.site for r in records if r.geometry.block.inclusion is not None}
    return (X, Y, Z) if len(sites) > 1 else (Z,)


INCLUSION_MISPLACED = IndentationEffect(
    effect=catalogue.INCLUSION_MISPLACED,
    step=0.1e-3,
    bounds=(-3.0 * SHIFT, 3.0 * SHIFT),
    prior_scale=3.0 * SHIFT,
    scene=_scene_inclusion_misplaced,
    nodes=(-3.0 * SHIFT, -2.0 * SHIFT, -SHIFT, 0.0, SHIFT, 2.0 * SHIFT, 3.0 * SHIFT),
    chord=SHIFT,
    finer=True,
    variants=_variants_inclusion_misplaced,
    variant_label=lambda variant: f"along {'xyz'[int(variant)]}",
    applies_to=lambda record: record.geometry.block.inclusion is not None,
)


# -- thickness --
# The block is thicker (positive) or thinner than assumed: its base is further from the indenter, or nearer.


HEIGHT_STEP = 0.2  # relative difference in height between the simulated blocks


def _scene_thickness(poke: Poke, mesh: Mesh | None, amplitude: float, variant: float | None) -> Poke:
    """The same mesh is stretched, since the error of a new mesh would hide a small change."""
    del variant
    part = 1.0 + amplitude
    size = poke.block.size
    block = replace(poke.block, size=(size[0], size[1], part * size[2]))
    moved = None if mesh is None else replace(mesh, nodes=mesh.nodes * np.array([1.0, 1.0, part]))
    return replace(poke, block=block, mesh=moved)


THICKNESS = IndentationEffect(
    effect=catalogue.THICKNESS,
    step=0.005,
    bounds=(-2.0 * HEIGHT_STEP, 2.0 * HEIGHT_STEP),
    prior_scale=2.0 * HEIGHT_STEP,
    scene=_scene_thickness,
    nodes=(-2.0 * HEIGHT_STEP, -HEIGHT_STEP, 0.0, HEIGHT_STEP, 2.0 * HEIGHT_STEP),
    chord=HEIGHT_STEP,
    finer=True,
    applies_to=lambda record: record.geometry.block.inclusion is None,
    scopes=("material", "block", "material block", "specimen"),
)
