"""CMA-ES over a law's coordinates, a population as one batch of scenes; seeded, resumable, stoppable.

Resuming replays: the strategy is made anew from its seed and told the recorded costs, so a resumed search
takes the very steps of an uninterrupted one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray

from calibration.search.problem import Problem

Array = NDArray[np.float64]

NO_ANSWER = 1e12  # cost told for a candidate without equilibrium: worse than any that has one


@dataclass(frozen=True, kw_only=True)
class CmaOptions:
    """population: candidates a generation (None: 4 + 3 ln n). tolerance: stop when the best costs of
    the last generations agree to this [chi-square]; restarts: with twice the population each."""

    seed: int = 1
    population: int | None = None
    max_generations: int = 60
    tolerance: float = 0.5
    restarts: int = 0


@dataclass(frozen=True, eq=False, kw_only=True)
class Generation:
    """One generation: candidates (p, n), costs (p,) (inf: no answer), whether it was replayed."""

    restart: int
    index: int
    candidates: Array
    costs: Array
    replayed: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """Best candidate u (n,) and its cost; why the search ended; how many candidates had no answer."""

    u: Array
    cost: float
    reason: str
    generations: int
    evaluations: int
    without_answer: int


Told = Callable[[Generation], None]


def search(
    problem: Problem,
    *,
    start: Array,
    spread: Array,
    options: CmaOptions | None = None,
    history: Sequence[Generation] = (),
    told: Told = lambda _: None,
) -> Found:
    """Minimise the problem's cost from `start` with initial sd `spread` (n,), inside its bounds.

    history: generations of an earlier run of the same search; ValueError where they are of another.
    told: called after each generation; an exception from it (KeyboardInterrupt) ends the search there.
    A search whose whole first three generations have no answer ends with reason "no equilibrium".
    """
    options = options or CmaOptions()
    recorded = list(history)
    best_u, best = np.array(start, dtype=float), np.inf
    evaluations = failed = generations = 0
    reason = ""
    for restart in range(options.restarts + 1):
        strategy = _strategy(problem, start, spread, options, restart)
        for index in range(options.max_generations):
            candidates = np.array(strategy.ask())
            replayed = bool(recorded)
            if replayed:
                past = recorded.pop(0)
                if past.candidates.shape != candidates.shape or not np.allclose(
                    past.candidates, candidates, rtol=1e-9, atol=1e-12
                ):
                    raise ValueError("the recorded search is of another problem, seed or version")
                costs = past.costs
            else:
                costs = problem.costs(candidates)
            strategy.tell(list(candidates), np.where(np.isfinite(costs), costs, NO_ANSWER).tolist())
            generations, evaluations = generations + 1, evaluations + len(costs)
            failed += int(np.isinf(costs).sum())
            if costs.min() < best:
                best, best_u = float(costs.min()), candidates[costs.argmin()].copy()
            told(
                Generation(
                    restart=restart, index=index, candidates=candidates, costs=costs, replayed=replayed
                )
            )
            reason = _ended(strategy, best, index)
            if reason:
                break
        else:
            reason = f"{options.max_generations} generations"
        if reason == "no equilibrium":
            break
    return Found(
        u=best_u,
        cost=best,
        reason=reason,
        generations=generations,
        evaluations=evaluations,
        without_answer=failed,
    )


def _strategy(problem: Problem, start: Array, spread: Array, options: CmaOptions, restart: int) -> Any:
    bounds = problem.parametrisation.bounds
    rng = np.random.default_rng([options.seed, restart])
    population = options.population or 4 + int(3 * np.log(len(start)))
    return cma.CMAEvolutionStrategy(
        np.asarray(start, dtype=float).tolist(),
        1.0,
        {
            "bounds": [bounds[:, 0].tolist(), bounds[:, 1].tolist()],
            "CMA_stds": np.asarray(spread, dtype=float).tolist(),
            "popsize": population * 2**restart,
            # cma would otherwise draw from NumPy's global generator, which a caller's code may move
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,
            "tolfun": options.tolerance,
            "tolfunhist": options.tolerance / 10.0,
            "verbose": -9,
            "verb_log": 0,
            "verb_disp": 0,
        },
    )


def _ended(strategy: Any, best: float, index: int) -> str:
    if np.isinf(best):
        return "no equilibrium" if index >= 2 else ""
    stop = strategy.stop()
    return "converged: " + ", ".join(sorted(stop)) if stop else ""
