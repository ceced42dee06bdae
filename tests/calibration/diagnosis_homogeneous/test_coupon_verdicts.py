"""Complete diagnoses of synthetic homogeneous tests: causes, advice, figures. Blind cases: tests/blind."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml
from diagnosis_coupon_cases import Array, G, coupon_model, experiment, neo_hookean, ramps, trial
from matplotlib.image import imread

from calibration.diagnosis.card import write_cards
from calibration.diagnosis.drawing import figures_of
from calibration.diagnosis.engine.advice import advise
from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.engine.search import search
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.homogeneous.model import HomogeneousModel
from tisim import laws


def softened(mode: str, s: Array) -> Array:
    """Stress with a rig compliance of 1e-6 per Pa, at the strains `s` of the rig's displacement."""
    grid = np.linspace(0.5, 3.0, 20001)
    p = neo_hookean(mode, grid)
    return np.interp(s, grid + 1e-6 * p, p)


@cache
def diagnosed() -> tuple[HomogeneousModel, Diagnosis]:
    trials = [
        trial("pull", "uniaxial", ramps(2.0, 2), softened, seed=1),
        trial("sheet", "equibiaxial", ramps(1.5, 2), softened, seed=2),
    ]
    model = coupon_model(experiment(*trials))
    return model, diagnose(model)


def test_a_soft_rig_is_found_and_its_gain_measured() -> None:
    _, found = diagnosed()
    assert found.finding.verdict == "found"
    (cause,) = found.causes()
    assert cause["effect"] == "machine-compliance"
    assert cause["scope"] == "all"
    estimate = cause["parameters"]["strain_per_MPa"]
    assert abs(estimate["value"] - 1.0) < 3.0 * estimate["sd"]
    assert found.extended is not None
    assert found.extended.shear_modulus_Pa["A"] == pytest.approx(G, rel=0.02)
    told = found.to_json()
    assert told["gain"]["rms_kPa_after"] < 0.7 * told["gain"]["rms_kPa_before"]
    assert told["gain"]["rms_kPa_after"] == pytest.approx(told["gain"]["rms_kPa_noise"], rel=0.2)


def test_without_the_cause_its_name_is_not_used() -> None:
    model, _ = diagnosed()
    less = coupon_model(model.experiment, without=["machine-compliance"])
    finding = search(less)
    named = {name for names in finding.equivalent for name in names}
    assert "machine-compliance" not in named
    assert finding.verdict != "none"


def test_stiffening_and_locking_part_further_out() -> None:
    def stiff(mode: str, s: Array) -> Array:
        excess = {"uniaxial": s**2 + 2 / s - 3, "planar": s**2 + s**-2 - 2}[mode]
        return neo_hookean(mode, s) * (1.0 + 0.1 * excess)

    trials = [
        trial("pull", "uniaxial", ramps(1.8, 1), stiff, seed=1, sd=400.0),
        trial("strip", "planar", ramps(1.7, 1), stiff, seed=2, sd=400.0),
    ]
    model = coupon_model(experiment(*trials))
    found = diagnose(model, gain=False)
    assert found.finding.verdict == "ambiguous"
    assert {"strain-stiffening"} in [set(names) for names in found.finding.equivalent]
    assert {"limited-extensibility"} in [set(names) for names in found.finding.equivalent]
    one_each = [next(e for e in found.finding.explanations if e.names == n) for n in found.finding.equivalent]
    best = advise(model, one_each)[0]
    assert best.name in ("further", "twice", "to-the-end")
    assert best.sentence in found.next_experiment
    assert {i.effect for i in found.undetectable} >= {"rate-dependence", "hysteresis", "mullins"}


def test_pictures_show_something() -> None:
    model, found = diagnosed()
    pictures = figures_of(model, found)
    by_name = {p.name: p for p in pictures}
    assert list(by_name) == ["residuals", "curves", "rms"]  # the curves coincide
    for p in pictures:
        file = io.BytesIO()
        p.figure.savefig(file, format="png")
        file.seek(0)
        pixels = imread(file)
        assert pixels.std() > 0.02
        assert p.caption
    labels = [t.get_text() for t in by_name["curves"].figure.legends[0].get_texts()]
    assert labels == ["measured", "baseline", "extended (machine-compliance)"]
    assert "2 records, 158 points" in model.noise_sentence()


def test_pictures_without_a_cause() -> None:
    model = coupon_model(experiment(trial("$odd_name$ <b>", "planar", ramps(1.6, 1))))
    found = diagnose(model)
    assert found.finding.verdict == "none"
    for p in figures_of(model, found):
        p.figure.savefig(io.BytesIO(), format="png")


@pytest.mark.parametrize(("times", "verdict"), [(1.3, "none"), (2.2, "unexplained")])
def test_specimens_of_one_material_that_differ_too_much_are_unexplained(times: float, verdict: str) -> None:
    """For example if a file was assigned to a wrong material."""
    trials = [
        trial(
            f"t{k}{n}",
            mode,
            ramps(1.4, 2),
            lambda m, s, k=k: times ** (k - 1) * neo_hookean(m, s),  # type: ignore[misc]
            specimen=f"piece {k}",
            seed=10 * k + n,
        )
        for k in range(3)
        for n, mode in enumerate(("uniaxial", "planar"))
    ]
    found = diagnose(coupon_model(experiment(*trials)))
    finding = found.finding
    assert finding.verdict == verdict
    assert ("assigned to its own specimen" in found.next_experiment) == (verdict == "unexplained")
    seen = {name for name, p in finding.lack_of_fit.each.items() if p < 0.005}
    assert seen == ({"specimens"} if verdict == "unexplained" else set())


def test_a_card_has_the_bulk_modulus_that_the_baseline_has(tmp_path: Path) -> None:
    """Homogeneous tests are fitted at K/G 3000, where stresses are practically the incompressible ones."""
    model, found = diagnosed()
    assert model.baseline.bulk_ratio == 3000.0
    (path, _rig) = write_cards(tmp_path / "cards", found, model.experiment)
    card = yaml.safe_load(path.read_text(encoding="utf-8"))
    moduli = laws.get("neo-hookean").moduli(card["laws"]["neo-hookean"])
    assert moduli.bulk_modulus / moduli.shear_modulus == pytest.approx(3000.0, rel=1e-4)
    assert "3000 shear moduli" in card["uncertainty"]["text"]
