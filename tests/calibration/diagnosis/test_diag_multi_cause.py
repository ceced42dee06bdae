"""Three simultaneous causes, on formulas: found if pairs do not suffice, with equivalent explanations."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from fake_model import FakeModel, effect, library, noise, sigmas, waves

from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.multi_cause import with_third
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.search import Rules, fit_baseline, search
from calibration.measurements._effect import Candidate

THREE = ("bend", "kink", "slack")


def at_sigmas(name: str, size: float, **shapes: np.ndarray) -> np.ndarray:
    raw = {**library(), **shapes}[name]
    return np.asarray(raw * (size / sigmas(raw, FakeModel())))


def together(*names: str, size: float = 14.0) -> np.ndarray:
    return np.asarray(sum((-1.0) ** k * at_sigmas(n, size) for k, n in enumerate(names)))


@pytest.mark.parametrize("names", list(combinations(sorted(library()), 3)))
def test_three_causes_are_found_together(names: tuple[str, ...]) -> None:
    found = search(FakeModel(hidden=together(*names), drawn=noise(200)))
    assert found.verdict == "found"
    assert found.chosen is not None
    assert found.chosen.names == names


@pytest.mark.parametrize("most", [1, 2])
def test_no_more_than_asked_for_are_named(most: int) -> None:
    hidden = together(*THREE)
    for found in (
        search(FakeModel(hidden=hidden, drawn=noise(201)), rules=Rules(max_causes=most)),
        search(FakeModel(hidden=hidden, drawn=noise(201), max_causes=most)),
    ):
        assert found.verdict == "unexplained"
        assert max(len(e.names) for e in found.explanations) == most


def test_two_causes_are_not_made_three() -> None:
    tripled = 0
    for k in range(12):
        found = search(FakeModel(hidden=together("bend", "slack"), drawn=noise(210 + k)))
        tripled += len(found.explanations[0].names) > 2
    assert tripled <= 1


@pytest.mark.parametrize("of", THREE)
def test_what_would_do_as_well_as_one_of_three_is_named_too(of: str) -> None:
    shapes = library()
    shapes["twin"] = shapes[of] + 0.03 * shapes["ripple"]
    for k in range(2):
        found = search(FakeModel(shapes=shapes, hidden=together(*THREE), drawn=noise(230 + k)))
        other = tuple(sorted({*THREE, "twin"} - {of}))
        assert found.verdict == "ambiguous"
        assert {THREE, other} <= set(found.equivalent)


def test_stand_ins_are_tried_in_the_place_of_each() -> None:
    """With a single third cause beside a single pair no other step would find the twin."""
    for of in THREE:
        shapes = library()
        shapes["twin"] = shapes[of] + 0.03 * shapes["ripple"]
        model = FakeModel(shapes=shapes, hidden=together(*THREE), drawn=noise(260))
        found = search(model, rules=Rules(max_triples=(1, 1)))
        assert {THREE, tuple(sorted({*THREE, "twin"} - {of}))} <= set(found.equivalent), of


def beside(
    names: tuple[str, str], hidden: np.ndarray, seed: int, *, at: str = "all", scoped: tuple[str, ...] = ()
) -> tuple[list[Explanation], list[str]]:
    """Explanations from a third cause beside a pair, whose first cause has the scope `at`, and messages."""
    model = FakeModel(hidden=hidden, drawn=noise(seed), scoped=scoped)
    start = fit_baseline(model)
    linear = model.linearise(start.state, model.candidates)
    null = Null(len(linear.z), model.discrepancy_basis())
    sits = (
        next(c for c in model.candidates if (c.effect, c.at) == (names[0], at)),
        Candidate(effect=names[1]),
    )
    pair = explain(model, start, sits, [0.0, 0.0], null)
    assert pair is not None
    told: list[str] = []
    return with_third(model, start, [pair], null, Rules(), told.append), told


def test_a_third_without_which_the_pair_does_is_not_even_fitted() -> None:
    fitted = 0
    for k in range(12):
        _, told = beside(("bend", "slack"), together("bend", "slack"), 270 + k)
        fitted += any(t.startswith("confirming") for t in told)
    assert fitted <= 1


def test_each_of_three_may_sit_elsewhere_than_in_the_pair() -> None:
    """The true bend is in both materials, the pair's in one only; no other third cause compensates this."""
    found, _ = beside(("bend", "kink"), together(*THREE), 291, at="S0", scoped=("bend",))
    best = min(found, key=lambda e: e.score)
    assert {c.label for c in best.candidates} == set(THREE)


def test_three_others_than_the_pair_are_sought_too() -> None:
    found, told = beside(("slope", "ripple"), together(*THREE), 292)
    assert min(found, key=lambda e: e.score).names == THREE
    at_once = told[: next(k for k, t in enumerate(told) if t.startswith("looking for equivalents of"))]
    assert any(set(t.removeprefix("confirming ").split(" + ")) == set(THREE) for t in at_once)


def test_all_three_are_needed() -> None:
    """A third cause that makes a wrong cause of the pair superfluous leaves a pair, not three causes."""
    found, told = beside(("bend", "slope"), together("bend", "kink"), 290)
    assert any("kink" in t for t in told)
    assert found == []


def test_what_three_causes_leave_is_unexplained() -> None:
    shapes = library()
    ripple = shapes.pop("ripple")
    odd = 14.0 * waves(7)[:, 5] / np.linalg.norm(waves(7)[:, 5])
    for more in (odd, 14.0 * ripple):
        found = search(FakeModel(shapes=shapes, hidden=together(*THREE) + more, drawn=noise(240)))
        assert found.verdict == "unexplained"
        assert found.chosen is None


def test_causes_that_could_neither_leave_noise_nor_take_a_tenth_are_not_fitted() -> None:
    """Beside a large unexplained discrepancy, small causes are significant but change no verdict."""
    odd = 60.0 * waves(7)[:, 5] / np.linalg.norm(waves(7)[:, 5])
    fitted = {}
    for size in (7.0, 40.0):
        told: list[str] = []
        small = at_sigmas("kink", size) + at_sigmas("slack", size)
        hidden = at_sigmas("bend", 80.0) + small + odd
        search(FakeModel(hidden=hidden, drawn=noise(241)), on_progress=told.append)
        fitted[size] = [t for t in told if t.startswith("confirming") and "+" in t]
    assert fitted[7.0] == []
    assert any("kink" in t for t in fitted[40.0])


def test_a_third_that_ends_at_a_bound_is_none_but_where_physics_ends() -> None:
    reach = 14.0 / sigmas(library()["slack"], FakeModel())
    near = effect("slack", bounds=(-0.8 * reach, 0.8 * reach))
    for ends, named in (((), False), ((0.8 * reach,), True)):
        model = FakeModel(
            hidden=at_sigmas("bend", 14.0) + at_sigmas("kink", -14.0) + at_sigmas("slack", 14.0),
            drawn=noise(250),
            effects={"slack": replace(near, physical_limits=ends)},
        )
        sets = {e.names for e in search(model).explanations}
        assert (THREE in sets) == named
