"""First-order results of screening and of pairs, against linear least squares."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from fake_model import FakeModel, by_modulus, effect, library, noise, sigmas

from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.multi_cause import best_pairs, best_triples
from calibration.diagnosis.engine.screening import Screen, basis_of, screen
from calibration.measurements._effect import Candidate
from calibration.measurements._state import Linearisation, State


def linear(model: FakeModel) -> Linearisation:
    return model.linearise(State(u=model.truth), model.candidates)


def chi2(columns: np.ndarray, z: np.ndarray) -> float:
    left = z - columns @ np.linalg.lstsq(columns, z, rcond=None)[0]
    return float(left @ left)


def test_directions_are_what_the_moduli_cannot_do() -> None:
    model = FakeModel(scoped=("bend", "slope"), drawn=noise(1))
    at = linear(model)
    seen = screen(at, model.effects)
    assert seen.candidates == at.candidates
    assert np.abs(at.by_u.T @ seen.directions).max() < 1e-9
    assert np.linalg.norm(seen.directions, axis=0) == pytest.approx(1.0)
    assert seen.free.T @ seen.free == pytest.approx(np.eye(2), abs=1e-12)


def test_sizes_gains_and_amplitudes_are_those_of_least_squares() -> None:
    model = FakeModel(hidden=5.0 * library()["ripple"], drawn=noise(2))
    at = linear(model)
    seen = screen(at, model.effects)
    for k, c in enumerate(at.candidates):
        whole = np.column_stack([at.by_u, at.columns[:, k]])
        best = np.linalg.lstsq(whole, -at.z, rcond=None)[0]
        assert seen.improvements(at.z)[k] == pytest.approx(chi2(at.by_u, at.z) - chi2(whole, at.z))
        assert seen.amplitudes(at.z)[k] == pytest.approx(best[-1])
        assert seen.sizes[k] == pytest.approx(sigmas(model.column(c), model))
    together = seen.improvements(np.stack([at.z, 2.0 * at.z]))
    assert together == pytest.approx(np.stack([seen.improvements(at.z), 4.0 * seen.improvements(at.z)]))


def test_a_choice_of_places_has_its_price() -> None:
    model = FakeModel(scoped=("bend", "slope"), drawn=noise(3))
    at = linear(model)
    seen = screen(at, model.effects)
    choices = np.array([2.0 * np.log(c.alternatives) for c in model.candidates])
    assert choices.min() == 0.0
    assert choices.max() > 1.0
    assert seen.penalised(at.z) == pytest.approx(seen.improvements(at.z) - choices)
    assert seen.penalised(at.z[None])[0] == pytest.approx(seen.penalised(at.z))


def test_what_moduli_can_do_alone_is_not_seen() -> None:
    shapes = library() | {
        "density": 3.0 * by_modulus("S0") + 2.0 * by_modulus("S1"),
        "nothing": np.zeros(72),
    }
    model = FakeModel(shapes=shapes, drawn=noise(3))
    at = linear(model)
    seen = screen(at, model.effects)
    blind = [c.effect in ("density", "nothing") for c in at.candidates]
    assert (seen.sizes[blind] == 0.0).all()
    assert (seen.directions[:, blind] == 0.0).all()
    assert (seen.improvements(at.z)[blind] == 0.0).all()
    assert (seen.amplitudes(at.z)[blind] == 0.0).all()
    assert (seen.sizes[np.invert(blind)] > 0.1).all()


def test_what_is_left_of_a_column_decides_whether_it_is_seen() -> None:
    across = library()["bend"]
    for left, seen in ((1e-4, False), (3e-2, True)):
        shapes = {"nearly": by_modulus("S0") + left * np.linalg.norm(by_modulus("S0")) * across}
        model = FakeModel(shapes=shapes)
        assert (screen(linear(model), model.effects).sizes[0] > 0) == seen


def test_effects_that_are_there_are_projected_out_too() -> None:
    model = FakeModel(drawn=noise(4))
    at = linear(model)
    held = fit(model, State(u=model.truth), (Candidate(effect="bend"),))
    seen = screen(at, model.effects, held=held)
    assert np.abs(library()["bend"] @ seen.directions).max() < 1e-9
    assert seen.sizes[[c.effect == "bend" for c in at.candidates]] == pytest.approx(0.0)


def test_what_can_only_be_positive_gains_nothing_where_it_would_be_negative() -> None:
    only = {"bend": effect("bend", bounds=(0.0, 100.0))}
    for sign in (1.0, -1.0):
        model = FakeModel(effects=only, hidden=sign * 6.0 * library()["bend"])
        at = linear(model)
        seen = screen(at, model.effects)
        bend = [c.effect == "bend" for c in at.candidates]
        assert seen.upwards.tolist() == bend
        expected = 36.0 * sigmas(library()["bend"], model) ** 2 if sign > 0 else 0.0
        assert seen.improvements(at.z)[bend] == pytest.approx(expected)
        assert seen.improvements(at.z[None])[0, bend] == pytest.approx(expected)
    # an amplitude that a fit has already may decrease
    held = fit(model, State(u=model.truth), (Candidate(effect="bend"),))
    assert not screen(at, model.effects, held=held).upwards.any()


def test_a_basis_leaves_out_what_is_there_twice() -> None:
    a, b = library()["bend"], library()["slope"]
    basis = basis_of(np.column_stack([a, 1e6 * b, a + b, np.zeros(72)]))
    assert basis.shape == (72, 2)
    assert basis.T @ basis == pytest.approx(np.eye(2), abs=1e-12)
    assert basis @ (basis.T @ (a - 3.0 * b)) == pytest.approx(a - 3.0 * b)
    assert basis_of(np.zeros((72, 3))).shape == (72, 0)


def brute(at: Linearisation, of: int) -> list[tuple[float, frozenset[str]]]:
    """Sets of `of` effects by their improvement of chi-square in least squares, best first."""
    best: dict[frozenset[str], float] = {}
    base = chi2(at.by_u, at.z)
    for some in combinations(range(len(at.candidates)), of):
        members = [at.candidates[k] for k in some]
        names = frozenset(c.effect for c in members)
        if len(names) < of:
            continue
        gain = base - chi2(np.column_stack([at.by_u, at.columns[:, some]]), at.z)
        gain -= sum(2.0 * np.log(c.alternatives) for c in members)
        best[names] = max(best.get(names, -np.inf), gain)
    return sorted(((g, n) for n, g in best.items()), key=lambda p: -p[0])


def test_pairs_are_those_of_a_search_through_all() -> None:
    shapes = library()
    data = 4.0 * shapes["bend"] - 6.0 * shapes["slack"]
    model = FakeModel(scoped=tuple(shapes), hidden=data, drawn=noise(5))
    at = linear(model)
    found = best_pairs(screen(at, model.effects), at.z, count=4)
    names = [frozenset(at.candidates[k].effect for k in pair) for pair in found]
    assert names == [n for _, n in brute(at, 2)[:4]]
    assert names[0] == {"bend", "slack"}
    assert len(set(names)) == 4


def test_pairs_of_causes_that_are_one_and_of_unseen_ones_are_left_out() -> None:
    shapes = library() | {"density": by_modulus("S0")}
    shapes["twin"] = shapes["bend"] + 0.01 * shapes["ripple"]
    model = FakeModel(shapes=shapes, hidden=9.0 * shapes["bend"], drawn=noise(6))
    at = linear(model)
    found = best_pairs(screen(at, model.effects), at.z, count=100)
    names = [{at.candidates[k].effect for k in pair} for pair in found]
    assert {"bend", "twin"} not in names
    assert not any("density" in n for n in names)
    assert len(names) == 15 - 1  # pairs of six identifiable effects, without the twins


def test_threes_are_those_of_a_search_through_all() -> None:
    shapes = library()
    data = 4.0 * shapes["bend"] - 6.0 * shapes["slack"] + 5.0 * shapes["kink"]
    model = FakeModel(scoped=tuple(shapes), hidden=data, drawn=noise(5))
    at = linear(model)
    found = best_triples(screen(at, model.effects), at.z, count=6)
    names = [frozenset(at.candidates[k].effect for k in three) for three in found]
    assert names == [n for _, n in brute(at, 3)[:6]]
    assert names[0] == {"bend", "slack", "kink"}


def test_threes_of_which_one_would_be_less_than_nothing_are_left_out() -> None:
    shapes = library()
    data = 4.0 * shapes["bend"] - 6.0 * shapes["slack"] + 5.0 * shapes["kink"]
    upwards = {"slack": effect("slack", bounds=(0.0, 1e3))}
    model = FakeModel(hidden=data, drawn=noise(5), effects=upwards)
    at = linear(model)
    found = best_triples(screen(at, model.effects), at.z, count=10)
    names = [{at.candidates[k].effect for k in three} for three in found]
    assert names
    assert {"bend", "slack", "kink"} not in names


def test_no_threes_of_causes_that_are_one() -> None:
    shapes = library()
    shapes["twin"] = shapes["bend"] + 0.01 * shapes["ripple"]
    model = FakeModel(shapes=shapes, hidden=9.0 * shapes["bend"], drawn=noise(6))
    at = linear(model)
    found = best_triples(screen(at, model.effects), at.z, count=100)
    names = [{at.candidates[k].effect for k in three} for three in found]
    assert not any({"bend", "twin"} <= n for n in names)
    assert len(names) == 20 - 4  # triples of six effects, without those of both twins


def test_no_pairs_of_one_candidate() -> None:
    one = Screen(
        candidates=(Candidate(effect="bend"),),
        directions=library()["bend"][:, None],
        sizes=np.ones(1),
        upwards=np.zeros(1, dtype=bool),
        free=np.zeros((72, 0)),
    )
    assert best_pairs(one, noise(7), count=3) == []
    assert best_triples(one, noise(7), count=3) == []
