"""Which experiment would separate causes that the data cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams._pictures import Image, Picture
from calibration.diagnosis.beams.experiments import EXPERIMENTS, Gauge, Photographs
from calibration.diagnosis.beams.model import BeamModel
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import State
from calibration.experiment.model import BeamTrial, Capture, Experiment, TracedOutline
from calibration.outlines import edges
from tisim import Result, simulate

Array = NDArray[np.float64]

ENOUGH = 25.0  # of chi-square: rivals that part by 5 standard deviations are separated
EACH_EDGE = 40  # points of a made outline


@dataclass(frozen=True, kw_only=True)
class Advice:
    """An experiment, and by how much chi-square it would part the chosen cause from its nearest rival."""

    name: str
    sentence: str
    separation: float


def advise(model: BeamModel, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: of those that separate the first of these explanations from all
    others the cheapest, else the one that comes nearest to it."""
    first, others = rivals[0], rivals[1:]
    found = []
    for e in EXPERIMENTS:
        if isinstance(e, Gauge):
            apart = min(_gauged(e, first, other) for other in others)
        else:
            apart = _photographed(model, e, first, others)
        found.append(Advice(name=e.name, sentence=e.sentence, separation=apart))
    order = {a.name: k for k, a in enumerate(found)}
    return sorted(found, key=lambda a: (-min(a.separation, ENOUGH), order[a.name]))


def _gauged(gauge: Gauge, one: Explanation, other: Explanation) -> float:
    """Squared distance of two explanations' amplitudes in what a gauge measures, in its sd and theirs."""
    total = 0.0
    for effect, sd in gauge.sds.items():
        values, spread = [], sd**2
        for e in (one, other):
            mine = [e.fit.amplitude(c) for c in e.candidates if c.effect == effect]
            values.append(sum(v for v, _ in mine))
            spread += sum(s**2 for _, s in mine)
        total += (values[0] - values[1]) ** 2 / spread
    return total


def _photographed(
    model: BeamModel, design: Photographs, first: Explanation, others: Sequence[Explanation]
) -> float:
    """What photographs in another pose add to the least squared distance between the first explanation's
    predictions and any other's, whose free coordinates may adapt to old and new data alike."""
    kept = {t.id: changed for t in model.trials if (changed := design.trial(t)) is not None}
    if not kept:
        return 0.0
    empty = replace(model.experiment, trials=tuple(replace(t, captures=()) for t in kept.values()))
    made = _predicted(model, empty, kept, design, first.fit.state)
    if made is None:
        return 0.0
    new = BeamModel(
        made,
        simulator=replace(model.simulator, reference=None),
        workers=model.workers,
        pose=design.pose,
        names=model.names,
    )
    new.retake(first.fit.state)
    least = np.inf
    for other in others:
        try:
            linear = new.linearise(other.fit.state, other.candidates)
        except ValueError:
            continue  # the rival has no answer in that pose: it would be seen at once
        old = other.fit.z - first.fit.z
        m = new.points  # the prior's rows are in the old data already
        jacobian = np.column_stack([linear.by_u, linear.columns])[:m]
        both = np.vstack([other.fit.jacobian, jacobian])
        apart = _left(np.concatenate([old, linear.z[:m]]), both) - _left(old, other.fit.jacobian)
        least = min(least, apart)
    return float(least) if np.isfinite(least) else 0.0


def _left(values: Array, jacobian: Array) -> float:
    size = np.linalg.norm(jacobian, axis=0)
    q, _ = np.linalg.qr(jacobian[:, size > 0] / size[size > 0])
    return float(values @ values - np.sum((q.T @ values) ** 2))


def _predicted(
    model: BeamModel, empty: Experiment, trials: dict[str, BeamTrial], design: Photographs, state: State
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
