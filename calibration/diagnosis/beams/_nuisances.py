"""What the lab admits not to know, as columns: where each photograph lies, radius, free length, density."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams._pictures import Picture, coefficients, feet_of
from calibration.diagnosis.beams._scenes import Scenes
from calibration.diagnosis.nested import State
from calibration.outlines import Fidelity, admitted, registration_columns
from tisim import Result, simulate

Array = NDArray[np.float64]


def registrations(
    pictures: Sequence[Picture], results: Sequence[Result], scenes: Scenes, state: State
) -> list[Array]:
    """What one sd of each photograph's shift, roll and scale does to the coefficients [m]."""
    columns = []
    for p, r in zip(pictures, results, strict=True):
        both = feet_of(p, r, scenes.images(p.trial, state, time=p.time))
        block = np.vstack([registration_columns(f, p.outline.registration) for f in both])
        for column in (p.basis.T @ block).T:
            whole = np.zeros(pictures[-1].rows.stop)
            whole[p.rows] = column
            columns.append(whole)
    return columns


def beliefs(
    pictures: Sequence[Picture],
    base: Array,
    scenes: Scenes,
    state: State,
    *,
    fidelity: Fidelity,
    workers: int | None,
) -> list[Array]:
    """What one sd of each radius, free length and density that is stated with a sd does to the coefficients.

    base: those of `state` [m], which has no effect that differs in time.
    """
    parts = []
    beams = []
    for name in dict.fromkeys(t.material for t in scenes.trials):
        mine = [i for i, t in enumerate(scenes.trials) if t.material == name]
        for n in admitted([scenes.trials[i] for i in mine], scenes.experiment.materials[name]):
            touched = [mine[i] for i in n.trials]
            parts.append((n, touched))
            beams += [n.moved(scenes.beam(i, state, time=1.0, fidelity=fidelity)) for i in touched]
    solved = iter(simulate(beams, workers=workers))
    columns = []
    for n, touched in parts:
        moved = {i: next(solved) for i in touched}
        change = np.zeros(len(base))
        for p in pictures:
            if p.trial in moved and moved[p.trial].ok:
                images = scenes.images(p.trial, state, time=p.time)
                change[p.rows] = coefficients(p, moved[p.trial], images) - base[p.rows]
        columns.append(change * (n.sd / n.step))
    return columns
