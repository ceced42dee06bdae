"""Global search: a scan of the shear modulus for a start, then CMA-ES, a population as one batch of scenes.

A coordinate that is held is not searched: its prior would draw each candidate back to the same value. Where
one is left, the generations are sections of a line, not random (`calibration.inference._section`).
The search is seeded, resumable and stoppable. Resuming replays: the strategy is made anew from its seed and
given the recorded costs, so a resumed search takes the very steps of an uninterrupted one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.errors import OptionError
from calibration.inference._section import Section
from calibration.inference.problem import Problem, Suggesting

Array = NDArray[np.float64]

LOWEST, HIGHEST = 1e3, 1e7  # of the coarse scan [Pa]


def guess(problem: Problem) -> Array | None:
    """Start u (n,) by two scans over the shear modulus, 9 values each; None where none has an answer.

    It is good to a few per cent: nuisances are taken roughly. An objective that answers only near its best
    (a vibration, whose phase is compared) says itself where to begin.
    """
    for objective in problem.objectives:
        try:
            begin = objective.suggested_start() if isinstance(objective, Suggesting) else None
        except ValueError:
            return None
        if begin is not None:
            return begin
    p = problem.parametrisation
    shears = np.geomspace(LOWEST, HIGHEST, 9)
    best: Array | None = None
    for _ in range(2):
        starts = np.array([p.start(shear=g) for g in shears])
        # nuisances are taken at the stiffest: a small deflection always has an answer
        if not problem.linearise(starts[-1] if best is None else best, rough=True):
            return None
        costs = problem.costs(starts)
        if not np.isfinite(costs).any():
            return None
        k = int(costs.argmin())
        best = starts[k]
        ratio = shears[1] / shears[0]
        shears = np.geomspace(shears[k] / ratio, shears[k] * ratio, 9)
    return best


NO_ANSWER = 1e12  # cost given to a candidate without equilibrium: worse than any that has one
PATIENCE = 10  # generations in which the end of a descent may be beaten


class HistoryError(ValueError):
    """A recorded search that the present one does not repeat."""


@dataclass(frozen=True, kw_only=True)
class CmaOptions:
    """Options of the global search.

    Attributes
    ----------
    seed : int
        0 or more.
    population : int, optional
        Candidates a generation; 4 + 3 ln n where left out.
    max_generations : int
    tolerance : float
        The search stops when the best costs of the last generations agree to this [chi-square].
    restarts : int
        Number of restarts, with twice the population each.
    """

    seed: int = 1
    population: int | None = None
    max_generations: int = 60
    tolerance: float = 0.5
    restarts: int = 0

    def __post_init__(self) -> None:
        for name, least in (("seed", 0), ("population", 4), ("max_generations", 1), ("restarts", 0)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise OptionError(name.removeprefix("max_"), value, f"expected {least} or more")
        if self.seed >= 2**32:
            raise OptionError("seed", self.seed, f"expected less than {2**32}")


@dataclass(frozen=True, eq=False, kw_only=True)
class Generation:
    """One generation of a search.

    Attributes
    ----------
    restart, index : int
    candidates : array, shape (p, n)
    costs : array, shape (p,)
        Infinite for a candidate without equilibrium.
    replayed : bool
        Taken from a history, not computed.
    """

    restart: int
    index: int
    candidates: Array
    costs: Array
    replayed: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """Result of a search.

    Attributes
    ----------
    u : array, shape (n,)
        Best candidate.
    cost : float
    reason : str
        Why the search ended; begins with "converged" where it did.
    generations, evaluations, without_answer : int
        Candidates without equilibrium are counted in the last.
    """

    u: Array
    cost: float
    reason: str
    generations: int
    evaluations: int
    without_answer: int


OnProgress = Callable[[Generation], None]


def search(
    problem: Problem,
    *,
    start: Array,
    spread: Array,
    options: CmaOptions | None = None,
    history: Sequence[Generation] = (),
    known: float = np.inf,
    on_progress: OnProgress = lambda _: None,
) -> Found:
    """Minimise the problem's cost by CMA-ES, or along one coordinate by sections, inside its bounds.

    Held coordinates stay at `start`. A search whose whole first three generations have no answer ends with
    reason "no equilibrium". One that sets out from where a descent ended looks for a lower valley; it ends
    where `PATIENCE` generations found none.

    Parameters
    ----------
    problem : Problem
    start, spread : array, shape (n,)
        Mean and standard deviations of the first generation.
    options : CmaOptions
    history : sequence of Generation
        Generations of an earlier run of the same search; they are replayed without a simulation.
    known : float
        Cost of the point where a descent ended; infinite without one.
    on_progress : callable
        Called after each generation; an exception from it (KeyboardInterrupt) ends the search there.

    Raises
    ------
    HistoryError
        The history is of another problem, seed or version.
    """
    options = options or CmaOptions()
    recorded = list(history)
    bounds = problem.parametrisation.bounds
    begin = np.array(start, dtype=float)
    searched = np.array([not c.held for c in problem.parametrisation.coordinates])
    best_u, best = np.array(start, dtype=float), np.inf
    evaluations = failed = generations = 0
    reason = ""
    for restart in range(options.restarts + 1):
        strategy = _strategy(begin[searched], spread[searched], bounds[searched], options, restart)
        for index in range(options.max_generations):
            candidates = np.tile(begin, (strategy.popsize, 1))
            candidates[:, searched] = np.array(strategy.ask())
            replayed = bool(recorded)
            if replayed:
                past = recorded.pop(0)
                if past.candidates.shape != candidates.shape or not np.allclose(
                    past.candidates, candidates, rtol=1e-9, atol=1e-12
                ):
                    raise HistoryError("the recorded search is of another problem, seed or version")
                costs = past.costs
            else:
                costs = problem.costs(candidates)
            strategy.tell(
                list(candidates[:, searched]), np.where(np.isfinite(costs), costs, NO_ANSWER).tolist()
            )
            generations, evaluations = generations + 1, evaluations + len(costs)
            failed += int(np.isinf(costs).sum())
            if costs.min() < best:
                best, best_u = float(costs.min()), candidates[costs.argmin()].copy()
            on_progress(
                Generation(
                    restart=restart, index=index, candidates=candidates, costs=costs, replayed=replayed
                )
            )
            reason = _ended(strategy, best, index, known)
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


def _strategy(start: Array, spread: Array, bounds: Array, options: CmaOptions, restart: int) -> Any:
    population = (options.population or 4 + int(3 * np.log(len(start)))) * 2**restart
    if len(start) == 1:
        return Section(
            float(start[0]),
            float(spread[0]),
            bounds=(float(bounds[0, 0]), float(bounds[0, 1])),
            popsize=population,
            tolerance=options.tolerance,
        )
    import cma  # imported when needed: it takes a second with the plotting it brings along

    rng = np.random.default_rng([options.seed, restart])
    return cma.CMAEvolutionStrategy(
        start.tolist(),
        1.0,
        {
            "bounds": [bounds[:, 0].tolist(), bounds[:, 1].tolist()],
            "CMA_stds": spread.tolist(),
            "popsize": population,
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


def _ended(strategy: Any, best: float, index: int, known: float) -> str:
    if np.isfinite(known) and best >= known and index + 1 >= PATIENCE:
        return f"converged: no candidate of {PATIENCE} generations is below where the descent ended"
    if np.isinf(best):
        return "no equilibrium" if index >= 2 and np.isinf(known) else ""
    stop = strategy.stop()
    return "converged: " + ", ".join(sorted(stop)) if stop else ""
