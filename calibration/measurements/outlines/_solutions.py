"""Solutions of states: shared scenes are solved once; corrections of simulator errors are interpolated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeGuard

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._state import State
from calibration.measurements.outlines._photographs import TracedPhotograph, coefficients
from calibration.measurements.outlines._scenes import Scenes, hanging
from calibration.measurements.outlines.fidelity import Fidelity
from calibration.measurements.outlines.simulators import Simulator
from tisim import Beam, Result, simulate

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class SolutionCache:
    """Simulated beams of photographs.

    Attributes
    ----------
    scenes : scenes of the trials.
    photographs : photographs to simulate.
    simulator : simulator of the beams.
    workers : number of processes; None for all cores.
    """

    scenes: Scenes
    photographs: Sequence[TracedPhotograph]
    simulator: Simulator
    workers: int | None

    @property
    def surrogate(self) -> SolutionCache:
        """Solutions whose derivatives guide a search: this object, unless its simulator has a surrogate."""
        return (
            self if self.simulator.surrogate is None else replace(self, simulator=self.simulator.as_surrogate)
        )

    def corrected_by(self, name: str) -> SolutionCache:
        """Solutions from which the correction of a simulator error is computed.

        This object if the corrected beams are static, else the surrogate.
        """
        beam = self.scenes.beam(0, self._any, time=1.0, fidelity=self.simulator.fidelity)
        return self if self._corrected(beam, name).solver.method == "static" else self.surrogate

    def values(self, wanted: Sequence[State]) -> list[Array]:
        """Coefficients of the distances of all photographs [m], shape (points,), for each state.

        NaN for photographs whose beam has no equilibrium.
        """
        found = [
            self.values_of(results, one) for one, results in zip(wanted, self.solve(wanted), strict=True)
        ]
        plain = [values.copy() for values in found]
        for name in dict.fromkeys(n for one in wanted for n in self._faults(one)):
            some = [k for k, one in enumerate(wanted) if name in self._faults(one)]
            there = [wanted[k] for k in some]
            own = self.corrected_by(name)
            better = [
                self.values_of(r, one) for one, r in zip(there, own.solve(there, instead=name), strict=True)
            ]
            worse = (
                [plain[k] for k in some]
                if own is self
                else [self.values_of(r, one) for one, r in zip(there, own.solve(there), strict=True)]
            )
            for k, good, bad in zip(some, better, worse, strict=True):
                found[k] += self._faults(wanted[k])[name] * (good - bad)
        return found

    def values_of(self, results: Sequence[Result | None], state: State) -> Array:
        """Coefficients of the distances from simulated beams [m], shape (points,); NaN without a result."""
        return np.concatenate(
            [
                np.full(p.basis.shape[1], np.nan)
                if r is None
                else coefficients(p, r, self.scenes.images(p.beam, state, time=p.time))
                for p, r in zip(self.photographs, results, strict=True)
            ]
        )

    def solve(self, wanted: Sequence[State], *, instead: str | None = None) -> list[list[Result | None]]:
        """One result per photograph for each state; None if it has no equilibrium.

        instead : name of a simulator error without which the beams are simulated.
        """
        beams: list[Beam] = []
        known: dict[tuple[object, ...], int] = {}
        rows: list[list[int]] = [[] for _ in wanted]
        times: list[set[float]] = []
        for p in self.photographs:  # photograph by photograph, so that neighbours in the batch share a mesh
            for row, state in zip(rows, wanted, strict=True):
                key = self.scenes.key(p.beam, state, time=p.time)
                if key not in known:
                    known[key] = len(beams)
                    beam = self.scenes.beam(p.beam, state, time=p.time, fidelity=self.simulator.fidelity)
                    beams.append(beam if instead is None else self._corrected(beam, instead))
                    times.append(set())
                row.append(known[key])
                times[known[key]].add(p.time)
        run = self.simulator.run if instead is None else simulate
        results = simulated(
            [_photographed(b, t) for b, t in zip(beams, times, strict=True)], run, self.workers
        )
        return [
            [at_time(results[k], p.time) for k, p in zip(row, self.photographs, strict=True)] for row in rows
        ]

    def answer(self, state: State) -> Sequence[Result]:
        """One result per photograph; the first simulator error of an amplitude above 0.5 is corrected.

        ValueError if a beam has no equilibrium.
        """
        corrected = [n for n, part in self._faults(state).items() if part > 0.5]
        own = self.corrected_by(corrected[0]) if corrected else self
        found = own.solve([state], instead=corrected[0] if corrected else None)[0]
        if not complete(found):
            raise ValueError("no equilibrium at this state")
        return found

    def fine(
        self, state: State, reference: Fidelity, *, one_by_one: bool = False
    ) -> tuple[Sequence[Result], str]:
        """One result per photograph on a finer mesh; if a beam has no equilibrium, none and the reason.

        one_by_one : if True, solve the longest beam first, which fails if any does, and stop at the first
        failure: a beam without equilibrium costs a hundred times one that has it.
        """
        trials = self.scenes.trials
        longest = sorted(range(len(trials)), key=lambda i: -trials[i].free_length)
        found: dict[int, Result | None] = {}
        for some in [[i] for i in longest] if one_by_one else [list(range(len(trials)))]:
            beams = [
                _photographed(
                    self.scenes.beam(i, state, time=1.0, fidelity=reference),
                    {p.time for p in self.photographs if p.beam == i} or {1.0},
                )
                for i in some
            ]
            found.update(zip(some, simulated(beams, simulate, self.workers), strict=True))
            failed = [trials[i].id for i, r in found.items() if r is None]
            if failed:
                return [], f"no equilibrium of {', '.join(failed)} on the finer mesh that corrects"
        return [r for p in self.photographs if (r := at_time(found[p.beam], p.time)) is not None], ""

    def _faults(self, state: State) -> dict[str, float]:
        """Amplitudes of the corrections of simulator errors, by effect."""
        parts: dict[str, float] = {}
        for c, a in state.amplitudes.items():
            parts[c.effect] = parts.get(c.effect, 0.0) + a
        return {n: a for n, a in parts.items() if a != 0.0 and self.scenes.effects[n].instead is not None}

    @property
    def _any(self) -> State:
        return State(u=self.scenes.baseline.start(dict.fromkeys(self.scenes.baseline.specimens, 1e4)))

    def _corrected(self, beam: Beam, name: str) -> Beam:
        instead = self.scenes.effects[name].instead
        assert instead is not None
        return instead(beam)


def at_time(result: Result | None, time: float) -> Result | None:
    """Result of a beam with a course at the frame nearest to a time [s]; others are returned unchanged."""
    if result is None or result.time is None or getattr(result.scene, "course", None) is None:
        return result
    k = int(np.argmin(np.abs(result.time - time)))
    return replace(result, positions=result.positions[k][None])


def _photographed(beam: Beam, times: set[float]) -> Beam:
    """Beam with frames at the times of its photographs [s], if it has a course."""
    return beam if beam.course is None else hanging(beam, sorted(times))


def complete(results: Sequence[Result | None]) -> TypeGuard[Sequence[Result]]:
    return all(r is not None for r in results)


def simulated(beams: Sequence[Beam], run: object, workers: int | None) -> list[Result | None]:
    """Results of beams; None for a beam without equilibrium, or an invalid one, which a search may try."""
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
