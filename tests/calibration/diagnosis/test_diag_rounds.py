"""Two rounds of a diagnosis: the cost of a round, and named causes if the noise is not stated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from fake_model import FakeModel, effect, library, noise, sigmas, waves

from calibration.diagnosis import laws
from calibration.diagnosis.engine import explain, run
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.run import Searched, diagnose
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.laws import diagnose_with_law
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State


def hidden(name: str, size: float) -> np.ndarray:
    return np.asarray(library()[name] * (size / sigmas(library()[name], FakeModel())))


@dataclass(eq=False)
class OfUnknownNoise(FakeModel):
    """Beams without stated noise, of this full scale."""

    scale: float = 1e3

    def states_noise(self, k: int) -> bool:
        del k
        return False

    def full_scale(self) -> np.ndarray:
        return np.full(len(self.records), self.scale)


def test_a_departure_that_a_smooth_error_may_make_is_not_named_though_a_cause_explains_it() -> None:
    told = {"hidden": hidden("bend", 30.0), "drawn": noise(1)}
    assert diagnose(FakeModel(**told), gain=False).finding.verdict == "found"
    large = diagnose(OfUnknownNoise(**told, scale=100.0), gain=False)
    assert large.finding.verdict == "found", large.sentence()
    small = diagnose(OfUnknownNoise(**told, scale=1e3), gain=False)
    assert small.finding.verdict == "unexplained"
    assert small.to_json()["causes"] == []
    assert small.nearest is not None
    assert small.nearest.explanation.names == ("bend",)
    assert "which a smooth unstated error may have" in small.sentence()


def rounds_concluded(monkeypatch: pytest.MonkeyPatch, further: str) -> list[bool]:
    """Return a list that records, for each round concluded from now on, if it had this further effect."""
    concluded: list[bool] = []
    unwatched = run.concluded

    def watched(found: Searched, **options: bool) -> Diagnosis:
        concluded.append(further in found.model.effects)
        return unwatched(found, **options)  # type: ignore[arg-type]

    for module in (run, laws):
        monkeypatch.setattr(module, "concluded", watched)
    return concluded


@pytest.mark.parametrize("named", [True, False])
def test_a_first_round_is_concluded_only_where_the_second_says_less(
    named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Predictions and advice for an unreported round would cost more than its search."""
    rare = replace(effect("ripple"), further=True)
    shapes = {n: library()[n] for n in ("bend", "ripple")}
    outside = 30.0 * waves(7)[:, 6] / np.linalg.norm(waves(7)[:, 6])
    data = {"hidden": outside + hidden("ripple", 120.0 if named else 0.0), "drawn": noise(3)}

    def make(*, further: bool = True, **_: object) -> FakeModel:
        model = FakeModel(
            shapes=shapes if further else {"bend": shapes["bend"]},
            effects={"ripple": rare} if further else {},
            **data,
        )
        model.visible = dict.fromkeys(model.candidates, True)
        return model

    concluded = rounds_concluded(monkeypatch, "ripple")
    found, model = diagnose_with_law(make, gain=False)
    assert concluded == ([True] if named else [True, False])
    assert found.finding.verdict == ("partly explained" if named else "unexplained"), found.sentence()
    assert "ripple" in model.effects


@pytest.mark.parametrize("fewer", [True, False])
def test_of_two_rounds_that_explain_only_what_is_said_is_concluded(
    fewer: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first round needs two causes; a further cause with their sum as its shape is preferred."""
    usual = {n: library()[n] for n in ("bend", "slope")}
    both = hidden("bend", 40.0) + hidden("slope", 40.0)
    rare = both / np.linalg.norm(both) if fewer else library()["ripple"]

    def make(*, further: bool = True, **_: object) -> FakeModel:
        model = FakeModel(
            shapes=usual | ({"rare": rare} if further else {}),
            effects={"rare": replace(effect("rare"), further=True)} if further else {},
            hidden=both,
            drawn=noise(3),
        )
        model.visible = dict.fromkeys(model.candidates, True)
        return model

    concluded = rounds_concluded(monkeypatch, "rare")
    found, model = diagnose_with_law(make, gain=False)
    assert concluded == [fewer]
    assert found.finding.verdict == "found", found.sentence()
    assert found.finding.equivalent == ((("rare",),) if fewer else (("bend", "slope"),))
    assert ("rare" in model.effects) == fewer


def test_a_second_round_fits_no_set_of_causes_again(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = {n: library()[n] for n in ("bend", "slope")}
    outside = 30.0 * waves(7)[:, 6] / np.linalg.norm(waves(7)[:, 6])

    def make(*, further: bool = True, **_: object) -> FakeModel:
        shapes = usual | ({"ripple": library()["ripple"]} if further else {})
        model = FakeModel(
            shapes=shapes,
            effects={"ripple": replace(effect("ripple"), further=True)} if further else {},
            hidden=outside + hidden("bend", 60.0) + hidden("slope", 40.0) + hidden("ripple", 50.0),
            drawn=noise(3),
        )
        model.visible = dict.fromkeys(model.candidates, True)
        return model

    fitted: list[frozenset[Candidate]] = []
    plain = explain.fit

    def counted(model: MeasurementModel, start: State, candidates: Sequence[Candidate]) -> Fit:
        fitted.append(frozenset(candidates))
        return plain(model, start, candidates)

    monkeypatch.setattr(explain, "fit", counted)
    diagnose_with_law(make, gain=False)
    assert any("ripple" in [c.effect for c in causes] for causes in fitted)
    assert len(fitted) == len(set(fitted)) > 3
