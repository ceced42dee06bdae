"""Results of a diagnosis as cards for the factory and for later calibrations."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import coupon_entry, write_experiment
from card_cases import MODULI, bench, diagnosis

import calibration
import tisim
from calibration.diagnosis import Candidate, Diagnosis
from calibration.diagnosis.card import check_names, write_cards
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.diagnosis.rig import read_rig
from calibration.errors import InputError
from calibration.experiment import read
from calibration.experiment.model import BeamTrial
from calibration.measurements.homogeneous.stress import nominal_stress
from calibration.measurements.outlines._effect import Situation
from factory.materials import LAWS, load_card, material_of

STIFFENING = Candidate(effect="strain-stiffening", at="S1", alternatives=2)
CURVATURE = Candidate(effect="residual-curvature", at="S1-b", alternatives=3)
TILT = Candidate(effect="clamp-tilt")
SCALE = Candidate(effect="image-scale")


def content(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return found


def test_the_factory_takes_the_cards_of_a_found_effect(tmp_path: Path) -> None:
    experiment = bench(tmp_path / "bench")
    found = diagnosis({STIFFENING: 0.5}, rivals=[("strain-stiffening",), ("taper", "skin")])
    written = write_cards(tmp_path / "cards", found, experiment)
    assert [p.name for p in written] == ["S0.yaml", "S1.yaml"]
    card = load_card("S1", tmp_path / "cards")
    for law in LAWS:
        moduli = tisim.laws.get(law).moduli(card.for_law(law).parameters)
        assert moduli.shear_modulus == pytest.approx(MODULI["S1"], rel=1e-4)
        assert moduli.bulk_modulus == pytest.approx(300.0 * MODULI["S1"], rel=1e-4)
    (effect,) = card.effects
    assert (effect.effect, effect.applies_to, effect.scope) == ("strain-stiffening", "material", "S1")
    assert effect.parameters["c2_over_c1"].value == 0.5
    assert effect.parameters["c2_over_c1"].sd == pytest.approx(
        found.causes()[0]["parameters"]["c2_over_c1"]["sd"], rel=1e-4
    )
    assert effect.valid_range == {"free_length_mm": (50.0, 100.0), "time_s": (60.0, 110.0)}
    assert effect.rivals == ("taper + skin",)
    assert effect.gain is not None
    assert effect.gain["rms_mm_before"] == pytest.approx(0.4)
    assert effect.experiment_sha256 == experiment.digest
    assert material_of(card).law == "yeoh"
    assert load_card("S0", tmp_path / "cards").effects == ()
    assert "by calibration.diagnose, baseline law neo-hookean, other laws filled in" in card.provenance
    assert "Verdict: found" in card.provenance


def test_uncertainty_and_correlation_are_the_fits(tmp_path: Path) -> None:
    """Against the inverse of the normal matrix, computed here."""
    found = diagnosis({STIFFENING: 0.5})
    write_cards(tmp_path / "cards", found, bench(tmp_path / "bench"))
    fit = found.finding.explanations[0].fit
    jacobian = np.column_stack([fit.linear.by_u, fit.linear.columns])
    c = np.linalg.inv(jacobian.T @ jacobian)
    modulus = np.array([0.0, 0.5, 0.5, 0.0])  # ln G of S1 is the mean over its two specimens
    sd = np.sqrt(modulus @ c @ modulus)
    card = load_card("S1", tmp_path / "cards")
    assert card.uncertainty.shear_modulus_high == pytest.approx(1.96 * sd, abs=1e-5)
    expected = c[3] @ modulus / np.sqrt(c[3, 3]) / sd
    assert card.effects[0].correlations["shear_modulus"] == pytest.approx(expected, rel=1e-4)
    assert abs(expected) > 0.1


def test_a_materials_card_has_its_own_misfit(tmp_path: Path) -> None:
    """M1 differs from the law by 5 %, M0 by its noise: the error of M0 does not depend on its neighbour."""
    random = np.random.default_rng(5)
    stretch = np.linspace(1.0, 1.5, 40)
    tables, trials = {}, []
    for name, wave in (("M0", 0.0), ("M1", 0.05)):
        stress = 30.0 * (stretch - stretch**-2) * (1.0 + wave * np.sin(12.0 * stretch))
        stress = stress + 0.05 * random.standard_normal(40)
        tables[f"{name}.csv"] = {"stretch": stretch, "nominal_stress_kPa": stress}
        entry = coupon_entry(name, f"{name}.csv", material=name, stress_sd_kPa=0.05)
        trials.append({key: value for key, value in entry.items() if key != "stretch_sd"})
    experiment = calibration.read_experiment(write_experiment(tmp_path / "two", trials, tables=tables))
    found = calibration.diagnose(experiment, law="neo-hookean", gain=False, workers=1).diagnosis
    write_cards(tmp_path / "cards", found, experiment)
    errors = [content(tmp_path / "cards" / f"{name}.yaml")["model_error"] for name in ("M0", "M1")]
    assert errors[0] < 0.002
    assert errors[1] > 0.01


def test_a_law_in_place_of_the_baselines_is_the_cards(tmp_path: Path) -> None:
    """Coupons of Ogden's law to a stretch of 5 and 2; the time stated is that of both rounds."""
    ogden = tisim.Material(law="ogden", parameters={"mu": (20e3,), "alpha": (3.5,), "bulk": 1e8})
    random, trials, tables = np.random.default_rng(3), [], {}
    for mode, last in (("uniaxial", 5.0), ("equibiaxial", 2.0)):
        stretch = np.linspace(1.05, last, 30)
        stress = 1e-3 * nominal_stress(ogden, mode, stretch)  # type: ignore[arg-type]
        stress = stress * (1.0 + 0.003 * random.standard_normal(30))
        tables[f"{mode}.csv"] = {"stretch": stretch, "nominal_stress_kPa": stress}
        entry = coupon_entry(mode, f"{mode}.csv", material="M", mode=mode)
        trials.append({k: v for k, v in entry.items() if k not in ("stretch_sd", "stress_sd_kPa")})
    experiment = calibration.read_experiment(write_experiment(tmp_path / "rubber", trials, tables=tables))
    times: list[float] = []
    found = calibration.diagnose(
        experiment, gain=False, workers=1, on_progress=lambda _: times.append(time.monotonic())
    ).diagnosis
    assert [c["effect"] for c in found.causes()] == ["law-form"]
    assert found.seconds > times[-1] - times[0]
    write_cards(tmp_path / "cards", found, experiment)
    card = load_card("M", tmp_path / "cards")
    assert (card.law, card.effects[0].becomes) == ("ogden", "law")
    assert "law-form (ogden) is the card's law, ogden." in card.provenance
    made = material_of(card)
    assert (made.law, made.parameters["alpha"]) == ("ogden", pytest.approx((3.5,), rel=0.05))


def test_each_effect_goes_where_it_belongs(tmp_path: Path) -> None:
    experiment = bench(tmp_path / "bench")
    causes = {TILT: 0.02, STIFFENING: 0.5, CURVATURE: 0.7, SCALE: 0.004}
    write_cards(tmp_path / "cards", diagnosis(causes), experiment)
    effects = load_card("S1", tmp_path / "cards").effects
    assert [(e.effect, e.applies_to) for e in effects] == [
        ("strain-stiffening", "material"),
        ("residual-curvature", "shape"),
    ]
    assert effects[1].scope == "S1-b"
    assert effects[1].valid_range["free_length_mm"] == (100.0, 100.0)
    rig = content(tmp_path / "cards" / "rig.yaml")
    assert [(e["effect"], e["belongs_to"]) for e in rig["effects"]] == [
        ("clamp-tilt", "rig"),
        ("image-scale", "camera"),
    ]
    assert rig["effects"][0]["parameters"]["angle_deg"]["value"] == pytest.approx(np.degrees(0.02), rel=1e-5)
    assert rig["experiment_sha256"] == experiment.digest
    assert "must not enter a dataset" in rig["use"]
    known = read_rig(tmp_path / "cards" / "rig.yaml")
    assert known.amplitudes == pytest.approx((0.02, 0.004), rel=1e-5)
    covariance = diagnosis(causes).finding.explanations[0].fit.covariance()[3:, 3:]
    np.testing.assert_allclose(known.covariance, covariance[np.ix_([0, 3], [0, 3])], rtol=1e-4)
    assert abs(known.covariance[0][1]) > 0.1 * known.covariance[0][0]


@pytest.mark.parametrize("name", ["rig", "Rig"])
def test_no_material_is_named_as_the_rigs_card(name: str) -> None:
    with pytest.raises(InputError, match=f"material {name}: expected another name, since rig.yaml is"):
        check_names({"S0", name})


@pytest.mark.parametrize("verdict", ["none", "unexplained"])
def test_without_a_cause_cards_are_the_baselines(verdict: str, tmp_path: Path) -> None:
    experiment = bench(tmp_path / "bench")
    cards = tmp_path / "cards"
    write_cards(cards, diagnosis({TILT: 0.02}), experiment)
    assert (cards / "rig.yaml").exists()
    write_cards(cards, diagnosis({}, verdict=verdict), experiment)
    card = load_card("S0", cards)
    assert card.effects == ()
    shear = card.for_law("neo-hookean").parameters["mu"]
    assert shear == pytest.approx(MODULI["S0"] * np.exp(0.1), rel=1e-5)
    assert f"Verdict: {verdict}" in card.provenance
    assert ("the measurements depart from it" in card.provenance) == (verdict == "unexplained")
    assert not (cards / "rig.yaml").exists()  # the rig of the earlier diagnosis is removed


def test_a_material_called_rig_is_refused(tmp_path: Path) -> None:
    text = (
        (bench(tmp_path / "bench").folder / "experiment.yaml")
        .read_text()
        .replace("material: S0", "material: rig")
    )
    (tmp_path / "bench" / "experiment.yaml").write_text(text.replace("  S0:", "  rig:"))
    found = diagnosis({TILT: 0.02})
    object.__setattr__(found.extended, "shear_modulus_Pa", {"rig": 30e3, "S1": 10e3})
    with pytest.raises(InputError, match="material rig: expected another name"):
        write_cards(tmp_path / "cards", found, read(tmp_path / "bench"))
    assert not (tmp_path / "cards").exists()


def test_moduli_that_are_not_the_fits_are_an_error(tmp_path: Path) -> None:
    found: Diagnosis = diagnosis({STIFFENING: 0.5})
    object.__setattr__(found.extended, "shear_modulus_Pa", {"S0": 30e3, "S1": 10.1e3})
    with pytest.raises(ValueError, match="material S1: its modulus is not that"):
        write_cards(tmp_path / "cards", found, bench(tmp_path / "bench"))


@pytest.mark.parametrize(
    ("name", "amplitude"),
    [("strain-stiffening", 0.5), ("compressibility", 0.1), ("density", 0.04), ("creep", 0.05)],
)
def test_a_dataset_gets_the_material_that_the_diagnosis_had(
    name: str, amplitude: float, tmp_path: Path
) -> None:
    """The factory's material equals that of the scene that explained the measurements, 1 s after release."""
    experiment = bench(tmp_path / "bench")
    write_cards(tmp_path / "cards", diagnosis({Candidate(effect=name): amplitude}), experiment)
    trial = experiment.trials[0]
    assert isinstance(trial, BeamTrial)
    # a stiffening material is simulated as yeoh throughout, the other materials as neo-Hookean
    base = "yeoh" if name == "strain-stiffening" else "neo-hookean"
    plain = tisim.material_from_moduli(base, shear_modulus=30e3, bulk_modulus=9e6, density=1000.0)
    situation = Situation(trial=trial, time=1.0)
    scene = EFFECTS[name].bend(tisim.Beam(material=plain, length=0.05), amplitude, situation)
    made = material_of(load_card("S0", tmp_path / "cards"))
    assert (made.law, made.density) == (scene.material.law, pytest.approx(scene.material.density))
    assert dict(made.parameters) == pytest.approx(dict(scene.material.parameters), rel=1e-4)


def test_cards_of_an_earlier_diagnosis_of_other_materials_are_removed(tmp_path: Path) -> None:
    """A fit's card stays, whose provenance names calibration.diagnose as what to do next."""
    cards = tmp_path / "cards"
    (earlier, *_) = write_cards(cards, diagnosis({STIFFENING: 0.5}), bench(tmp_path / "bench"))
    other = earlier.rename(cards / "other.yaml")
    fitted = {
        **content(other),
        "material": "kept",
        "provenance": "Lack of fit: python -m calibration.diagnose",
    }
    (cards / "kept.yaml").write_text(yaml.safe_dump(fitted), encoding="utf-8")
    (cards / "damaged.yaml").write_text("laws: [", encoding="utf-8")
    write_cards(cards, diagnosis({STIFFENING: 0.5}), bench(tmp_path / "again"))
    assert sorted(p.name for p in cards.iterdir()) == ["S0.yaml", "S1.yaml", "damaged.yaml", "kept.yaml"]
