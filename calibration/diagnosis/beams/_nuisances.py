"""What the lab admits not to know, as columns: where each photograph lies, radius, free length, density."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams._bank import Bank, simulated
from calibration.diagnosis.beams._pictures import Picture, coefficients, feet_of
from calibration.diagnosis.beams._scenes import Scenes
from calibration.diagnosis.nested import State
from calibration.outlines import admitted, registration_columns
from tisim import Beam, Result, simulate

Array = NDArray[np.float64]

# [m]: meshes that agree elsewhere to 0.02 mm differ by this next to the singular corner of a clamp
CORNER_SD = 8e-5


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


def beliefs(bank: Bank, base: Array, results: Sequence[Result], state: State) -> list[Array]:
    """What one sd of each radius, free length and density that is stated with a sd does to the coefficients.

    base: those of `results` [m], the answer of `state`, which has no effect that differs in time.
    """
    scenes, parts, beams = bank.scenes, [], []
    first = {p.trial: r for p, r in zip(reversed(bank.pictures), reversed(results), strict=True)}
    for name in dict.fromkeys(t.material for t in scenes.trials):
        mine = [i for i, t in enumerate(scenes.trials) if t.material == name]
        for n in admitted([scenes.trials[i] for i in mine], scenes.experiment.materials[name]):
            touched = [mine[i] for i in n.trials if mine[i] in first]
            parts.append((n, touched))
            for i in touched:
                solved = first[i].scene  # whatever the simulator, as the answer was solved
                assert isinstance(solved, Beam)
                beams.append(n.moved(solved))
    at_rest = all(b.solver.method == "static" for b in beams)
    moved = iter(simulated(beams, simulate if at_rest else bank.simulator.run, bank.workers))
    columns = []
    for n, touched in parts:
        there = {i: next(moved) for i in touched}
        change = np.zeros(len(base))
        for p in bank.pictures:
            r = there.get(p.trial)
            if r is not None:
                images = scenes.images(p.trial, state, time=p.time)
                change[p.rows] = coefficients(p, r, images) - base[p.rows]
        columns.append(change * (n.sd / n.step))
    return columns


def corners(pictures: Sequence[Picture]) -> list[Array]:
    """What the simulation may get wrong next to a clamp, the same in all photographs of a trial [m]."""
    columns = []
    for trial in dict.fromkeys(p.trial for p in pictures):
        mine = [p for p in pictures if p.trial == trial]
        for k in range(mine[0].corners.shape[1]):
            whole = np.zeros(pictures[-1].rows.stop)
            for p in mine:
                whole[p.rows] = CORNER_SD * p.corners[:, k]
            columns.append(whole)
    return columns
