"""Verdicts of the search, on formulas: hidden causes are found, and no others."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import pytest
from fake_model import MATERIALS, FakeModel, by_modulus, library, noise, of_material, sigmas, waves
from scipy.stats import binom

from calibration.diagnosis.engine.search import Finding, Rules, fit_baseline, search
from calibration.measurements._effect import Candidate, EffectModel
from calibration.measurements._state import State


def at_sigmas(name: str, size: float, *, material: str = "all") -> np.ndarray:
    """Column of an effect with a norm of `size` sigmas after the moduli are projected out."""
    raw = library()[name]
    raw = raw if material == "all" else np.where(of_material(material), raw, 0.0)
    return np.asarray(raw * (size / sigmas(raw, FakeModel())))


def test_noise_alone_is_seldom_a_verdict() -> None:
    rules = Rules()
    verdicts = [search(FakeModel(scoped=("bend", "slope"), drawn=noise(k))).verdict for k in range(100)]
    alarms = sum(v != "none" for v in verdicts)
    assert alarms <= binom.ppf(0.999, 100, rules.false_alarm_rate + rules.lack_of_fit_level)


def test_alarms_come_as_often_as_the_rules_allow() -> None:
    loose = Rules(false_alarm_rate=0.3, lack_of_fit_level=1e-9, extra_cause_rate=1e-9)
    verdicts = [search(FakeModel(drawn=noise(k)), rules=loose).verdict for k in range(40)]
    alarms = sum(v != "none" for v in verdicts)
    assert binom.ppf(0.001, 40, 0.3) <= alarms <= binom.ppf(0.999, 40, 0.3)


@pytest.mark.parametrize("name", list(library()))
def test_an_effect_of_seven_sigmas_is_found(name: str) -> None:
    right = 0
    for k in range(4):
        model = FakeModel(hidden=(-1.0) ** k * at_sigmas(name, 7.5), drawn=noise(1000 + k))
        found = search(model)
        right += found.verdict == "found" and found.chosen.names == (name,)  # type: ignore[union-attr]
        assert found.explanations[0].names == (name,)
        (c,) = found.explanations[0].candidates
        value, sd = found.explanations[0].fit.amplitude(c)
        assert sd == pytest.approx(1.0 / sigmas(library()[name], model), rel=1e-6)
        assert value == pytest.approx((-1.0) ** k * 7.5 * sd, abs=4.0 * sd)
    assert right >= 3


def test_a_curved_response_hides_nothing() -> None:
    model = FakeModel(hidden=at_sigmas("ripple", 10.0), drawn=noise(50), bent=0.003)
    found = search(model)
    assert found.verdict == "found"
    assert found.equivalent == (("ripple",),)


@dataclass(frozen=True, kw_only=True)
class Instant(EffectModel):
    simulated = False  # type: ignore[assignment]


def test_what_costs_no_simulation_is_fitted_whatever_it_promises() -> None:
    """A column predicts little of a strongly nonlinear effect. Predicted improvements are 49 and 400."""
    both = at_sigmas("bend", 20.0) + at_sigmas("ripple", 7.0)
    plain = FakeModel(hidden=both, drawn=noise(51))
    instant = Instant(**{f.name: getattr(plain.effects["ripple"], f.name) for f in fields(EffectModel)})
    other = FakeModel(hidden=both, drawn=noise(51), effects={"ripple": instant})
    for model, fitted in ((plain, False), (other, True)):
        alone = {e.names for e in search(model).explanations if len(e.names) == 1}
        assert ("bend",) in alone
        assert (("ripple",) in alone) == fitted


def test_causes_that_look_alike_are_both_named() -> None:
    shapes = library()
    shapes["twin"] = shapes["bend"] + 0.05 * shapes["ripple"]
    for k in range(3):
        found = search(FakeModel(shapes=shapes, hidden=at_sigmas("bend", 8.0), drawn=noise(60 + k)))
        assert found.verdict == "ambiguous"
        assert set(found.equivalent) == {("bend",), ("twin",)}
        assert found.equivalent[0] == found.chosen.names  # type: ignore[union-attr]
        assert found.confidence < 0.98


def test_smooth_structure_outside_the_library_is_unexplained() -> None:
    shapes = library()
    del shapes["ripple"], shapes["slack"]
    for k in range(3):
        hidden = 12.0 * waves(7)[:, 5] / np.linalg.norm(waves(7)[:, 5])
        found = search(FakeModel(shapes=shapes, hidden=hidden, drawn=noise(70 + k)))
        assert found.verdict == "unexplained"
        assert found.chosen is None
        assert found.equivalent == ()
        assert found.confidence == 0.0


def test_an_effect_taken_out_of_the_library_is_not_given_the_nearest_name() -> None:
    for k in range(3):
        shapes = library()
        hidden = at_sigmas("ripple", 12.0)
        del shapes["ripple"]
        assert search(FakeModel(shapes=shapes, hidden=hidden, drawn=noise(80 + k))).verdict == "unexplained"


def test_two_causes_are_found_together() -> None:
    for k in range(3):
        hidden = at_sigmas("bend", 9.0) + at_sigmas("slack", -9.0)
        found = search(FakeModel(hidden=hidden, drawn=noise(90 + k)))
        assert found.verdict in ("found", "ambiguous")
        assert found.chosen is not None
        assert found.chosen.names == ("bend", "slack")
        assert found.equivalent[0] == ("bend", "slack")


def test_one_cause_is_not_made_two() -> None:
    doubled = 0
    for k in range(12):
        found = search(FakeModel(hidden=at_sigmas("bend", 10.0), drawn=noise(100 + k)))
        doubled += found.explanations[0].names != ("bend",)
    assert doubled <= 1


@pytest.mark.parametrize("place", ["all", *MATERIALS])
def test_where_a_cause_sits_is_found(place: str) -> None:
    for k in range(2):
        model = FakeModel(
            scoped=tuple(library()),
            hidden=at_sigmas("bend", 10.0, material=place),
            drawn=noise(110 + k),
        )
        found = search(model)
        assert found.verdict == "found"
        assert found.chosen is not None
        assert [c.at for c in found.chosen.candidates] == [place]


def test_what_the_moduli_can_do_alone_is_never_named() -> None:
    shapes = library() | {"density": by_modulus("S0")}
    for hidden in (5.0 * shapes["density"], at_sigmas("bend", 9.0)):
        found = search(FakeModel(shapes=shapes, hidden=hidden, drawn=noise(120)))
        assert not any("density" in e.names for e in found.explanations)
    assert (
        search(FakeModel(shapes=shapes, hidden=5.0 * shapes["density"], drawn=noise(121))).verdict == "none"
    )


def test_explanations_stand_in_the_order_of_their_score() -> None:
    found = search(FakeModel(hidden=at_sigmas("bend", 6.0) + at_sigmas("slope", 6.0), drawn=noise(130)))
    scores = [e.score for e in found.explanations]
    assert scores == sorted(scores)
    assert len(scores) >= 2


def test_a_search_is_the_same_again_and_other_seeds_draw_anew() -> None:
    def run(seed: int) -> Finding:
        model = FakeModel(hidden=at_sigmas("bend", 4.0), drawn=noise(140))
        return search(model, rules=Rules(seed=seed))

    one, same, other = run(0), run(0), run(1)
    assert (one.verdict, one.p_value, one.lack_of_fit.p_value) == (
        same.verdict,
        same.p_value,
        same.lack_of_fit.p_value,
    )
    assert (one.null.noise != other.null.noise).any()
    assert one.p_value == pytest.approx(other.p_value, rel=1.0)


def test_nuisances_are_taken_anew_where_the_fit_ends() -> None:
    model = FakeModel(truth=np.array([2.0, -2.0]))
    found = fit_baseline(model)
    assert found.converged
    assert len(model.updated) == 1  # after the rough fit only, since the fit hardly moved afterwards
    assert model.updated[-1].u == pytest.approx(found.state.u, abs=0.05)


def test_nuisances_that_move_the_fit_are_taken_once_more() -> None:
    class Drawn(FakeModel):
        def update_nuisances(self, state: State, *, rough: bool = False) -> None:
            super().update_nuisances(state, rough=rough)
            if not rough and len(self.updated) == 1:
                self.data = self.data + self.by_u @ np.array([0.3, 0.0])

    model = Drawn()
    found = fit_baseline(model)
    assert len(model.updated) == 2
    assert found.state.u == pytest.approx(model.truth + np.array([0.3, 0.0]), abs=1e-3)


def test_a_library_of_nothing_names_nothing() -> None:
    assert search(FakeModel(shapes={}, drawn=noise(150))).verdict == "none"
    odd = FakeModel(shapes={}, hidden=at_sigmas("ripple", 15.0), drawn=noise(150))
    assert search(odd).verdict == "unexplained"


def test_no_baseline_is_an_error() -> None:
    with pytest.raises(ValueError, match="no answer"):
        search(FakeModel(no_answer=lambda _: True))


def test_a_cause_that_the_simulator_cannot_follow_is_passed_over() -> None:
    bend = Candidate(effect="bend")
    model = FakeModel(
        hidden=at_sigmas("bend", 9.0), drawn=noise(160), no_answer=lambda s: bend in s.amplitudes
    )
    found = search(model)
    assert found.verdict == "unexplained"
    assert not any("bend" in e.names for e in found.explanations)


def test_what_is_done_is_told() -> None:
    told: list[str] = []
    search(FakeModel(hidden=at_sigmas("bend", 9.0), drawn=noise(170)), on_progress=told.append)
    assert told[0] == "fitting the baseline"
    assert any(t.startswith("confirming 1 of") and t.endswith(": bend") for t in told)
