"""Solves states: scenes that several photographs or states share once, and simulator faults by blending."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeGuard

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams._pictures import Picture, coefficients
from calibration.diagnosis.beams._scenes import Nudge, Scenes
from calibration.diagnosis.beams.simulators import Simulator
from calibration.diagnosis.nested import State
from calibration.outlines import Fidelity
from tisim import Beam, Result, simulate

Array = NDArray[np.float64]
Wanted = tuple[State, Nudge | None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Bank:
    """How the photographs of some trials are simulated; workers: processes (None: all cores)."""

    scenes: Scenes
    pictures: Sequence[Picture]
    simulator: Simulator
    workers: int | None

    @property
    def guide(self) -> Bank:
        """By whose differences a search finds its way: this one, unless its simulator names another."""
        return self if self.simulator.guide is None else replace(self, simulator=self.simulator.guiding)

    def mends(self, name: str) -> Bank:
        """The one in whose beams mending a fault of the simulator is seen: this one if they are then at rest,
        else that which guides."""
        beam = self.scenes.beam(0, self._any, time=1.0, fidelity=self.simulator.fidelity)
        return self if self._mended(beam, name).solver.method == "static" else self.guide

    def values(self, wanted: Sequence[Wanted]) -> list[Array]:
        """Smooth coefficients of the distances of all photographs [m], (points,) for each state; NaN where a
        photograph's beam has no equilibrium."""
        found = [
            self.values_of(results, *one) for one, results in zip(wanted, self.solve(wanted), strict=True)
        ]
        plain = [values.copy() for values in found]
        for name in dict.fromkeys(n for one in wanted for n in self._faults(*one)):
            some = [k for k, one in enumerate(wanted) if name in self._faults(*one)]
            there = [wanted[k] for k in some]
            bank = self.mends(name)
            better = [
                self.values_of(r, *one) for one, r in zip(there, bank.solve(there, instead=name), strict=True)
            ]
            worse = (
                [plain[k] for k in some]
                if bank is self
                else [self.values_of(r, *one) for one, r in zip(there, bank.solve(there), strict=True)]
            )
            for k, good, bad in zip(some, better, worse, strict=True):
                found[k] += self._faults(*wanted[k])[name] * (good - bad)
        return found

    def values_of(self, results: Sequence[Result | None], state: State, nudge: Nudge | None = None) -> Array:
        """Smooth coefficients of the distances from simulated beams [m], (points,)."""
        return np.concatenate(
            [
                np.full(p.basis.shape[1], np.nan)
                if r is None
                else coefficients(p, r, self.scenes.images(p.trial, state, time=p.time, nudge=nudge))
                for p, r in zip(self.pictures, results, strict=True)
            ]
        )

    def solve(self, wanted: Sequence[Wanted], *, instead: str | None = None) -> list[list[Result | None]]:
        """One result a photograph for each state, None where it has no equilibrium.

        instead: the simulator's fault without which the beams are to be simulated.
        """
        beams: list[Beam] = []
        known: dict[tuple[object, ...], int] = {}
        rows: list[list[int]] = [[] for _ in wanted]
        for p in self.pictures:  # photograph by photograph, so that neighbours in the batch share a mesh
            for row, (state, nudge) in zip(rows, wanted, strict=True):
                key = self.scenes.key(p.trial, state, time=p.time, nudge=nudge)
                if key not in known:
                    known[key] = len(beams)
                    beam = self.scenes.beam(
                        p.trial, state, time=p.time, fidelity=self.simulator.fidelity, nudge=nudge
                    )
                    beams.append(beam if instead is None else self._mended(beam, instead))
                row.append(known[key])
        run = self.simulator.run if instead is None else simulate
        results = simulated(beams, run, self.workers)
        return [[results[k] for k in row] for row in rows]

    def answer(self, state: State) -> Sequence[Result]:
        """One result a photograph, without those faults of the simulator that the state names. ValueError
        where a beam has no equilibrium."""
        mended = [n for n, part in self._faults(state, None).items() if part > 0.5]
        bank = self.mends(mended[0]) if mended else self
        found = bank.solve([(state, None)], instead=mended[0] if mended else None)[0]
        if not complete(found):
            raise ValueError("no equilibrium at this state")
        return found

    def fine(self, state: State, reference: Fidelity) -> tuple[Sequence[Result], str]:
        """One result a photograph on a finer mesh; none, and why, where a beam has no equilibrium there."""
        trials = self.scenes.trials
        beams = [self.scenes.beam(i, state, time=1.0, fidelity=reference) for i in range(len(trials))]
        results = simulated(beams, simulate, self.workers)
        failed = [t.id for t, r in zip(trials, results, strict=True) if r is None]
        if failed:
            return [], f"no equilibrium of {', '.join(failed)} on the finer mesh that corrects"
        return [r for p in self.pictures if (r := results[p.trial]) is not None], ""

    def _faults(self, state: State, nudge: Nudge | None) -> dict[str, float]:
        """Parts of the simulator's faults that are taken away."""
        parts = {c.effect: a for c, a in state.amplitudes.items()}
        if nudge is not None:
            parts[nudge.kind[0]] = parts.get(nudge.kind[0], 0.0) + nudge.step
        return {n: a for n, a in parts.items() if a != 0.0 and self.scenes.effects[n].instead is not None}

    @property
    def _any(self) -> State:
        return State(u=np.full(max(self.scenes.specimen) + 1, np.log(1e4)))

    def _mended(self, beam: Beam, name: str) -> Beam:
        instead = self.scenes.effects[name].instead
        assert instead is not None
        return instead(beam)


def complete(results: Sequence[Result | None]) -> TypeGuard[Sequence[Result]]:
    return all(r is not None for r in results)


def simulated(beams: Sequence[Beam], run: object, workers: int | None) -> list[Result | None]:
    """Results, None for a beam that has no equilibrium or that cannot be: a search tries odd ones too."""
    assert callable(run)
    try:
        results: list[Result] = run(beams, workers=workers)
    except ValueError:
        results = []
        for b in beams:
            results += _alone(b, run)
        return [r if r is not None and r.ok else None for r in results]
    return [r if r.ok else None for r in results]


def _alone(beam: Beam, run: object) -> list[Result]:
    assert callable(run)
    try:
        return list(run([beam], workers=1))
    except ValueError:
        return [None]  # type: ignore[list-item]
