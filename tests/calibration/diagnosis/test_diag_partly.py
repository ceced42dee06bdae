"""Graded verdicts, on formulas: causes of most of the explainable misfit are named, the rest is stated."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from fake_model import FakeModel, column, effect, library, noise, sigmas, waves

import calibration
from calibration.diagnosis.engine.explanation import explain
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.partly import _dominant
from calibration.diagnosis.engine.resampling import Groups, Resampled, groups_of
from calibration.diagnosis.engine.rules import Rules
from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.engine.sentences import percent
from calibration.diagnosis.engine.shares import Shares
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.laws import diagnose_with_law
from calibration.diagnosis.report import write_report
from calibration.errors import InputError
from calibration.measurements._effect import Candidate
from calibration.measurements._noise_known import NoiseKnown, PointNoise, roughness
from calibration.measurements._state import State
from calibration.measurements._variance_components import Curve, deviations, variance_components


def hidden(name: str, size: float) -> np.ndarray:
    return np.asarray(library()[name] * (size / sigmas(library()[name], FakeModel())))


def outside(size: float) -> np.ndarray:
    """A wave that no effect can produce, equal on all beams, with a norm of `size` standard deviations."""
    wave = waves(7)[:, 6]
    return np.asarray(size * wave / np.linalg.norm(wave))


@cache
def partly() -> tuple[FakeModel, Diagnosis]:
    model = FakeModel(hidden=hidden("bend", 40.0) + outside(14.0), drawn=noise(1))
    return model, diagnose(model)


# -- resampling and fractions --


def test_every_group_once_is_the_fit_itself() -> None:
    model = FakeModel(hidden=hidden("bend", 10.0), drawn=noise(1))
    found = fit(model, State(u=model.start()), (Candidate(effect="bend"),))
    groups = groups_of(model)
    assert groups.over == "tests"
    assert groups.count == 6
    again = Resampled(found, groups).replicates(np.ones((1, 6)))
    assert again.chi2[0] == pytest.approx(found.chi2, rel=1e-6)
    assert again.expected[0] == pytest.approx(72 - 3, rel=1e-6)
    assert np.abs(again.moves).max() < 1e-3


def test_a_resampled_fit_is_that_of_weighted_least_squares() -> None:
    model = FakeModel(hidden=hidden("bend", 10.0), drawn=noise(2))
    found = fit(model, State(u=model.start()))
    times = np.array([2.0, 0.0, 1.0, 1.0, 2.0, 0.0])
    rows = np.repeat(np.arange(72), np.repeat(times, 12).astype(int))
    again = Resampled(found, groups_of(model)).replicates(times[None, :])
    best, (squares,), _, _ = np.linalg.lstsq(model.by_u[rows], model.data[rows], rcond=None)
    assert found.state.u + again.moves[0] == pytest.approx(best, abs=1e-4)
    assert again.chi2[0] == pytest.approx(squares, rel=1e-6)


def test_few_tests_are_cut_into_stretches() -> None:
    model = FakeModel(drawn=noise(1))
    model.noise = model.noise.subset(np.arange(72) < 24)
    groups = groups_of(model)
    assert groups.over == "fifths of each record"
    assert groups.count == 10
    assert (np.diff(groups.of_row) >= 0).all()  # each group is a contiguous stretch


def test_the_systematic_misfit_is_estimated_without_bias() -> None:
    found = []
    for k in range(60):
        model = FakeModel(hidden=outside(10.0), drawn=noise(500 + k))
        baseline = fit(model, State(u=model.start()))
        found.append(Shares(model, baseline, draws=10, seed=0).baseline.value)
    left = outside(10.0) - model.by_u @ np.linalg.lstsq(model.by_u, outside(10.0), rcond=None)[0]
    assert np.mean(found) == pytest.approx(left @ left, abs=4.0 * np.std(found) / np.sqrt(60))


def test_shares_of_causes_add_up_and_those_apart_keep_their_own() -> None:
    shapes = {"bend": library()["bend"], "ripple": library()["ripple"]}
    model = FakeModel(shapes=shapes, hidden=hidden("bend", 30.0) + hidden("ripple", 15.0), drawn=noise(3))
    baseline = fit(model, State(u=model.start()))
    causes = (Candidate(effect="bend"), Candidate(effect="ripple"))
    null = Null(72, {}, seed=0)
    both = explain(model, baseline, causes, [0.0, 0.0], null)
    assert both is not None
    shares = Shares(model, baseline, draws=50, seed=0)
    each = shares.of_causes(model, baseline, both, null)
    whole = shares.share(shares.misfit(both.fit))
    assert sum(s.value for s in each.values()) == pytest.approx(whole.value, abs=1e-6)
    assert whole.value == pytest.approx(1.0, abs=0.05)
    assert each[causes[0]].value == pytest.approx(0.8, abs=0.1)  # 30^2 of 30^2 + 15^2
    assert each[causes[0]].low < each[causes[0]].value < each[causes[0]].high


# -- verdicts --


def test_what_takes_most_is_named_though_more_than_noise_is_left() -> None:
    model, found = partly()
    data = found.to_json()
    assert data["verdict"] == "partly explained"
    (cause,) = data["causes"]
    assert cause["effect"] == "bend"
    truth = 1e3 * 40.0 / sigmas(library()["bend"], model)
    size = cause["parameters"]["size_mm"]
    assert size["value"] == pytest.approx(truth, rel=0.15)
    share = data["share"]
    assert share["low"] < 40.0**2 / (40.0**2 + 14.0**2) < share["high"] + 0.05
    assert 0.75 < share["value"] < 0.97
    assert data["gain"]["skill"] > 0.5
    assert len(data["gain"]["folds"]) == 3
    assert data["extended"]["reduced_chi2"] > 2.0
    assert found.remainder is not None
    assert found.remainder.repeats == "everywhere"
    assert found.remainder.rms > 0.0
    assert found.model_error is not None
    assert found.model_error.shear_modulus_relative_sd["S0"] > 0.0
    assert found.sentence().startswith("Partly explained: there is bend (bend), which explains ")
    assert "in held-out measurements" in found.sentence()
    assert "repeats in all of them" in found.next_experiment


def test_rivals_that_take_as_much_are_named_with_it() -> None:
    shapes = library()
    shapes["twin"] = shapes["bend"] + 0.02 * shapes["ripple"]
    found = diagnose(
        FakeModel(shapes=shapes, hidden=hidden("bend", 40.0) + outside(14.0), drawn=noise(1)), gain=False
    )
    assert found.finding.verdict == "partly explained"
    assert set(found.finding.equivalent) == {("bend",), ("twin",)}
    assert "cannot separate" in found.sentence()
    assert set(found.equally_large) < {("bend",), ("twin",)}


def test_what_takes_little_is_not_named_but_said() -> None:
    found = diagnose(FakeModel(hidden=hidden("bend", 8.0) + outside(30.0), drawn=noise(2)))
    data = found.to_json()
    assert data["verdict"] == "unexplained"
    assert data["causes"] == []
    assert data["nearest"]["not_named_because"]
    assert data["nearest"]["share"]["value"] < 0.5
    assert "The nearest is" in found.sentence()
    assert "It is not named, because " in found.sentence()
    assert found.next_experiment


def test_what_helps_one_part_only_is_not_named() -> None:
    """The hidden effect changes its sign with length: a fit to some lengths mispredicts the others."""
    shape = column(lambda x: np.sin(np.pi * x), (1.0, 1.0, 1.0))
    turned = column(lambda x: np.sin(np.pi * x), (1.5, 1.0, -0.5))
    model = FakeModel(shapes={"bend": shape}, hidden=12.0 * turned, drawn=noise(4), shared=True)
    found = diagnose(model)
    assert found.finding.verdict == "unexplained"
    assert found.nearest is not None
    assert any("held out" in reason or "amplitude" in reason for reason in found.nearest.against)


def test_a_rejected_set_of_few_causes_is_no_reason_against_more() -> None:
    """One cause explains 96 %, another 81 %, both 98 %.

    The pair adds little to the first, and much to the second.
    """

    def tried(sets: dict[tuple[str, ...], float]) -> tuple[str, ...]:
        left = [(SimpleNamespace(names=n), s) for n, s in sets.items()]
        share = SimpleNamespace(share=lambda part: SimpleNamespace(value=part))
        chosen = left[_dominant(left, share, Rules())][0].names  # type: ignore[arg-type]
        return tuple(chosen)

    sets = {("a", "b"): 0.98, ("a",): 0.96, ("c",): 0.81}
    assert tried(sets) == ("a",)
    del sets[("a",)]
    assert tried(sets) == ("a", "b")
    del sets[("a", "b")]
    assert tried(sets) == ("c",)


def test_what_predicts_too_little_is_not_named() -> None:
    """The data of `partly`, with rules that require more skill than the explanation has."""
    model, named = partly()
    assert named.held_out is not None
    assert named.held_out.skill > Rules().least_skill
    found = diagnose(model, rules=Rules(least_skill=named.held_out.skill + 0.05), gain=False)
    assert found.finding.verdict == "unexplained"
    assert found.nearest is not None
    assert any("misfit beyond noise in held-out" in reason for reason in found.nearest.against)
    assert found.nearest.explanation.names == ("bend",)


@pytest.mark.parametrize("elsewhere", [False, True])
def test_several_causes_in_one_test_of_several_explain_in_part(elsewhere: bool) -> None:
    """Two causes in one test only are not confirmed; they are if the other tests have one of them too."""
    names = ("bend", "kink")
    here = np.arange(72) < 12
    shapes = {n: np.where(here | (elsewhere and n == "kink"), library()[n], 0.0) for n in names}
    acts = {n: (lambda _: True) if elsewhere and n == "kink" else (lambda r: r.name == "S0 1") for n in names}
    model = FakeModel(
        shapes=shapes,
        effects={n: replace(effect(n), applies_to=acts[n]) for n in names},
        hidden=sum(15.0 * shapes[n] / sigmas(shapes[n], FakeModel()) for n in names),
        drawn=noise(1),
    )
    found, _ = diagnose_with_law(lambda **_: model, gain=False)
    assert found.finding.equivalent == (names,)
    assert found.finding.verdict == ("found" if elsewhere else "partly explained"), found.sentence()
    assert ("all of it is in S0 1, and no other test confirms it" in found.sentence()) != elsewhere


def test_noise_alone_and_what_is_explained_wholly_stay_as_they_were() -> None:
    assert diagnose(FakeModel(drawn=noise(5)), gain=False).finding.verdict == "none"
    whole = diagnose(FakeModel(hidden=hidden("bend", 12.0), drawn=noise(1)), gain=False)
    assert whole.finding.verdict == "found"
    assert whole.share is not None
    assert whole.share.value == pytest.approx(1.0, abs=0.3)
    assert whole.model_error is None


def test_the_page_has_a_budget_of_the_departure(tmp_path: Path) -> None:
    model, found = partly()
    (page,) = [p for p in write_report(found, model, tmp_path, title="made") if p.suffix == ".html"]
    text = " ".join(page.read_text(encoding="utf-8").split())
    assert "Partly explained" in text
    assert text.index("Sources of the misfit") < text.index("<h2>Method</h2>")
    assert found.share is not None
    assert percent(found.share) in text
    assert "not modelled" in text
    assert "repeats in all tests: the form of the model, or the rig" in text
    assert text.count("<td>0</td>") + text.count("<td>1</td>") + text.count("<td>2</td>") == 3  # the folds
    assert "Remaining misfit" in text


# -- noise --


def test_white_noise_is_seen_on_a_smooth_curve() -> None:
    x = np.linspace(0.0, 1.0, 400)
    draws = np.random.default_rng(1).standard_normal(400)
    sd, points = roughness(5.0 * np.exp(x) + 0.02 * draws)
    assert sd == pytest.approx(0.02, rel=0.15)
    assert points == 397
    assert roughness(np.zeros(3)) == (0.0, 0)


def test_stated_noise_that_the_data_contradict_is_said() -> None:
    def sentences(shown: float, *, stated: bool = True) -> list[str]:
        point = PointNoise(record="a", stated=stated, assumed=5e-5, shown=shown, points=100)
        return NoiseKnown(points=(point,), unit=("mm", 1e3)).sentences()

    (said,) = sentences(1e-5)
    assert "scatter by less than the lab states in 1 of 1 records: 0.01 mm from point to point" in said
    assert "--noise data" in said
    assert "by more" in sentences(2e-4)[0]
    assert sentences(4e-5) == []
    assert sentences(1e-5, stated=False) == []
    assert "not known" in NoiseKnown(known=False).sentences()[0]


def test_the_noise_of_the_data_is_taken_where_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("calibration.measurements._noisy_model.FEWEST", 8)  # of 12 points per beam
    small = 0.1 * noise(6)
    stated = diagnose(FakeModel(drawn=small), gain=False)
    assert stated.finding.verdict == "none"
    assert any("less than the lab states" in n for n in stated.notes)
    assert stated.to_json()["noise"]["source"] == "stated"
    model = FakeModel(drawn=small)
    known = model.settle_noise("data")
    assert known.source == "data"
    assert np.median(model.noise.sd) == pytest.approx(0.1, rel=0.4)


def repeat(
    n: int,
    x: np.ndarray,
    branch: np.ndarray,
    misfit: np.ndarray,
    *,
    sd: float = 0.0,
    scale: float = 1.0,
) -> Curve:
    return Curve(
        name=f"t{n}",
        material="m",
        specimen="s",
        test=0,
        x=x,
        branch=branch,
        misfit=misfit,
        sd=np.full(x.size, sd),
        scale=scale,
    )


def curves(*, trend: float, spread: float, seed: int, tests: int = 6) -> list[Curve]:
    """Repeats of a test of full scale 2, each with its own smooth deviation, and a trend with their order."""
    random = np.random.default_rng(seed)
    x = np.linspace(0.0, 1.0, 50)
    found = []
    for n in range(tests):
        own = spread * sum(
            np.sqrt(2.0) * random.standard_normal() * np.cos(np.pi * k * x) / np.sqrt(4.0)
            for k in range(1, 5)
        )
        misfit = 2.0 * (np.sin(3.0 * x) + own + trend * n / max(tests - 1, 1))
        found.append(repeat(n, x, np.zeros(x.size, dtype=np.int64), misfit, scale=2.0))
    return found


def test_repeats_show_their_scatter_beside_the_trend_of_their_order() -> None:
    found = [variance_components(curves(trend=0.05, spread=0.01, seed=k)) for k in range(20)]
    assert np.mean([f.repeat for f in found if f.repeat is not None]) == pytest.approx(0.01, rel=0.3)
    assert np.mean([f.order for f in found if f.order is not None]) == pytest.approx(0.05, rel=0.15)
    assert found[0].repeats == tuple(f"t{n}" for n in range(6))
    assert "6 repeats differ by" in found[0].sentences()[0]
    assert variance_components(curves(trend=0.0, spread=0.01, seed=1, tests=3)).repeat is None
    assert variance_components([]).sentences() == []


def test_a_loop_of_loading_and_unloading_is_no_scatter_between_repeats() -> None:
    """Similar repeats, sampled at other strains, with a misfit of +h in loading and -h in unloading."""
    random = np.random.default_rng(0)
    found = []
    for n in range(5):
        x = np.concatenate([np.sort(random.uniform(0, 1, 40)), np.sort(random.uniform(0, 1, 40))[::-1]])
        branch = np.repeat([0, 1], 40)
        misfit = np.where(branch == 0, 0.1, -0.1) + 0.001 * (n % 2)
        found.append(repeat(n, x, branch, misfit))
    scatter = variance_components(found).repeat
    assert scatter is not None
    assert 0.0 < scatter < 0.002


def test_noise_from_point_to_point_is_not_scatter_between_repeats() -> None:
    """Identical tests with white noise of 2 %, and the same with a scatter of 3 % between them."""
    x, branch = np.linspace(0.0, 1.0, 60), np.zeros(60, dtype=np.int64)
    alike, apart = [], []
    for seed in range(20):
        random = np.random.default_rng(seed)
        noisy = [0.02 * random.standard_normal(60) for _ in range(6)]
        alike.append(variance_components([repeat(n, x, branch, z, sd=0.02) for n, z in enumerate(noisy)]))
        moved = [z + 0.03 * random.standard_normal() for z in noisy]
        apart.append(variance_components([repeat(n, x, branch, z, sd=0.02) for n, z in enumerate(moved)]))
    assert sum(f.repeat == 0.0 for f in alike) >= 18
    assert sum(f.order is None for f in alike) >= 18
    assert "6 repeats differ by no more than the noise" in alike[0].sentences()[0]
    assert np.median([f.repeat for f in apart if f.repeat is not None]) == pytest.approx(0.03, rel=0.3)


def test_a_records_own_deviation_is_as_large_as_repeats_differ() -> None:
    (columns,) = deviations(curves(trend=0.0, spread=0.0, seed=1, tests=1), [0.01, 0.02, 0.0, 0.005, 0.0])
    assert len(columns) == 3
    assert [np.sqrt(np.mean(c**2)) for c in columns] == pytest.approx([0.02, 0.04, 0.01], rel=0.1)


@pytest.mark.parametrize(("size", "records"), [(0.01, 8), (0.02, 8), (0.03, 12)])
def test_a_scatter_of_the_load_cell_is_found_in_full(size: float, records: int) -> None:
    """Each test has its own gain: the deviation is small in most of the curve, large at its end."""
    x, branch = np.linspace(1.0, 1.5, 40), np.zeros(40, dtype=np.int64)
    curve = (x - x**-2) / (1.5 - 1.5**-2)
    found, bends = [], []
    for seed in range(30):
        random = np.random.default_rng(seed)
        misfits = [
            size * random.standard_normal() * curve + 0.002 * random.standard_normal(40)
            for _ in range(records)
        ]
        components = variance_components([repeat(n, x, branch, m, sd=0.002) for n, m in enumerate(misfits)])
        assert components.repeat is not None
        found.append(components.repeat**2)
        bends.append(components.by_degree)
    assert np.sqrt(np.mean(found)) == pytest.approx(size * np.sqrt(np.mean(curve**2)), rel=0.15)
    # of degrees 0 to 2 alone, as the gain's
    assert np.sqrt(np.mean(np.array(bends)[:, 3:] ** 2)) < 0.1 * size


# -- the file --


def test_the_file_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    for model in (
        partly()[0],
        FakeModel(hidden=hidden("bend", 8.0) + outside(30.0), drawn=noise(2)),
        FakeModel(drawn=noise(5)),
    ):
        told = diagnose(model, gain=False).to_json()
        path.write_text(json.dumps(told, allow_nan=False), encoding="utf-8")
        back = calibration.read_diagnosis(tmp_path)
        assert (back.format, back.verdict) == (2, told["verdict"])
        assert back.baseline.unit == "mm"
        assert back.baseline.rms == told["baseline"]["rms_mm"]
        assert [c.effect for c in back.causes] == [c["effect"] for c in told["causes"]]
        assert (back.share is None) == (told["share"] is None)
        assert back.not_visible == () or back.not_visible[0].parameter == "size_mm"


FORMAT_1 = """{"format": 1, "verdict": "found", "causes": [{"effect": "creep", "parameters":
{"per_decade": {"value": 0.05, "sd": 0.001}}, "scope": "all", "confidence": 0.99}],
"alternatives": [["creep"]],
"baseline": {"reduced_chi2": 2.6, "p_value": 0.0002, "rms_mm": 0.1, "shear_modulus_Pa": {"S0": 26000.0}},
"extended": {"reduced_chi2": 1.1, "p_value": 0.3, "rms_mm": 0.08, "shear_modulus_Pa": {"S0": 29000.0}},
"gain": {"held_out": "leave-one-length-out", "rms_mm_before": 0.13, "rms_mm_after": 0.09,
"rms_mm_noise": 0.08, "log_likelihood": 88.0, "information_kept": 0.6, "note": ""},
"next_experiment": "", "not_visible": [{"effect": "density", "excess": null, "instead": "weigh"}],
"notes": [], "seconds": 1.0}"""


def test_format_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "diagnosis.json"
    path.write_text(FORMAT_1, encoding="utf-8")
    found = calibration.read_diagnosis(path)
    assert found.gain is not None
    assert (found.gain.rms_after, found.gain.unit, found.gain.skill) == (0.09, "mm", None)
    assert found.shear_moduli == {"S0": 29000.0}
    assert found.not_visible[0].threshold is None
    assert found.share is None


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"format": 1', '"format": 3', "format"),
        ('"verdict": "found"', '"verdict": "partly explained"', "format: expected 2"),
        ('"verdict": "found"', '"verdict": "none"', "causes: expected none of none"),
        ('"seconds": 1.0', '"minutes": 1.0', "minutes"),
    ],
)
def test_what_is_wrong_in_a_file_is_said(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "diagnosis.json"
    path.write_text(FORMAT_1.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=said):
        calibration.read_diagnosis(path)


def test_one_group_says_nothing_of_the_spread() -> None:
    groups = Groups(over="tests", of_row=np.zeros(5, dtype=np.intp), names=("one",))
    assert groups.draws(10, 0).shape == (10, 1)
