"""Photographs that a state predicts, for an experiment that a lab can do next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.experiment.model import Capture, Experiment, TracedOutline
from calibration.measurements._state import State
from calibration.measurements.outlines._edges import edges
from calibration.measurements.outlines._photographs import Image, TracedPhotograph, shown
from calibration.measurements.outlines._scenes import Scenes
from calibration.measurements.outlines.experiments import Photographs
from calibration.measurements.outlines.fidelity import Fidelity
from tisim import Result, simulate

EACH_EDGE = 40  # points of a predicted outline


def photographed(
    design: Photographs,
    state: State,
    scenes: Scenes,
    records: Sequence[TracedPhotograph],
    *,
    fidelity: Fidelity,
    workers: int | None,
) -> Experiment | None:
    """Experiment with one predicted photograph of each beam of which the design can have one.

    Parameters
    ----------
    design : the experiment.
    state : the state.
    scenes : scenes of the present photographs.
    records : the present photographs, of which the new ones have the contour error.
    fidelity, workers : as in `OutlineModel`.

    Returns
    -------
    Experiment or None
        None if no beam can have one, or a beam has no equilibrium.
    """
    changed = [design.trial(t) or t for t in scenes.trials]
    index = [i for i, t in enumerate(scenes.trials) if design.trial(t) is not None]
    if not index:
        return None
    new = replace(scenes, trials=changed, pose=design.pose)
    results = simulate(
        [new.beam(i, state, time=design.time, fidelity=fidelity) for i in index], workers=workers
    )
    if not all(r.ok for r in results):
        return None
    trials = []
    for i, r in zip(index, results, strict=True):
        old = next(p for p in records if p.beam == i)
        outline = _outline(r, old, new.images(i, state, time=design.time))
        trials.append(replace(changed[i], captures=(Capture(time=design.time, outline=outline),)))
    return replace(scenes.experiment, trials=tuple(trials))


def _outline(result: Result, old: TracedPhotograph, images: Sequence[Image]) -> TracedOutline:
    upper, lower = (shown(line, images) for line in edges(result))
    some = [line[np.linspace(0, len(line) - 1, EACH_EDGE).astype(int)] for line in (upper, lower)]
    return replace(old.outline, upper=some[0], lower=some[1])
