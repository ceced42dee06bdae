"""Sets of causes as explanations: penalties, equivalent explanations, confidence of the first."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from fake_model import FakeModel, effect, library, noise, sigmas

from calibration.diagnosis.engine.explain import explain, ranked_first
from calibration.diagnosis.engine.explanation import Explanation, equivalent_explanations
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.null import Null
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State


def explained(model: FakeModel, *sets: tuple[Candidate, ...]) -> tuple[list[Explanation], Null]:
    null = Null(model.points, model.discrepancy_basis())
    baseline = fit(model, State(u=model.start()))
    found = [explain(model, baseline, s, [0.0] * len(s), null) for s in sets]
    assert all(e is not None for e in found)
    return [e for e in found if e is not None], null


def of(*names: str) -> tuple[Candidate, ...]:
    return tuple(Candidate(effect=n) for n in names)


def test_each_amplitude_and_each_choice_of_a_place_costs() -> None:
    model = FakeModel(scoped=("bend",), drawn=noise(1))
    (one, two, scoped), _ = explained(
        model, of("bend"), of("bend", "slope"), (Candidate(effect="bend", at="S0", alternatives=2),)
    )
    assert one.cost == pytest.approx(np.log(72))
    assert two.cost == pytest.approx(2.0 * np.log(72))
    assert scoped.cost == pytest.approx(np.log(72) + 2.0 * np.log(2))
    assert two.score == pytest.approx(two.fit.chi2 + two.cost)
    assert two.names == ("bend", "slope")


def test_a_first_guess_outside_of_what_makes_sense_is_brought_inside() -> None:
    model = FakeModel(effects={"bend": effect("bend", bounds=(0.0, 4.0))}, hidden=3.0 * library()["bend"])
    null = Null(model.points, {})
    baseline = fit(model, State(u=model.start()))
    found = explain(model, baseline, of("bend"), [1e6], null)
    assert found is not None
    assert found.fit.state.amplitudes[of("bend")[0]] == pytest.approx(3.0, abs=1e-3)


def test_a_guess_without_an_answer_is_tried_nearer_to_the_baseline() -> None:
    (bend,) = of("bend")
    far = FakeModel(hidden=2.0 * library()["bend"], no_answer=lambda s: s.amplitudes.get(bend, 0.0) > 5.0)
    baseline = fit(far, State(u=far.start()))
    found = explain(far, baseline, (bend,), [12.0], Null(far.points, {}))
    assert found is not None
    assert found.fit.state.amplitudes[bend] == pytest.approx(2.0, abs=1e-3)
    never = FakeModel(no_answer=lambda s: bend in s.amplitudes)
    baseline = fit(never, State(u=never.start()))
    assert explain(never, baseline, (bend,), [12.0], Null(never.points, {})) is None


def made(score: float, *names: str, constants: float = 0.0) -> Explanation:
    names = tuple(sorted(names))
    return SimpleNamespace(score=score, names=names, constants_cost=constants)  # type: ignore[return-value]


def test_rivals_are_what_comes_near_the_best() -> None:
    found = equivalent_explanations([made(30.0, "c"), made(10.0, "a"), made(15.9, "b"), made(16.1, "d")], 6.0)
    assert found == (("a",), ("b",))


def test_what_other_noise_would_often_rank_first_is_a_rival_too() -> None:
    some = [made(10.0, "a"), made(17.5, "b"), made(18.0, "c")]
    often = {("a",): 0.86, ("b",): 0.11, ("c",): 0.03}
    assert equivalent_explanations(some, 6.0, often, 0.1) == (("a",), ("b",))
    assert equivalent_explanations(some, 6.0, often, 0.2) == (("a",),)


def test_one_effect_in_two_places_is_one_rival() -> None:
    assert equivalent_explanations([made(10.0, "a"), made(11.0, "a"), made(12.0, "b")], 6.0) == (
        ("a",),
        ("b",),
    )


def test_a_set_that_only_adds_to_a_better_one_is_none() -> None:
    assert equivalent_explanations([made(10.0, "a"), made(12.0, "a", "b"), made(13.0, "c", "b")], 6.0) == (
        ("a",),
        ("b", "c"),
    )
    # a part of the best set is equivalent to it, and so is a superset of a worse set
    assert equivalent_explanations([made(10.0, "a", "b"), made(12.0, "a")], 6.0) == (("a", "b"), ("a",))


def test_a_richer_law_is_a_rival_of_several_causes_though_it_is_less_simple() -> None:
    pair, law = made(10.0, "a", "b"), made(40.0, "law", constants=27.0)
    assert equivalent_explanations([pair, law], 6.0) == (("a", "b"), ("law",))
    # no alternative: a worse fit with fewer constants, a law against one simpler cause, a law with two causes
    assert equivalent_explanations([pair, made(40.0, "law", constants=20.0)], 6.0) == (("a", "b"),)
    assert equivalent_explanations([made(10.0, "a"), law], 6.0) == (("a",),)
    more = made(40.0, "law", "c", "d", constants=27.0)
    assert equivalent_explanations([pair, more], 6.0) == (("a", "b"),)


def test_confidence_is_high_for_what_is_clear_and_even_for_what_is_not() -> None:
    shapes = library()
    shapes["twin"] = shapes["bend"] + 1e-4 * shapes["ripple"]
    hidden = 8.0 / sigmas(shapes["bend"], FakeModel()) * shapes["bend"]
    model = FakeModel(shapes=shapes, hidden=hidden, drawn=noise(2))
    (bend, twin, slope), null = explained(model, of("bend"), of("twin"), of("slope"))
    assert ranked_first([bend, slope], null)[bend.names] > 0.97
    assert ranked_first([bend, twin], null)[bend.names] == pytest.approx(0.5, abs=0.1)
    assert ranked_first([slope, bend], null) == ranked_first([bend, slope], null)
    assert ranked_first([bend], null) == {bend.names: 1.0}


@pytest.mark.parametrize("size", [2.0, 3.0, 4.0, 6.0])
def test_confidence_is_how_often_the_first_would_be_first_again(size: float) -> None:
    """Compared with refits of noise drawn here, about the truth predicted by the best explanation."""
    shapes = library()
    hidden = size / sigmas(shapes["bend"], FakeModel()) * shapes["bend"]
    model = FakeModel(hidden=hidden)
    both, null = explained(model, of("bend"), of("slope"))
    best, other = sorted(both, key=lambda e: e.score)
    again = 0
    for k in range(400):
        z = noise(5000 + k) + hidden
        left = [
            np.sum((z - j @ np.linalg.lstsq(j, z, rcond=None)[0]) ** 2)
            for j in (best.fit.jacobian, other.fit.jacobian)
        ]
        again += int(left[0] < left[1])
    expected = again / 400
    first = ranked_first(both, null)
    assert sum(first.values()) == pytest.approx(1.0)
    assert first[best.names] == pytest.approx(expected, abs=4.0 * np.sqrt(0.25 / 400 + 0.25 / 1000))
