"""`calibration.predict`: cards against records of other tests, and some trials against others."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import coupon_entry, write_experiment
from matplotlib.figure import Figure
from typer.testing import CliRunner

import calibration
from benchmarks.blind.timed.coupons import respond
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Solid
from calibration.errors import InputError
from calibration.predict import app
from calibration.prediction._cards import extended_model, read_cards
from calibration.prediction.page import _panel
from calibration.prediction.run import from_cards
from calibration.prediction.schema import PredictionFile

G, BULK = 3e4, 9e7
FRACTIONS, TIMES = (0.06,) * 6, tuple(10.0 ** (k / 2) for k in range(-1, 5))
SOLID = Solid(mu=(G,), alpha=(2.0,), prony=Prony(fractions=FRACTIONS, times=TIMES))
NOISE = 0.005  # relative to the largest stress
COURSES = {
    "slow": Course(start=1.0, samples=25).ramp(1.3, 0.01),
    "held": Course(start=1.0, samples=25).ramp(1.2, 0.1).hold(60.0),
}


def content(**more: Any) -> dict[str, Any]:
    """A card of the truth with a baseline 20 % stiffer than the long-time modulus."""
    return {
        "material": "S0",
        "uncertainty": {"shear_modulus_high": 0.02, "shear_modulus_low": -0.02, "text": ""},
        "density": 1000.0,
        "law": "neo-hookean",
        "laws": {"neo-hookean": {"mu": G, "lam": BULK}},
        "model_error": 0.0,
        "baseline": {
            "law": "neo-hookean",
            "shear_modulus": 1.2 * G,
            "shear_modulus_sd": 300.0,
            "bulk_modulus": BULK,
            "model_error": 0.05,
        },
        "viscosity": {"kind": "prony", "fractions": list(FRACTIONS), "times_s": list(TIMES)},
        **more,
    }


def card(folder: Path, **more: Any) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "S0.yaml").write_text(yaml.safe_dump(content(**more)), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two records of a viscous homogeneous test, integrated by the blind laboratory."""
    rng = np.random.default_rng(1)
    tables, trials = {}, []
    for name, course in COURSES.items():
        made = respond(SOLID, "uniaxial", course, tolerance=1e-5)
        sd = NOISE * float(made.stress.max())
        stress = made.stress + sd * rng.standard_normal(made.stress.size)
        tables[f"{name}.csv"] = {
            "time_s": made.time,
            "stretch": made.stretch,
            "nominal_stress_kPa": 1e-3 * stress,
        }
        trials.append(coupon_entry(name, f"{name}.csv", stretch_sd=0.0, stress_sd_kPa=1e-3 * sd))
    return write_experiment(tmp_path_factory.mktemp("measured") / "viscous", trials, tables=tables)


def test_a_card_predicts_what_it_was_not_fitted_to(measured: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = CliRunner().invoke(app, [str(card(tmp_path / "cards")), str(measured), "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert (out / "report.html").stat().st_size > 20_000
    assert (out / "prediction.png").exists()
    found = PredictionFile.model_validate_json((out / "prediction.json").read_text(encoding="utf-8"))
    assert [r.record for r in found.records] == ["slow", "held"]
    whole = found.kinds["homogeneous"]
    assert whole.skill is not None
    assert whole.skill > 0.95
    assert whole.models["extended"].rms == pytest.approx(whole.rms_noise, rel=0.25)
    assert whole.models["extended"].coverage > 0.9
    assert whole.models["baseline"].rms > 3.0 * whole.rms_noise
    # sources of the interval, in kPa: 2 % of a modulus at 95 %, noise as stated
    sd = whole.models["extended"].sd
    measured_rms = float(np.sqrt(np.mean(np.concatenate([r.measured for r in found.records]) ** 2)))
    assert sd["parameters"] == pytest.approx(0.02 / 1.96 * measured_rms, rel=0.05)
    assert (sd["specimens"], sd["model error"]) == (0.0, 0.0)
    assert whole.models["baseline"].sd["model error"] > 4.0 * sd["parameters"]
    curve = found.records[1].curves["extended"]
    assert all(low < p < high for low, p, high in zip(curve.low, curve.predicted, curve.high, strict=True))


def test_a_card_corrected_for_its_rig_predicts_with_its_own_modulus(measured: Path, tmp_path: Path) -> None:
    """Without effects and parts, but with another modulus than the baseline: this is what the card is for."""
    where = card(tmp_path / "cards", viscosity=None)
    found = calibration.predict(measured, cards=where).prediction
    assert {m: found.shear_moduli[m]["S0"] for m in found.models} == pytest.approx(
        {"baseline": 1.2 * G, "extended": G}
    )
    assert found.labels == {"baseline": "baseline", "extended": "corrected for the rig"}
    assert any("the modulus of S0 differs by -17 % from that of its baseline" in n for n in found.notes)
    plain = content()["baseline"] | {"shear_modulus": G}
    same = calibration.predict(
        measured, cards=card(tmp_path / "same", viscosity=None, baseline=plain)
    ).prediction
    assert same.models == ("baseline",)


def test_a_cause_in_one_material_leaves_the_others_model_as_it_was(measured: Path, tmp_path: Path) -> None:
    """Two materials, of which one has a part: both have both models, so that they can be compared."""
    where = card(tmp_path / "cards")
    other = content(viscosity=None, material="S1", baseline=content()["baseline"] | {"shear_modulus": G})
    (where / "S1.yaml").write_text(yaml.safe_dump(other), encoding="utf-8")
    folder = tmp_path / "two"
    shutil.copytree(measured, folder)
    file = folder / "experiment.yaml"
    raw = yaml.safe_load(file.read_text(encoding="utf-8"))
    raw["materials"]["S1"] = {}
    raw["trials"].append({**raw["trials"][0], "id": "other", "material": "S1"})
    file.write_text(yaml.safe_dump(raw), encoding="utf-8")
    found = calibration.predict(folder, cards=where).prediction
    assert found.models == ("baseline", "extended")
    (own,) = (r for r in found.records if r.trial == "other")
    np.testing.assert_array_equal(own.predicted["extended"].value, own.predicted["baseline"].value)
    assert found.labels["extended"] == "neo-hookean + prony"


def test_measurements_that_a_card_was_fitted_to_are_no_prediction(measured: Path, tmp_path: Path) -> None:
    digest = calibration.read_experiment(measured).digest
    name = "Young's modulus of batch 7"  # repr takes other quotes
    said = f"Fitted to experiment {name!r} (sha256 {digest[:16]}) by a test."
    where = card(tmp_path / "cards", provenance=said)
    found = calibration.predict(measured, cards=where).prediction
    assert found.fitted
    # other trials of one experiment have its digest
    assert not from_cards(where, calibration.read_experiment(measured), unseen=True).fitted
    assert ", to which the models were fitted, the extended model" in found.sentence()
    assert any("this is a fit, not a prediction" in n for n in found.notes)


@pytest.mark.parametrize(("kinds", "fitted"), [(["homogeneous"], True), (["indentation"], False), ([], True)])
def test_another_kind_of_measurement_of_an_experiment_is_predicted(
    measured: Path, tmp_path: Path, kinds: list[str], fitted: bool
) -> None:
    digest = calibration.read_experiment(measured).digest
    stated = {"experiment": "any", "sha256": digest, "kinds": kinds}
    found = calibration.predict(measured, cards=card(tmp_path / "cards", fitted_to=stated)).prediction
    assert found.fitted == fitted
    assert any("this is a fit, not a prediction" in n for n in found.notes) == fitted


def test_a_wide_band_leaves_the_lines_to_be_seen(measured: Path, tmp_path: Path) -> None:
    """The band is wide for a baseline error of ten times the modulus; a narrow band is drawn completely."""
    spans = []
    for error in (10.0, 0.01):
        wide = {**content()["baseline"], "model_error": error}
        found = calibration.predict(measured, card(tmp_path / "cards", baseline=wide), workers=1).prediction
        for r in found.records:
            axes = Figure().subplots()
            _panel(axes, found, r)
            stress = 1e-3 * r.shown.measured[r.used]
            low, high = axes.get_ylim()
            assert low < stress.min() < stress.max() < high
            spans.append((high - low) / np.ptp(stress))
    assert max(spans) < 3.0


def test_a_named_specimen_widens_the_interval(measured: Path, tmp_path: Path) -> None:
    data = calibration.read_experiment(measured)
    named = replace(data, trials=tuple(replace(t, specimen="piece") for t in data.trials))
    cards = card(tmp_path / "cards")
    found = calibration.predict(named, cards, specimen_scatter=0.1, workers=1).prediction
    records = found.records
    sd = np.concatenate([r.sd("extended", "specimens") for r in records])
    stress = np.concatenate([r.predicted["extended"].value[r.used] for r in records])
    np.testing.assert_allclose(sd, 0.1 * np.abs(stress), rtol=1e-3, atol=1e-3)


def test_two_cards_of_one_material_are_refused(tmp_path: Path) -> None:
    folder = card(tmp_path / "cards")
    (folder / "S0_backup.yaml").write_text((folder / "S0.yaml").read_text())
    with pytest.raises(InputError, match=r"expected one card of S0, got S0\.yaml and S0_backup\.yaml"):
        read_cards(folder)


def test_cards_scale_their_parts_by_how_well_they_are_known(tmp_path: Path) -> None:
    effect = {
        "effect": "relaxation",
        "parameters": {"fraction_of_modulus": {"value": 0.2, "sd": 0.02}},
        "becomes": "viscosity",
    }
    (known,) = read_cards(card(tmp_path / "cards", effects=[effect])).values()
    model = extended_model(known)
    assert model.label == "relaxation"
    np.testing.assert_allclose(np.sqrt(np.diag(model.covariance)), [0.02 / 1.959964, 0.1], rtol=2e-4)
    more = model.law.material(model.u + np.array([0.0, np.log(1.1)]))
    assert more.viscosity is not None
    assert more.viscosity.spectrum().strengths == pytest.approx([0.066] * 6)


@pytest.mark.parametrize("logarithmic", [True, False])
def test_an_interval_of_a_modulus_is_read_as_it_was_written(tmp_path: Path, logarithmic: bool) -> None:
    """sd of 15 %: e^(1.96 sd) - 1 upwards where it is that of a logarithm, 1.96 sd where it is symmetric."""
    wide = 1.959964 * 0.15
    low, high = (np.expm1(-wide), np.expm1(wide)) if logarithmic else (-wide, wide)
    stated = {"shear_modulus_high": float(high), "shear_modulus_low": float(low), "text": ""}
    (known,) = read_cards(card(tmp_path / "cards", uncertainty=stated)).values()
    assert np.sqrt(extended_model(known).covariance[0, 0]) == pytest.approx(0.15, rel=0.04)


def test_what_lies_outside_of_where_a_card_was_measured_is_said(measured: Path, tmp_path: Path) -> None:
    """Relaxation measured for 20 s gives a note in tests of 30 and 62 s; measured for 100 s, it does not."""
    effect = {
        "effect": "relaxation",
        "parameters": {"fraction_of_modulus": {"value": 0.2, "sd": 0.02}},
        "becomes": "viscosity",
    }
    said = []
    for last in (20.0, 100.0):
        cards = card(tmp_path / "cards", effects=[effect | {"valid_range": {"time_s": [0.0, last]}}])
        said.append(calibration.predict(measured, cards, workers=1).prediction.notes)
    assert [n for n in said[0] if n not in said[1]] == [
        "S0: time_s 0 to 62 is predicted from 0 to 20; there the model's error may be larger than the"
        " intervals know"
    ]


def test_some_trials_predict_others(measured: Path, tmp_path: Path) -> None:
    """A fit of the diagnosis' models to the hold predicts the slow ramp."""
    found = calibration.predict(measured, calibrate="held", predict="slow", law="neo-hookean", workers=1)
    assert [r.trial for r in found.prediction.records] == ["slow"]
    assert found.prediction.models == ("baseline", "extended")
    skill = found.skill["homogeneous"]
    assert skill is not None
    assert skill > 0.5
    found.write(tmp_path / "out")
    told = json.loads((tmp_path / "out" / "prediction.json").read_text(encoding="utf-8"))
    assert told["source"] == "a fit to held"
    assert "relax" in told["sentence"] or "rate" in told["sentence"]


def test_what_the_fitted_trials_cannot_tell_widens_the_interval(tmp_path: Path) -> None:
    """In tension to 30 % a second invariant (truth) and an offset of the strain fit equally.

    They differ in the predicted equibiaxial tension.
    """
    c01 = 0.125 * 30e3
    c10 = 15e3 - c01
    stretch = np.linspace(1.0, 1.3, 25)
    stress = {
        "uniaxial": 2.0 * (stretch - stretch**-2) * (c10 + c01 / stretch),
        "equibiaxial": 2.0 * (stretch - stretch**-5) * (c10 + c01 * stretch**2),
    }
    rng = np.random.default_rng(2)
    tables, trials = {}, []
    for mode, true in stress.items():
        sd = 0.012 * float(true.max())
        noisy = true + sd * rng.standard_normal(true.size)
        tables[f"{mode}.csv"] = {"stretch": stretch, "nominal_stress_kPa": 1e-3 * noisy}
        trials.append(coupon_entry(mode, f"{mode}.csv", mode=mode, stretch_sd=0.0, stress_sd_kPa=1e-3 * sd))
    folder = write_experiment(tmp_path / "pulled", trials, tables=tables)
    found = calibration.predict(
        folder, calibrate="uniaxial", predict="equibiaxial", law="neo-hookean", workers=1
    ).prediction
    assert any("do not tell second-invariant from strain-offset" in note for note in found.notes)
    (record,) = found.records
    choice = record.sd("extended", "choice")
    # the difference of two equally likely models over sqrt(2); with an offset the stress is neo-Hookean
    one, other = (record.predicted[m].value[record.used] for m in ("extended", "baseline"))
    assert choice[-1] == pytest.approx(abs(one[-1] - other[-1]) / np.sqrt(2.0), rel=0.1)
    assert (record.sd("baseline", "choice") == 0.0).all()
    alone = record.predicted["extended"].sds
    assert record.sd("extended")[-1] == pytest.approx(
        np.sqrt(sum(s[record.used][-1] ** 2 for s in alone.values()))
    )


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"viscosity": {"kind": "prony", "fractions": [0.3]}}, "key viscosity"),
        ({"viscosity": {"kind": "kelvin"}}, "key viscosity.kind: expected one of prony"),
        ({"law": "ogden"}, "key law: expected one of neo-hookean, got ogden"),
        ({"viscosty": None}, "unknown key viscosty: expected viscosity"),
        ({"material": "S9"}, "expected a card of S0, found S9"),
        (
            {"effects": [{"effect": "relaxation", "parameters": {}, "becomes": "viscosity"}]},
            r"key effects\[#1\].parameters: expected at least 1, got 0",
        ),
    ],
)
def test_bad_cards_are_one_sentence(
    more: dict[str, Any], sentence: str, measured: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=sentence):
        calibration.predict(measured, card(tmp_path / "cards", **more), workers=1)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ([], "expected CARDS EXPERIMENT, or EXPERIMENT with --calibrate and --predict"),
        (["--calibrate", "held"], "--predict: expected the trials to predict, beside --calibrate"),
        (["--calibrate", "held", "--predict", "he*"], "expected trials that are not fitted to, got held"),
        (["--calibrate", "held", "--predict", "fast"], "fast: no trial has that id: expected some of slow,"),
        (["--calibrate", "held", "--predict", "age=3"], "expected ids of trials, or material=..."),
        (["--calibrate", "held", "--predict", ""], "--predict: expected ids of trials, got none"),
        (["--calibrate", "", "--predict", "slow"], "--calibrate: expected ids of trials, got none"),
        (["--calibrate", "held", "--predict", "slow", "--law", "jelly"], "--law jelly"),
        (["--calibrate", "held", "--predict", "slow", "--extend", "crep"], "--extend crep: expected effects"),
        (
            ["--calibrate", "held", "--predict", "slow", "--specimen-scatter", "0.1"],
            "--specimen-scatter 0.1: expected with cards only",
        ),
    ],
)
def test_bad_options_are_one_sentence(
    options: list[str], sentence: str, measured: Path, tmp_path: Path
) -> None:
    done = CliRunner().invoke(app, [str(measured), *options, "--out", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert sentence in done.output
    assert len(done.output.strip().splitlines()) == 1


def test_a_law_beside_cards_is_refused(measured: Path, tmp_path: Path) -> None:
    """It was taken and did nothing."""
    with pytest.raises(InputError, match=r"law.*expected without cards, which state their laws"):
        calibration.predict(measured, card(tmp_path / "cards"), law="ogden", workers=1)


def test_a_kind_that_does_not_follow_a_part_says_so(measured: Path, tmp_path: Path) -> None:
    data = calibration.read_experiment(measured)
    pressed = replace(data.trials[0], stretch=2.0 - data.trials[0].stretch)  # type: ignore[union-attr, call-arg]
    fibres = {"kind": "holzapfel-gasser-ogden", "direction": [1, 0, 0], "k1_Pa": 1e3}
    with pytest.raises(InputError, match="trial slow: fibres: expected no compression"):
        calibration.predict(
            replace(data, trials=(pressed,)),
            card(tmp_path / "cards", fibres=fibres),
            workers=1,
        )
