"""Trials of one material in an experiment, of any mix, as objectives of a fit of one law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment, PokeTrial, Trial
from calibration.inference import Objective
from calibration.measurements._contribution import Contribution, FitContext, ObjectiveName
from calibration.measurements._kinds import compared, contribution
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines.setup import Setup
from calibration.measurements.outlines.simulators import TISIM, Simulator
from calibration.parameters import Parametrisation

if TYPE_CHECKING:
    from calibration.measurements.indentation.model import IndentationModel
    from calibration.measurements.outlines.model import OutlineModel

OUTLINES, INDENTATION = "outlines", "indentation"  # kinds that readers of `Measurements` ask for

_NOTHING: Mapping[ObjectiveName, str] = {
    "likelihood": "{file}: material {material}: expected at least one traced outline, marker, poke or coupon"
    " to fit (photographs: run calibration.reconstruct first)",
    "dice": "material {material}: expected at least one beam with a traced outline",
}


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
    simulator: Simulator = TISIM,
    objective: ObjectiveName = "likelihood",
    free_bulk_ratio: bool = False,
) -> Measurements:
    """All that a fit of a material can use. simulator: of beams.

    K/G is held at its prior's centre, as a diagnosis holds it: photographs alone see it, so little that a
    rig's small fault moves it. free_bulk_ratio : it is found beside the other constants, with its prior.

    InputError where nothing is left, or where the experiment's setup (`OnSetup`) cannot be applied.
    """
    setup = experiment.setup if isinstance(experiment, OnSetup) else None
    mine = replace(experiment, trials=tuple(t for t in experiment.trials if t.material == material))
    found = compared(mine)
    seen = objective == "likelihood" and any(kind.name == OUTLINES for kind, _ in found)
    free_bulk_ratio = free_bulk_ratio and seen
    if not free_bulk_ratio:
        law = law.holding("bulk_ratio")
    context = FitContext(law=law, simulator=simulator, workers=workers, setup=setup)
    brought = {
        kind.name: own_part
        for kind, own in found
        if (own_part := contribution(kind, own, context, objective)) is not None
    }
    if not brought:
        file = experiment.folder / "experiment.yaml"
        raise InputError(_NOTHING[objective].format(file=file, material=material))
    used = {t.id for kind, own in found if kind.name in brought for t in own.trials}
    unused = (f"{t.id}: {_why(t, objective)}" for t in mine.trials if t.id not in used)
    return Measurements(
        material=material,
        law=law.in_steps(min(c.steps for c in brought.values())),
        density=experiment.materials[material].density,
        objectives=tuple(o for c in brought.values() for o in c.objectives),
        outlines=_of_model(brought, OUTLINES),
        ignored=(*unused, *(part for c in brought.values() for part in c.left_out)),
        pokes=_of_model(brought, INDENTATION),
        free_bulk_ratio=free_bulk_ratio,
    )


def _of_model(brought: Mapping[str, Contribution], kind: str) -> ModelObjective[Any] | None:
    """The objective of a kind's model; None if there is none."""
    own = brought[kind].objectives if kind in brought else ()
    return next((o for o in own if isinstance(o, ModelObjective)), None)


def _why(trial: Trial, objective: ObjectiveName) -> str:
    """Reason why a fit does not use a trial."""
    if objective == "dice":
        return "only traced beams have a Dice"
    if isinstance(trial, BeamTrial):
        return "not traced yet"
    if isinstance(trial, PokeTrial):
        return "a poke beside an inclusion given as a mesh cannot be simulated yet"
    return "no kind of measurement compares it in a fit"
