"""Advice after cantilever releases: predicted separation of causes against the performed experiment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from release_models import bar_model

from benchmarks.blind.release import Truth, write_bars
from calibration.diagnosis.effects.release import EFFECTS
from calibration.diagnosis.engine.advice import Advice, advice, advise
from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.null import Null
from calibration.experiment import read
from calibration.measurements._design import Gauge
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State
from calibration.measurements.release._vibration import free_vibration
from calibration.measurements.release.experiments import EXPERIMENTS, FURTHER, HEAVIER, RepeatedRelease
from calibration.measurements.release.model import ReleaseModel

# so stiff that the data's linear beam theory holds with 60 g on the beam
YIELDING = Truth(shear=3e6, viscous=2e-4, clamp=0.01)
RELAXING = Truth(branches=((0.08, 0.5),))
HUNG = (0.0, 0.01)
ORDER = [e.name for e in EXPERIMENTS]


def made(truth: Truth, **how: Any) -> ReleaseModel:
    with TemporaryDirectory() as folder:
        return bar_model(read(write_bars(Path(folder) / "bars", truth, **how)), fem=False, workers=1)


def explained(model: ReleaseModel, causes: Sequence[tuple[str, float | None]]) -> list[Explanation]:
    """Explanations by one cause (effect, kind) in all trials, with nuisances updated at the first one."""
    null = Null(model.points + len(model.baseline.prior), {})
    found: list[Explanation] = []
    state = State(u=model.start())
    model.update_nuisances(state)
    for again in (False, True):
        baseline = fit(model, state)
        found = []
        for name, kind in causes[: None if again else 1]:
            candidate = in_all(model, name, kind)
            e = explain(model, baseline, (candidate,), [0.3 * EFFECTS[name].prior_scale], null)
            assert e is not None
            assert e.fit.converged
            found.append(e)
        model.update_nuisances(found[0].fit.state)
    return found


def in_all(model: ReleaseModel, name: str, kind: float | None = None) -> Candidate:
    def is_it(c: Candidate) -> bool:
        return (c.effect, c.at, c.variant) == (name, "all", kind)

    return next(c for c in model.candidates if is_it(c))


def yielding(hung: Sequence[float]) -> tuple[ReleaseModel, list[Explanation]]:
    """Beams in a compliant clamp, with alternatives for their softness: grip length and section."""
    model = made(YIELDING, hung=hung, sd_mm=0.01, rate=450.0, seconds=0.75)
    return model, explained(
        model, [("clamp-compliance", None), ("grip-length", None), ("section-scale", None)]
    )


@cache
def clamped() -> tuple[ReleaseModel, list[Explanation], dict[str, Advice]]:
    model, rivals = yielding(HUNG)
    return model, rivals, {a.name: a for a in advise(model, rivals)}


def behind(rivals: Sequence[Explanation]) -> np.ndarray:
    """Difference in chi-square of each other explanation from the first."""
    return np.array([e.fit.chi2 - rivals[0].fit.chi2 for e in rivals[1:]])


def supposed(model: ReleaseModel, base: State, name: str, amplitude: float) -> Explanation:
    """Explanation by a cause of this amplitude, without a fit to the data."""
    c = in_all(model, name)
    linear = model.linearise(replace(base, amplitudes={c: amplitude}), (c,))
    lack_of_fit = LackOfFit(p_value=0.5, each={}, worst="none")
    return Explanation(fit=Fit(linear=linear, converged=True), cost=0.0, lack_of_fit=lack_of_fit)


def test_what_an_experiment_promises_is_what_it_gives() -> None:
    """The same beams with 50 g more, fitted together with the earlier ones.

    The gain in the separation by chi-square agrees with the predicted one.
    """
    model, rivals, promised = clamped()
    done, after = yielding((*HUNG, *(m + HEAVIER for m in HUNG)))
    gained = behind(after) - behind(rivals)
    assert promised["heavier"].separations == pytest.approx(gained, rel=0.5)
    assert min(gained) > 5.0 * max(behind(rivals))
    # and the predicted frequencies are those of the beams released afterwards
    heavier = next(e for e in EXPERIMENTS if e.name == "heavier")
    assert isinstance(heavier, RepeatedRelease)
    new = model.predicted_in(heavier, rivals[0].fit.state)
    assert new is not None
    for k, r in enumerate(done.records[len(HUNG) :]):
        bar = free_vibration(new.parameters(k, rivals[0].fit.state))
        assert bar.frequencies[0] * r.period == pytest.approx(1.0, abs=0.005)


def test_bars_let_go_once_more_tell_as_much_again() -> None:
    """Turning or reversing a straight and uniform beam does not change it."""
    _, rivals, promised = clamped()
    for name in ("turn-over", "swap-ends"):
        assert promised[name].separations == pytest.approx(behind(rivals), rel=0.15)


def test_what_parts_all_rivals_comes_first() -> None:
    model, rivals, promised = clamped()
    best, *rest = promised.values()
    assert set(promised) == set(ORDER)
    assert best.name == "heavier"
    assert min(best.separations) > model.enough
    assert best.separated == 2.0
    worths = [round(a.separated, 2) for a in rest]
    assert worths == sorted(worths, reverse=True)
    assert worths[0] < 2.0
    blind = [a for a in rest if a.name in ("weigh", "level", "ruler", "known-way")]
    assert rest[-4:] == blind  # measurements of other effects
    assert all(a.separations == (0.0, 0.0) for a in blind)
    said = advice(model, rivals)
    apart = round(float(np.sqrt(min(best.separations))))
    assert said == (
        "hang 50 g more on the free end: clamp-compliance parts there from grip-length, section-scale by"
        f" {apart} standard deviations"
    )


def test_of_those_that_part_all_the_cheapest_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    model, rivals, promised = clamped()
    monkeypatch.setattr(ReleaseModel, "enough", 5.0)
    found = [a.name for a in advise(model, rivals)]
    enough = [n for n in ORDER if min(promised[n].separations) >= 5.0]
    assert len(enough) > 3
    assert found[: len(enough)] == enough


def test_two_rivals_parted_are_worth_more_than_three_in_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """Callipers identify the thin section, here twice among the alternatives, but not the deep grip.

    A clamp loaded by hand separates all three, by 0.4 of the required separation.
    """
    model, (turning, deep, thin), promised = clamped()
    unseen, enough = promised["callipers"].separations
    assert unseen == 0.0
    turns, sd = turning.fit.amplitude(turning.candidates[0])
    error = float(np.sqrt(turns**2 / (0.4 * enough) - sd**2))
    by_hand = Gauge(name="by-hand", sentence="push the clamp", sds={"clamp-compliance": error})
    callipers = next(e for e in EXPERIMENTS if e.name == "callipers")
    monkeypatch.setattr(ReleaseModel, "experiments", (by_hand, callipers))
    monkeypatch.setattr(ReleaseModel, "enough", enough)
    first, second = advise(model, [turning, deep, thin, thin])
    assert (first.name, first.separations) == ("callipers", (0.0, enough, enough))
    assert (second.name, second.separations) == ("by-hand", pytest.approx([0.4 * enough] * 3))
    assert second.separation > first.separation
    said = advice(model, [turning, deep, thin, thin])
    assert said.endswith("; nothing of the catalogue parts it from grip-length")


def test_a_gauge_parts_by_its_own_error_and_the_fits() -> None:
    _, rivals, promised = clamped()
    (turns, turns_sd), (deep, deep_sd), (thin, thin_sd) = (e.fit.amplitude(e.candidates[0]) for e in rivals)
    metal, callipers = promised["metal-bar"], promised["callipers"]
    by_turn = turns**2 / (2e-3**2 + turns_sd**2)
    assert metal.separations == pytest.approx([by_turn + deep**2 / (2e-4**2 + deep_sd**2), by_turn])
    assert callipers.separations == pytest.approx([0.0, thin**2 / (2e-3**2 + thin_sd**2)])


def test_turning_a_bar_over_shows_a_bend_and_round_a_gradient() -> None:
    model, rivals, _ = clamped()
    base = rivals[0].fit.state
    others = [supposed(model, base, "residual-curvature", 0.3)]
    others += [supposed(model, base, "stiffness-gradient-axial", 1.0)]
    found = {a.name: a.separations for a in advise(model, [rivals[0], *others])}
    bend, gradient = zip(found["turn-over"], found["swap-ends"], strict=True)
    assert bend[0] > 10.0 * bend[1]
    assert gradient[1] > 10.0 * gradient[0]


def test_a_longer_record_parts_relaxation_times() -> None:
    model = made(RELAXING)
    rivals = explained(model, [("relaxation", 0.5), ("relaxation", 1.0)])
    found = {a.name: a.separations[0] for a in advise(model, rivals)}
    assert found["record-longer"] > 3.0 * found["turn-over"] > 0.0  # which only repeats the record
    longer = next(e for e in EXPERIMENTS if e.name == "record-longer")
    assert isinstance(longer, RepeatedRelease)
    new = model.predicted_in(longer, rivals[0].fit.state)
    assert new is not None
    for old, r in zip(model.records, new.records, strict=True):
        swinging = old.time - old.release_time <= 12.0 * old.period
        np.testing.assert_array_equal(r.time[swinging], old.time[swinging])
        after = 12.0 * old.period + old.release_time
        assert r.time[-1] - after == pytest.approx(FURTHER * (old.time[-1] - after))


def test_a_new_experiment_is_as_the_first_explanation_predicts() -> None:
    """It takes no data from the existing records, which stay unchanged."""
    model, rivals, _ = clamped()
    before = [r.measured() for r in model.records]
    for e in EXPERIMENTS:
        if isinstance(e, RepeatedRelease):
            new = model.predicted_in(e, rivals[0].fit.state)
            assert new is not None
            (z,) = new.residuals([rivals[0].fit.state])
            assert np.abs(z[: new.points]).max() < 1e-6
            (other,) = new.residuals([rivals[1].fit.state])
            assert other[: new.points] @ other[: new.points] > 1.0
    for old, r in zip(before, model.records, strict=True):
        np.testing.assert_array_equal(old, r.measured())


def test_what_cannot_be_let_go_is_not_advised(monkeypatch: pytest.MonkeyPatch) -> None:
    """A beam that stands on its clamp under a thousand times gravity buckles."""
    model, rivals, _ = clamped()
    buckled = RepeatedRelease(
        name="stand", sentence="stand it up", changed=lambda s: replace(s, gravity=(-9.81e3, 0.0))
    )
    assert model.predicted_in(buckled, rivals[0].fit.state) is None
    monkeypatch.setattr(ReleaseModel, "experiments", (buckled, *EXPERIMENTS[:1]))
    assert all(a.separations == (0.0, 0.0) for a in advise(model, rivals))
    assert advice(model, rivals) == (
        "no experiment of the catalogue parts clamp-compliance from grip-length, section-scale"
    )


def test_gauges_measure_effects_that_there_are() -> None:
    for e in EXPERIMENTS:
        if isinstance(e, Gauge):
            assert set(e.sds) <= set(EFFECTS)
            assert all(0.0 < sd < EFFECTS[name].prior_scale for name, sd in e.sds.items())
    assert len(set(ORDER)) == len(ORDER)
