"""A fit's card predicts with the covariance of all constants of the fit, not of its modulus alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import coupon_entry, write_experiment

import calibration
from benchmarks.blind.timed.coupons import respond
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Solid
from calibration.errors import InputError
from factory.materials import load_card

G, FRACTION, TAU = 3e4, 0.5, 8.0
FITTED = Course(start=1.0, samples=30).ramp(1.2, 0.1).hold(40.0)
AHEAD = Course(start=1.0, samples=25).ramp(1.3, 0.01).hold(10.0)


def stress(course: Course, log_modulus: float, log_fraction: float, log_time: float) -> Any:
    prony = Prony(fractions=(float(np.exp(log_fraction)),), times=(float(np.exp(log_time)),))
    return respond(
        Solid(mu=(float(np.exp(log_modulus)),), alpha=(2.0,), prony=prony), "uniaxial", course, tolerance=1e-7
    )


def experiment(folder: Path, course: Course, sd: float, rng: np.random.Generator) -> Path:
    made = stress(course, np.log(G), np.log(FRACTION), np.log(TAU))
    noise = sd * float(made.stress.max())
    table = {
        "time_s": made.time,
        "stretch": made.stretch,
        "nominal_stress_kPa": 1e-3 * (made.stress + noise * rng.standard_normal(made.stress.size)),
    }
    entry = coupon_entry("pull", "pull.csv", stretch_sd=0.0, stress_sd_kPa=1e-3 * noise)
    return write_experiment(folder, [entry], tables={"pull.csv": table})


@pytest.fixture(scope="module")
def cards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fitted")
    rng = np.random.default_rng(11)
    data = experiment(folder / "data", FITTED, 0.02, rng)
    fits = calibration.fit(data, model="neo-hookean", time="prony:1", held_out=False, workers=1)
    assert fits.converged
    fits.write_cards(folder / "cards")
    return folder / "cards"


def test_the_interval_is_that_of_all_constants(cards: Path, tmp_path: Path) -> None:
    """The covariance by the blind laboratory's own stress: (J' J)^-1 of the fit, J C J' of the prediction."""
    stated = yaml.safe_load((cards / "S0.yaml").read_text(encoding="utf-8"))
    known = dict(
        zip(stated["uncertainty"]["fit"]["coordinates"], stated["uncertainty"]["fit"]["values"], strict=True)
    )
    at = np.array([known[n] for n in ("shear_modulus", "prony_fraction_1", "prony_time_1")])

    def slopes(course: Course) -> Any:
        return np.array(
            [
                (stress(course, *(at + h)).stress - stress(course, *(at - h)).stress) / 2e-3
                for h in 1e-3 * np.eye(3)
            ]
        ).T

    noise = 0.02 * float(stress(FITTED, np.log(G), np.log(FRACTION), np.log(TAU)).stress.max())
    J = slopes(FITTED)[1:] / noise
    expected = np.sqrt(np.diag(slopes(AHEAD) @ np.linalg.inv(J.T @ J) @ slopes(AHEAD).T))

    ahead = experiment(tmp_path / "ahead", AHEAD, 0.005, np.random.default_rng(12))
    found = calibration.predict(ahead, cards=cards, workers=1).prediction
    (record,) = found.records
    sd = record.predicted["extended"].sds["parameters"]
    # the error bars are scaled by the fit's own misfit, at least 1, and have the prior's small part
    np.testing.assert_allclose(sd[2:], expected[2:], rtol=0.25)
    assert not any("viscosity" in note for note in found.notes)


def test_without_it_the_relaxation_is_taken_as_exact_and_this_is_said(cards: Path, tmp_path: Path) -> None:
    stated = yaml.safe_load((cards / "S0.yaml").read_text(encoding="utf-8"))
    del stated["uncertainty"]["fit"]
    (tmp_path / "cards").mkdir()
    (tmp_path / "cards" / "S0.yaml").write_text(yaml.safe_dump(stated), encoding="utf-8")
    ahead = experiment(tmp_path / "ahead", AHEAD, 0.005, np.random.default_rng(12))
    found = calibration.predict(ahead, cards=tmp_path / "cards", workers=1).prediction
    assert any("does not state how well its viscosity is known" in note for note in found.notes)


def test_the_factory_takes_such_a_card(cards: Path) -> None:
    assert load_card("S0", cards).viscosity is not None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"laws": {"neo-hookean": {"mu": 4e4, "lam": 1e7}}}, "as the card states them"),
        ({"viscosity": {"kind": "prony", "fractions": [0.4], "times": [8.0]}}, "as the card states them"),
        ({"viscosity": None}, "as the card states them"),
        ({"coordinates": ["shear_modulus"]}, "uncertainty.fit.coordinates: expected shear_modulus, bulk"),
        ({"covariance": [[1.0]]}, r"covariance of shape \(4, 4\)"),
        ({"covariance": (-np.eye(4)).tolist()}, r"covariance of shape \(4, 4\)"),
    ],
)
def test_a_covariance_of_another_material_is_refused(
    cards: Path, tmp_path: Path, change: dict[str, Any], words: str
) -> None:
    stated = yaml.safe_load((cards / "S0.yaml").read_text(encoding="utf-8"))
    fit = stated["uncertainty"]["fit"]
    for key, value in change.items():
        (fit if key in fit else stated)[key] = value
    (tmp_path / "S0.yaml").write_text(yaml.safe_dump(stated), encoding="utf-8")
    data = experiment(tmp_path / "data", AHEAD, 0.005, np.random.default_rng(12))
    with pytest.raises(InputError, match=words):
        calibration.predict(data, cards=tmp_path / "S0.yaml", workers=1)


def test_a_lack_of_fit_is_said_where_its_card_predicts(tmp_path: Path) -> None:
    """A prediction that was off by 100 times its intervals had no word on it."""
    stretch = np.linspace(1.0, 1.8, 30)
    stiffening = {
        f"{k}.csv": {
            "stretch": stretch,
            "nominal_stress_kPa": 30.0 * (stretch - stretch**-2) * (1.0 + k + stretch**3),
        }
        for k in range(2)
    }
    for k, table in stiffening.items():
        write_experiment(tmp_path / k, [coupon_entry("pull", k, stretch_sd=0.0)], tables={k: table})
    fits = calibration.fit(tmp_path / "0.csv", model="neo-hookean", generations=5, workers=1)
    assert [r.status for r in fits] == ["lack of fit"]
    (path,) = fits.write_cards(tmp_path / "cards")
    assert load_card("S0", path.parent).fitted_to["status"] == "lack of fit"  # type: ignore[index]
    notes = calibration.predict(tmp_path / "1.csv", path.parent, workers=1).prediction.notes
    assert any("no calibration, lack of fit (reduced chi-square" in n for n in notes), notes
    content = yaml.safe_load(path.read_text())
    del content["fitted_to"]["status"], content["fitted_to"]["why"]
    path.write_text(yaml.safe_dump(content))
    assert not any(
        "lack" in n for n in calibration.predict(tmp_path / "1.csv", path, workers=1).prediction.notes
    )
