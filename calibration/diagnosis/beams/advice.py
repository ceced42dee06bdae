"""Which experiment would separate causes that the data cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, Self

import numpy as np

from calibration.diagnosis import advice
from calibration.diagnosis.advice import Advice, from_nearest, gauged, measured
from calibration.diagnosis.beams._pictures import Image, Picture
from calibration.diagnosis.beams._scenes import Scenes
from calibration.diagnosis.beams.experiments import EXPERIMENTS, Gauge, Photographs
from calibration.diagnosis.beams.simulators import Simulator
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Nested, State
from calibration.experiment.model import BeamTrial, Capture, Experiment, TracedOutline
from calibration.outlines import edges
from tisim import Beam, Result, simulate

ENOUGH = 25.0  # of chi-square: rivals that part by 5 standard deviations are separated
EACH_EDGE = 40  # points of a made outline


class Beams(Nested, Protocol):
    """What advice needs of a model of beams."""

    experiment: Experiment
    trials: list[BeamTrial]
    pictures: list[Picture]
    scenes: Scenes
    simulator: Simulator
    workers: int | None

    def measuring(self, experiment: Experiment, pose: Callable[[Beam, BeamTrial], Beam]) -> Self: ...


def advise(model: Beams, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: of those that separate the first of these explanations from all
    others the cheapest, else the one that comes nearest to it."""

    def apart(e: Photographs | Gauge, first: Explanation, others: Sequence[Explanation]) -> Sequence[float]:
        if isinstance(e, Gauge):
            return gauged(e.sds, first, others)
        return measured(_photographed(model, e, first.fit.state), first, others)

    return advice.advise(EXPERIMENTS, rivals, apart, enough=ENOUGH, rank=from_nearest)


def _photographed(model: Beams, design: Photographs, state: State) -> Nested | None:
    """The same specimens photographed anew, as a state predicts them; None where they cannot be."""
    kept = {t.id: changed for t in model.trials if (changed := design.trial(t)) is not None}
    if not kept:
        return None
    empty = replace(model.experiment, trials=tuple(replace(t, captures=()) for t in kept.values()))
    made = _predicted(model, empty, kept, design, state)
    if made is None:
        return None
    new = model.measuring(made, design.pose)
    new.retake(state)
    return new


def _predicted(
    model: Beams, empty: Experiment, trials: dict[str, BeamTrial], design: Photographs, state: State
) -> Experiment | None:
    """The experiment as the state predicts it; None where it has no equilibrium."""
    scenes = replace(model.scenes, trials=[trials.get(t.id, t) for t in model.trials], pose=design.pose)
    index = [i for i, t in enumerate(model.trials) if t.id in trials]
    beams = [scenes.beam(i, state, time=design.time, fidelity=model.simulator.fidelity) for i in index]
    results = simulate(beams, workers=model.workers)
    if not all(r.ok for r in results):
        return None
    photographed = []
    for i, r in zip(index, results, strict=True):
        trial = trials[model.trials[i].id]
        old = next(p for p in model.pictures if p.trial == i)
        images = scenes.images(i, state, time=design.time)
        outline = _traced(r, old, images)
        photographed.append(replace(trial, captures=(Capture(time=design.time, outline=outline),)))
    return replace(empty, trials=tuple(photographed))


def _traced(result: Result, old: Picture, images: Sequence[Image]) -> TracedOutline:
    upper, lower = edges(result)
    for image in images:
        upper, lower = image(upper), image(lower)
    some = [line[np.linspace(0, len(line) - 1, EACH_EDGE).astype(int)] for line in (upper, lower)]
    return replace(old.outline, upper=some[0], lower=some[1])
