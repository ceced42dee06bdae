"""Nuisances as named columns: registration, section, free length, density, rig, simulation at the clamps.

A column is the change of the distances (measured minus simulated) if the true quantity is one sd larger than
simulated, as in `Noise`: r = e + columns b.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._state import State
from calibration.measurements.outlines._admitted import admitted
from calibration.measurements.outlines._noise import registration_columns
from calibration.measurements.outlines._photographs import TracedPhotograph, coefficients, projections_of
from calibration.measurements.outlines._scenes import Scenes
from calibration.measurements.outlines._solutions import SolutionCache, at_time, simulated
from tisim import Beam, Result, simulate

Array = NDArray[np.float64]
Named = list[tuple[str, Array]]

# sd [m] next to the singular corner of a clamp, where meshes that agree elsewhere to 0.02 mm differ by this
CORNER_SD = 8e-5
SHARED = "of all photographs"  # end of the names of errors that they share


def registrations(
    photographs: Sequence[TracedPhotograph], results: Sequence[Result], scenes: Scenes, state: State
) -> Named:
    """Change of the coefficients by one sd of each photograph's shift, roll and scale, own and shared [m]."""
    names = ("shift x", "shift z", "roll", "scale")
    columns, shared = [], np.zeros((len(names), photographs[-1].rows.stop))
    for p, r in zip(photographs, results, strict=True):
        both = projections_of(p, r, scenes.images(p.beam, state, time=p.time))
        block = np.vstack([registration_columns(f, p.outline.registration) for f in both])
        for what, column in zip(names, (p.basis.T @ block).T, strict=True):
            whole = np.zeros(photographs[-1].rows.stop)
            whole[p.rows] = column
            columns.append((f"{what} of {p.name}", whole))
        same = np.vstack([registration_columns(f, p.outline.shared) for f in both])
        shared[:, p.rows] = (p.basis.T @ same).T
    return [*columns, *((f"{what} {SHARED}", column) for what, column in zip(names, shared, strict=True))]


def beliefs(solutions: SolutionCache, base: Array, results: Sequence[Result], state: State) -> Named:
    """Change of the coefficients by one sd of each dimension, free length and density stated with a sd [m].

    Parameters
    ----------
    solutions : solutions of the photographs.
    base : coefficients of `results` [m].
    results : simulated beams at `state`, one per photograph.
    state : a state without effects that depend on time.
    """
    scenes, parts, beams = solutions.scenes, [], []
    first = {p.beam: r for p, r in zip(reversed(solutions.photographs), reversed(results), strict=True)}
    for name in dict.fromkeys(t.material for t in scenes.trials):
        mine = [i for i, t in enumerate(scenes.trials) if t.material == name]
        for n in admitted([scenes.trials[i] for i in mine], scenes.experiment.materials[name]):
            touched = [mine[i] for i in n.trials if mine[i] in first]
            parts.append((n, touched))
            for i in touched:
                solved = first[i].scene  # as it was solved, for any simulator
                assert isinstance(solved, Beam)
                beams.append(n.moved(solved))
    at_rest = all(b.solver.method == "static" for b in beams)
    moved = iter(simulated(beams, simulate if at_rest else solutions.simulator.run, solutions.workers))
    columns = []
    for n, touched in parts:
        there = {i: next(moved) for i in touched}
        change = np.zeros(len(base))
        for p in solutions.photographs:
            r = at_time(there.get(p.beam), p.time)
            if r is not None:
                images = scenes.images(p.beam, state, time=p.time)
                change[p.rows] = coefficients(p, r, images) - base[p.rows]
        columns.append((n.name, -change * (n.sd / n.step)))
    return columns


def doubts(solutions: SolutionCache, base: Array, state: State) -> Named:
    """Change of the coefficients by one sd of each independent direction of the rig's setup [m].

    base : coefficients at the state. ValueError if a beam then has no equilibrium.
    """
    setup = solutions.scenes.setup
    columns = []
    for name, off in [] if setup is None else setup.doubts():
        moved = replace(solutions, scenes=replace(solutions.scenes, setup=off))
        columns.append((name, base - moved.values_of(moved.answer(state), state)))
    return columns


def corners(photographs: Sequence[TracedPhotograph]) -> Named:
    """Error of the simulation next to a clamp, equal in all photographs of a trial [m]."""
    columns = []
    for trial in dict.fromkeys(p.beam for p in photographs):
        mine = [p for p in photographs if p.beam == trial]
        for k in range(mine[0].corners.shape[1]):
            whole = np.zeros(photographs[-1].rows.stop)
            for p in mine:
                whole[p.rows] = CORNER_SD * p.corners[:, k]
            columns.append((f"clamp corner {k + 1} of {mine[0].trial.id}", whole))
    return columns
