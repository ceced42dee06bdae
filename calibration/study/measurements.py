"""Trials of one material in an experiment, of any mix, as objectives of a fit of one law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, CouponTrial, Experiment, MaterialBelief, PokeTrial
from calibration.inference import Objective, OfMaterial
from calibration.measurements._baseline import Baseline
from calibration.measurements._kinds import kind_of
from calibration.measurements.indentation.model import IndentationModel
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines.dice import DiceObjective
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.setup import Setup
from calibration.measurements.outlines.simulators import OURS, Simulator
from calibration.measurements.release import MarkerObjective, not_swinging
from calibration.measurements.release.model import ReleaseModel
from calibration.parameters import Parametrisation

ObjectiveName = Literal["likelihood", "dice"]

VIBRATION_STEPS = 0.1  # of a search over moduli: 3 % of one put a vibration out of phase


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
    """Objectives of one material in the coordinates of one law; outlines is the one among them that
    photographs feed, pokes the one that rods feed, if any. ignored: trials, and parts of records, that the
    fit does not use. free_bulk_ratio: K/G is to be found, by photographs."""

    material: str
    law: Parametrisation
    density: float | None
    objectives: tuple[Objective, ...]
    outlines: ModelObjective[OutlineModel] | None
    ignored: tuple[str, ...]
    pokes: ModelObjective[IndentationModel] | None = None
    free_bulk_ratio: bool = False


def measurements(
    experiment: Experiment,
    material: str,
    law: Parametrisation,
    *,
    workers: int | None = None,
    simulator: Simulator = OURS,
    objective: ObjectiveName = "likelihood",
    free_bulk_ratio: bool = False,
) -> Measurements:
    """All that a fit of a material can use. simulator: of beams.

    K/G is held at its prior's centre, as a diagnosis holds it: photographs alone see it, so little that a
    rig's small fault moves it. free_bulk_ratio : it is found beside the other constants, with its prior.

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
            law=law,
            density=belief.density,
            objectives=(OfMaterial(law, DiceObjective(beams, belief, workers=workers)),),
            outlines=None,
            ignored=tuple(f"{t.id}: only traced beams have a Dice" for t in mine if t not in beams),
        )
    objectives: list[Objective] = []
    outlines = None
    free_bulk_ratio = free_bulk_ratio and bool(beams)  # nothing else sees K/G
    if not free_bulk_ratio:
        law = law.holding("bulk_ratio")
    if beams:
        model = OutlineModel(
            replace(experiment, trials=tuple(beams)),
            simulator=simulator,
            workers=workers,
            baseline=Baseline.of_law(beams, law),
            setup=setup,
        )
        outlines = ModelObjective(model, name=f"outlines of {material}")
        objectives.append(outlines)
    coupons = [t for t in mine if isinstance(t, CouponTrial)]
    if coupons:
        own = replace(experiment, trials=tuple(coupons))
        # cylinders between platens are compared as a diagnosis compares them
        pulled = kind_of(own).load()(own, baseline=Baseline.of_law(coupons, law))
        objectives.append(ModelObjective(pulled, name=_named("coupons", coupons)))
    rods = [t for t in mine if isinstance(t, PokeTrial) and t.inclusion_mesh is None]
    pokes = None
    if rods:
        own = replace(experiment, trials=tuple(rods))
        pushed = IndentationModel(own, baseline=Baseline.of_law(rods, law), workers=workers)
        pokes = ModelObjective(pushed, name=_named("pokes", rods))
        objectives.append(pokes)
    marked = [t for t in mine if isinstance(t, BeamTrial) and t.markers]
    if setup is not None and marked:
        raise InputError(
            f"trial {marked[0].id}: markers: a known rig corrects outlines, not markers: fit them apart"
        )
    still = {t.id: why for t in marked if (why := not_swinging(t, experiment))}
    swinging = [t for t in marked if t.id not in still]
    left_out: list[str] = []
    if swinging:
        law = law.in_steps(VIBRATION_STEPS)
        own = replace(experiment, trials=tuple(swinging))
        released = ReleaseModel(own, baseline=Baseline.of_law(swinging, law), workers=workers)
        left_out += released.left_out()
        objectives.append(ModelObjective(released, name=f"markers of {', '.join(t.id for t in swinging)}"))
    for t in marked:
        if t.id in still:  # at rest alone: the solid, for want of a vibration to correct a reduced beam by
            objectives.append(OfMaterial(law, settled_markers(t, belief, workers=workers)))
    if not objectives:
        raise InputError(
            f"{experiment.folder / 'experiment.yaml'}: material {material}: expected at least one traced"
            " outline, marker, poke or coupon to fit (photographs: run calibration.reconstruct first)"
        )
    used = {t.id for t in mine if t in beams or t in rods or t in marked or t in coupons}
    ignored = tuple(f"{t.id}: {_why(t)}" for t in mine if t.id not in used)
    parts = [
        f"{i}: the motion of its markers, only where they come to rest ({why})" for i, why in still.items()
    ]
    parts += [
        f"{t.id}: the height of its tip force: a body at rest is pulled all over its end"
        for t in marked
        if t.id in still and t.tip_force_height
    ]
    parts += left_out
    parts += [] if pokes is None else pokes.model.left_out
    return Measurements(
        material=material,
        law=law,
        density=belief.density,
        objectives=tuple(objectives),
        outlines=outlines,
        ignored=(*ignored, *parts),
        pokes=pokes,
        free_bulk_ratio=free_bulk_ratio,
    )


def settled_markers(
    trial: BeamTrial, belief: MaterialBelief, *, workers: int | None = None
) -> MarkerObjective:
    """Rest positions of a beam's markers: the mean of the last third of their record."""
    first = min(float(m.time[0]) for m in trial.markers)
    last = min(float(m.time[-1]) for m in trial.markers)
    window = 2.0 / 3.0 * (last - first)
    return MarkerObjective(trial, belief, stages=("settled",), window=window, workers=workers)


def _named(kind: str, trials: Sequence[CouponTrial] | Sequence[PokeTrial]) -> str:
    return f"{kind} {', '.join(t.id for t in trials)}"


def _why(trial: object) -> str:
    if isinstance(trial, BeamTrial):
        return "not traced yet"
    return "a poke beside an inclusion given as a mesh cannot be simulated yet"
