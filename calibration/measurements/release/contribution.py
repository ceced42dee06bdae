"""Contribution of beams with markers to fits: `ReleaseModel` where they vibrate, FEM where they only rest."""

from __future__ import annotations

from dataclasses import replace

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment, MaterialBelief
from calibration.inference import Objective
from calibration.measurements._baseline import Baseline
from calibration.measurements._contribution import Contribution, FitContext
from calibration.measurements.objective import ModelObjective
from calibration.measurements.release._record import why_no_record
from calibration.measurements.release.model import ReleaseModel
from calibration.measurements.release.settled import SettledModel

STEPS = 0.1  # of a search over moduli: 3 % of one put a vibration out of phase


def likelihood(own: Experiment, context: FitContext) -> Contribution:
    """Objectives of marked beams of one material.

    A beam without a free vibration has no reduced beam to correct; its markers are compared where they come
    to rest only.

    Raises
    ------
    InputError
        If the setup is known, which corrects outlines only, or a trial is incomplete.
    """
    trials = [t for t in own.trials if isinstance(t, BeamTrial)]
    if context.setup is not None:
        raise InputError(
            f"trial {trials[0].id}: markers: a known rig corrects outlines, not markers: fit them apart"
        )
    why = {t.id: why_no_record(t, own) for t in trials}
    vibrating, still = [t for t in trials if not why[t.id]], [t for t in trials if why[t.id]]
    left_out = [
        f"{t.id}: the motion of its markers, only where they come to rest ({why[t.id]})" for t in still
    ]
    left_out += [
        f"{t.id}: the height of its tip force: a body at rest is pulled all over its end"
        for t in still
        if t.tip_force_height
    ]
    left_out += [note for t in trials if (note := _taken_as_exact(t, own.materials[t.material]))]
    objectives: list[Objective] = []
    if vibrating:
        model = ReleaseModel(
            replace(own, trials=tuple(vibrating)),
            baseline=Baseline.of_law(vibrating, context.law.in_steps(STEPS)),
            workers=context.workers,
        )
        left_out += model.left_out()
        objectives.append(ModelObjective(model, name=f"markers of {', '.join(t.id for t in vibrating)}"))
    if still:
        at_rest = SettledModel(
            replace(own, trials=tuple(still)),
            baseline=Baseline.of_law(still, context.law),
            workers=context.workers,
        )
        objectives.append(ModelObjective(at_rest, name=f"markers of {', '.join(t.id for t in still)}"))
    return Contribution(
        objectives=tuple(objectives), left_out=tuple(left_out), steps=STEPS if vibrating else 1.0
    )


def _taken_as_exact(trial: BeamTrial, belief: MaterialBelief) -> str:
    """Sentence on the stated standard deviations that the intervals of a fit of markers leave out; or ""."""
    doubts = {
        "free length": trial.free_length_sd,
        "section": max(trial.section_sd),
        "density": belief.density_sd,
    }
    stated = [name for name, sd in doubts.items() if sd > 0.0]
    if not stated:
        return ""
    listed = " and ".join(filter(None, (", ".join(stated[:-1]), stated[-1])))
    return (
        f"{trial.id}: the stated standard deviation of {listed}: a fit of markers takes"
        " them as exact, and its intervals are too narrow by what they add"
    )
