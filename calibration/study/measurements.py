"""What an experiment holds of one material, as objectives of a fit: any mix of its trials."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

from calibration.coupons import CouponObjective
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, CouponTrial, Experiment, MaterialBelief, PokeTrial
from calibration.motion import MarkerObjective
from calibration.outlines import COARSE, REFERENCE, Fidelity, OutlineObjective
from calibration.outlines.dice import DiceObjective
from calibration.outlines.setup import Setup
from calibration.pokes import PokeObjective
from calibration.search import Objective

ObjectiveName = Literal["likelihood", "dice"]


@dataclass(frozen=True, eq=False, kw_only=True)
class OnSetup(Experiment):
    """An experiment of which it is known what its rig and camera do to beams: what is fitted is corrected."""

    setup: Setup

    @staticmethod
    def of(experiment: Experiment, setup: Setup | None) -> Experiment:
        """The experiment on a setup; itself where none is known."""
        if setup is None:
            return experiment
        return OnSetup(**{f.name: getattr(experiment, f.name) for f in fields(Experiment)}, setup=setup)


@dataclass(frozen=True, eq=False, kw_only=True)
class Measurements:
    """Objectives of one material; outlines is the one among them that photographs feed, pokes the one that
    rods feed, if any. ignored: trials, and parts of records, that the fit does not use."""

    material: str
    density: float | None
    objectives: tuple[Objective, ...]
    outlines: OutlineObjective | None
    ignored: tuple[str, ...]
    pokes: PokeObjective | None = None


def measurements(
    experiment: Experiment,
    material: str,
    *,
    workers: int | None = None,
    fidelity: Fidelity = COARSE,
    reference: Fidelity | None = REFERENCE,
    objective: ObjectiveName = "likelihood",
) -> Measurements:
    """All that the static fit of a material can use. ignored: trials that it cannot, each with the reason.

    InputError where nothing is left, or where the experiment's setup (`OnSetup`) cannot be applied.
    """
    setup = experiment.setup if isinstance(experiment, OnSetup) else None
    belief = experiment.materials[material]
    mine = [t for t in experiment.trials if t.material == material]
    beams = [t for t in mine if isinstance(t, BeamTrial) and any(c.outline for c in t.captures)]
    if objective == "dice":
        if setup is not None:
            raise InputError("a known rig corrects outlines: expected the objective likelihood, not dice")
        # no chi-square: nothing else can be added to it
        return Measurements(
            material=material,
            density=belief.density,
            objectives=(DiceObjective(beams, belief, workers=workers),),
            outlines=None,
            ignored=tuple(f"{t.id}: only traced beams have a Dice" for t in mine if t not in beams),
        )
    objectives: list[Objective] = []
    outlines = None
    if beams:
        outlines = OutlineObjective(
            beams, belief, fidelity=fidelity, reference=reference, setup=setup, workers=workers
        )
        objectives.append(outlines)
    objectives += [CouponObjective(trial=t) for t in mine if isinstance(t, CouponTrial)]
    rods = [t for t in mine if isinstance(t, PokeTrial) and t.inclusion_mesh is None]
    pokes = PokeObjective(rods, workers=workers) if rods else None
    if pokes is not None:
        objectives.append(pokes)
    marked = [t for t in mine if isinstance(t, BeamTrial) and t.markers]
    if setup is not None and marked:
        raise InputError(
            f"trial {marked[0].id}: markers: a known rig corrects outlines, not markers: fit them apart"
        )
    objectives += [settled_markers(t, belief, workers=workers) for t in marked]
    if not objectives:
        raise InputError(
            f"{experiment.folder / 'experiment.yaml'}: material {material}: expected at least one traced"
            " outline, marker, poke or coupon to fit (photographs: run calibration.reconstruct first)"
        )
    used = {t.id for t in mine if t in beams or t in rods or t in marked or isinstance(t, CouponTrial)}
    ignored = tuple(f"{t.id}: {_why(t)}" for t in mine if t.id not in used)
    parts = [f"{t.id}: the motion of its markers (calibration.motion fits it, with damping)" for t in marked]
    parts += [] if pokes is None else pokes.left_out
    return Measurements(
        material=material,
        density=belief.density,
        objectives=tuple(objectives),
        outlines=outlines,
        ignored=(*ignored, *parts),
        pokes=pokes,
    )


def settled_markers(
    trial: BeamTrial, belief: MaterialBelief, *, workers: int | None = None
) -> MarkerObjective:
    """Where a beam's markers have come to rest: the mean of the last third of their record."""
    first = min(float(m.time[0]) for m in trial.markers)
    last = min(float(m.time[-1]) for m in trial.markers)
    window = 2.0 / 3.0 * (last - first)
    return MarkerObjective(trial, belief, stages=("settled",), window=window, workers=workers)


def _why(trial: object) -> str:
    if isinstance(trial, BeamTrial):
        return "not traced yet"
    return "a poke beside an inclusion given as a mesh cannot be simulated yet"
