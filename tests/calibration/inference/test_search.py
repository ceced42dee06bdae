from __future__ import annotations

import numpy as np
import pytest
from toy_problems import mooney, mooney_problem, neo_problem

from calibration.inference import (
    CmaOptions,
    Generation,
    OfMaterial,
    Problem,
    guess,
    identify,
    polish,
    search,
)
from calibration.inference.search import PATIENCE
from calibration.parameters import parametrisation
from tisim import Material

TRUTH = Material(law="mooney-rivlin", parameters={"c10": 8e3, "c01": 4e3, "bulk": 1e6})


def noisy(seed: int) -> np.ndarray:
    return mooney(TRUTH) + np.random.default_rng(seed).standard_normal(30)


def run(options: CmaOptions, **more: object) -> tuple[object, list[Generation]]:
    problem = mooney_problem(noisy(0))
    p = problem.parametrisation
    seen: list[Generation] = []

    history = more.get("history", ())
    found = search(
        problem,
        start=p.start(shear=5e3),
        spread=p.spread,
        options=options,
        history=history,  # type: ignore[arg-type]
        on_progress=seen.append,
    )
    return found, seen


def test_search_finds_what_made_the_data() -> None:
    found, _ = run(CmaOptions(seed=3, tolerance=1e-6, max_generations=150))
    p = parametrisation("mooney-rivlin")
    assert p.moduli(found.u).shear_modulus == pytest.approx(24e3, rel=0.02)  # type: ignore[attr-defined]
    assert found.reason.startswith("converged")  # type: ignore[attr-defined]


def test_a_population_is_one_batch() -> None:
    problem = mooney_problem(noisy(0))
    p = problem.parametrisation
    search(problem, start=p.start(shear=5e3), spread=p.spread, options=CmaOptions(max_generations=4))
    assert problem.objectives[0].objective.batches == [7] * 4  # type: ignore[attr-defined]


def test_seeds_decide_the_search_and_nothing_else_does() -> None:
    options = CmaOptions(seed=5, max_generations=12)
    first, one = run(options)
    np.random.random(100)
    second, two = run(options)
    other, _ = run(CmaOptions(seed=6, max_generations=12))
    assert np.array_equal(first.u, second.u)  # type: ignore[attr-defined]
    assert all(np.array_equal(a.candidates, b.candidates) for a, b in zip(one, two, strict=True))
    assert not np.array_equal(first.u, other.u)  # type: ignore[attr-defined]


def test_a_stopped_search_goes_on_to_the_same_end() -> None:
    options = CmaOptions(seed=7, max_generations=15, restarts=1)
    whole, all_generations = run(options)
    kept: list[Generation] = []
    problem = mooney_problem(noisy(0))
    p = problem.parametrisation

    def stop(g: Generation) -> None:
        kept.append(g)
        if len(kept) == 18:  # in the second of two runs
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        search(problem, start=p.start(shear=5e3), spread=p.spread, options=options, on_progress=stop)
    resumed, seen = run(options, history=kept)
    assert sum(g.replayed for g in seen) == 18
    assert np.array_equal(resumed.u, whole.u)  # type: ignore[attr-defined]
    assert [g.costs.tolist() for g in seen] == [g.costs.tolist() for g in all_generations]


@pytest.mark.parametrize("begin", [2.1e4, 1.2e4, 2e3])
def test_what_is_held_is_not_searched_and_one_coordinate_takes_few_candidates(begin: float) -> None:
    problem = held_problem(2e4)
    p = problem.parametrisation
    seen: list[Generation] = []
    found = search(problem, start=p.start(shear=begin), spread=p.spread, on_progress=seen.append)
    assert found.reason == "converged: tolfun"
    assert problem.costs(found.u[None])[0] < CmaOptions().tolerance
    assert found.evaluations <= (30 if begin > 1e4 else 60)  # CMA-ES in two coordinates takes 190
    candidates = np.concatenate([g.candidates for g in seen])
    assert np.unique(candidates[:, 1]).tolist() == [np.log(300.0)]
    assert len(np.unique(candidates[:, 0])) == found.evaluations


def test_one_coordinate_whose_best_is_where_answers_end() -> None:
    problem = held_problem(1e4, fails=lambda m: m.parameters["mu"] < 1.5e4)
    p = problem.parametrisation
    found = search(problem, start=p.start(shear=1.7e4), spread=p.spread)
    assert found.reason == "converged: tolx"
    assert p.moduli(found.u).shear_modulus == pytest.approx(1.5e4, rel=1e-4)


def test_one_coordinate_whose_best_is_at_its_bound() -> None:
    problem = held_problem(1e9)
    p = problem.parametrisation
    found = search(problem, start=p.start(shear=1e5), spread=p.spread)
    assert found.reason.startswith("converged")
    assert found.u[0] == p.bounds[0, 1]


def held_problem(shear: float, **more: object) -> Problem:
    """Ten readings of a shear modulus, with fixed K/G."""
    p = neo_problem(np.full(10, 100.0 * np.log(shear)), **more)  # type: ignore[arg-type]
    law = p.parametrisation.holding("bulk_ratio")
    curve = p.objectives[0].objective  # type: ignore[attr-defined]
    return Problem(parametrisation=law, objectives=(OfMaterial(law, curve),))


def test_a_history_of_another_seed_is_refused() -> None:
    _, seen = run(CmaOptions(seed=1, max_generations=3))
    with pytest.raises(ValueError, match="another problem, seed or version"):
        run(CmaOptions(seed=2, max_generations=3), history=seen)


def test_candidates_without_answer_are_counted_and_passed_by() -> None:
    problem = neo_problem(np.full(10, 100.0 * np.log(2e4)), fails=lambda m: m.parameters["mu"] < 1.5e4)  # type: ignore[operator]
    p = problem.parametrisation
    found = search(
        problem, start=p.start(shear=1.7e4), spread=p.spread, options=CmaOptions(max_generations=40)
    )
    assert found.without_answer > 0
    assert p.moduli(found.u).shear_modulus == pytest.approx(2e4, rel=5e-3)


def test_a_law_without_any_answer_ends_at_once_and_says_so() -> None:
    problem = neo_problem(np.zeros(10), fails=lambda _: True)
    p = problem.parametrisation
    found = search(problem, start=p.start(shear=1e4), spread=p.spread)
    assert found.reason == "no equilibrium"
    assert found.generations == 3
    assert found.without_answer == found.evaluations
    assert np.isinf(found.cost)


def test_the_guess_is_near_whatever_the_size_of_the_modulus() -> None:
    for truth in (3e3, 7e4, 2e6):
        problem = neo_problem(np.full(10, 100.0 * np.log(truth)))
        u = guess(problem)
        assert u is not None
        assert problem.parametrisation.moduli(u).shear_modulus == pytest.approx(truth, rel=0.2)


def test_polish_ends_where_linear_algebra_says() -> None:
    y = noisy(1)
    problem = mooney_problem(y)
    p = problem.parametrisation
    end = polish(problem, p.start(shear=1e4))
    # linear in (c10, c01): the solution of linear least squares
    s = np.linspace(1.05, 2.5, 30)
    columns = 2.0 * (s - s**-2)[:, None] * np.column_stack([np.ones_like(s), 1.0 / s]) / 50.0
    c10, c01 = np.linalg.lstsq(columns, y, rcond=None)[0]
    found = p.parameters(end.u)
    assert end.converged
    # the polish ends at a predicted gain in chi-square below 0.1, within a third of a standard deviation
    sd = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    assert abs(found["c10"] - c10) < 0.33 * sd[0]  # type: ignore[operator]
    assert abs(found["c01"] - c01) < 0.33 * sd[1]  # type: ignore[operator]


def test_polish_stays_at_a_bound_and_identify_names_it() -> None:
    beyond = Material(law="mooney-rivlin", parameters={"c10": -2e3, "c01": 14e3, "bulk": 1e6})
    problem = mooney_problem(mooney(beyond))
    p = problem.parametrisation
    end = polish(problem, p.start(shear=2e4))
    share = p.values(end.u)["second_share"]
    assert share == pytest.approx(1.0)
    seen = {e.name: e.seen for e in identify(p, end.u, end.jacobian, reduced_chi2=1.0).estimates}
    assert seen["second_share"] == "at a bound"


def test_error_bars_are_those_of_linear_theory_and_blind_parameters_are_named() -> None:
    problem = neo_problem(np.full(10, 100.0 * np.log(2e4)))
    p = problem.parametrisation
    end = polish(problem, p.start(shear=1.9e4))
    known = identify(p, end.u, end.jacobian, reduced_chi2=0.4)
    shear, bulk = known.estimates
    assert shear.sd == pytest.approx(0.01 / np.sqrt(10), rel=1e-3)
    assert known.shear_modulus_sd == pytest.approx(2e4 * 0.01 / np.sqrt(10), rel=1e-3)
    assert shear.seen == "identified"
    assert bulk.seen == "not identified"
    assert [set(d) for d in known.blind] == [{"bulk_ratio"}]
    # a misfit widens the intervals, a small chi-square does not narrow them
    assert known.scale == 1.0
    assert identify(p, end.u, end.jacobian, reduced_chi2=4.0).estimates[0].sd == pytest.approx(2 * shear.sd)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    p = parametrisation("mooney-rivlin")
    inside = []
    for seed in range(60):
        problem = mooney_problem(noisy(100 + seed))
        end = polish(problem, p.start(shear=2e4))
        known = identify(p, end.u, end.jacobian, reduced_chi2=1.0)
        inside.append(
            [e.low <= t <= e.high for e, t in zip(known.estimates, (24e3, 1e6 / 24e3, 1 / 3), strict=True)]
        )
    share = np.mean(inside, axis=0)
    assert 0.86 <= share[0] <= 1.0
    assert 0.86 <= share[2] <= 1.0


def test_a_search_from_a_known_minimum_ends_soon_unless_it_finds_a_lower_one() -> None:
    """The end is the same if the generations are replayed."""
    p = parametrisation("mooney-rivlin")
    problem = mooney_problem(noisy(0))
    best, _ = run(CmaOptions(seed=3, tolerance=1e-6, max_generations=150))
    lowest: float = best.cost  # type: ignore[attr-defined]
    seen: list[Generation] = []
    options = CmaOptions(seed=3, tolerance=1e-6, max_generations=150)
    start, spread = p.start(shear=5e3), p.spread
    found = search(
        problem, start=start, spread=spread, options=options, known=0.5 * lowest, on_progress=seen.append
    )
    assert found.generations == PATIENCE
    assert found.reason.startswith("converged: no candidate of")
    again = search(problem, start=start, spread=spread, options=options, history=seen, known=0.5 * lowest)
    assert (again.generations, again.cost) == (found.generations, found.cost)
    beaten = search(problem, start=start, spread=spread, options=options, known=1e3 * lowest)
    assert beaten.generations > PATIENCE
    assert beaten.cost == pytest.approx(lowest, rel=1e-6)
