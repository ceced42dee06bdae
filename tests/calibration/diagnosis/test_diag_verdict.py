"""The file of a diagnosis: the keys and units that readers rely on."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fake_model import FakeModel, by_modulus, effect, library, noise, of_length, of_material, sigmas

from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.engine.verdict import Diagnosis

KEYS = {
    "format",
    "verdict",
    "causes",
    "alternatives",
    "baseline",
    "extended",
    "gain",
    "next_experiment",
    "seconds",
}
NUMBERS = {"reduced_chi2", "p_value", "rms_mm", "shear_modulus_Pa"}


def hidden(name: str, size: float) -> np.ndarray:
    return np.asarray(library()[name] * (size / sigmas(library()[name], FakeModel())))


def written(diagnosis: Diagnosis) -> dict[str, Any]:
    """Content of the file after writing and reading as JSON, which has no NaN or infinity."""
    data = json.loads(json.dumps(diagnosis.to_json(), allow_nan=False))
    assert isinstance(data, dict)
    return data


def check_schema(data: dict[str, Any]) -> None:
    assert set(data) >= KEYS
    assert data["format"] == 2
    assert data["verdict"] in ("none", "found", "ambiguous", "partly explained", "unexplained")
    named = data["verdict"] in ("found", "ambiguous", "partly explained")
    assert bool(data["causes"]) == bool(data["alternatives"]) == bool(data["extended"]) == named
    assert len(data["alternatives"]) == 1 or data["verdict"] != "found"
    assert len(data["alternatives"]) >= 2 or data["verdict"] != "ambiguous"
    for cause in data["causes"]:
        assert set(cause) == {"effect", "parameters", "scope", "confidence", "share"}
        assert isinstance(cause["effect"], str)
        assert isinstance(cause["scope"], str)
        assert 0.0 <= cause["confidence"] <= 1.0
        for parameter in cause["parameters"].values():
            assert set(parameter) == {"value", "sd"}
            assert parameter["sd"] > 0.0
            assert isinstance(parameter["value"], float)
    assert sorted(c["effect"] for c in data["causes"]) == (data["alternatives"] or [[]])[0]
    for numbers in (data["baseline"], data["extended"]):
        if numbers is not None:
            assert set(numbers) == NUMBERS
            assert 0.0 < numbers["p_value"] <= 1.0
            assert all(g > 0.0 for g in numbers["shear_modulus_Pa"].values())
    if data["gain"] is not None:
        assert set(data["gain"]) >= {"held_out", "rms_mm_before", "rms_mm_after", "log_likelihood"}
        assert isinstance(data["gain"]["held_out"], str)
    assert isinstance(data["next_experiment"], str)
    assert data["seconds"] >= 0.0


def test_found() -> None:
    model = FakeModel(hidden=hidden("bend", 12.0), drawn=noise(1))
    diagnosis = diagnose(model)
    data = written(diagnosis)
    check_schema(data)
    assert data["verdict"] == "found"
    (cause,) = data["causes"]
    assert cause["effect"] == "bend"
    assert cause["scope"] == "all"
    truth = 12.0 / sigmas(library()["bend"], model)
    size = cause["parameters"]["size_mm"]  # amplitude in the unit of the file
    assert size["sd"] == pytest.approx(1e3 * truth / 12.0, rel=1e-3)
    assert abs(size["value"] - 1e3 * truth) < 4.0 * size["sd"]
    assert cause["confidence"] > 0.95
    assert data["alternatives"] == [["bend"]]
    assert data["baseline"]["p_value"] < 0.005 < data["extended"]["p_value"]
    assert data["baseline"]["reduced_chi2"] > 2.0
    assert 0.5 < data["extended"]["reduced_chi2"] < 1.6
    assert data["extended"]["rms_mm"] < data["baseline"]["rms_mm"]
    assert data["extended"]["shear_modulus_Pa"] == pytest.approx(
        {"S0": np.exp(1.0), "S1": np.exp(-0.5)}, rel=0.2
    )
    assert data["gain"]["held_out"] == "leave-one-length-out"
    assert data["gain"]["rms_mm_after"] < data["gain"]["rms_mm_before"]
    assert data["next_experiment"] == "to confirm: measure bend"
    assert re.fullmatch(
        r"Found: there is bend \(bend\)\. With it the simulation agrees with the measurements to within"
        r" their noise, and it explains \d+ % of the misfit beyond noise in held-out measurements\.",
        diagnosis.sentence(),
    )


def test_three_causes() -> None:
    names = ("bend", "kink", "slack")
    model = FakeModel(hidden=np.sum([hidden(n, 14.0) for n in names], axis=0), drawn=noise(1))
    diagnosis = diagnose(model)
    data = written(diagnosis)
    check_schema(data)
    assert sorted(c["effect"] for c in data["causes"]) == list(names)
    for cause in data["causes"]:
        name, size = cause["effect"], cause["parameters"]["size_mm"]
        assert abs(size["value"] - 14e3 / sigmas(library()[name], model)) < 4.0 * size["sd"]
    assert diagnosis.sentence().startswith(
        "Found: there is bend; there is slack; and there is kink (bend + kink + slack). With them the"
    )


def test_a_cause_that_is_as_large_as_it_can_be_is_noted() -> None:
    most = 10.0 / sigmas(library()["bend"], FakeModel())
    near = effect("bend", bounds=(-most, most))
    for ends, noted in (((), []), ((most,), [f"bend: {1e3 * most:.3g} size_mm is at its physical limit"])):
        found = diagnose(
            FakeModel(
                hidden=hidden("bend", 11.0),
                drawn=noise(1),
                effects={"bend": replace(near, physical_limits=ends)},
            )
        )
        assert [n for n in found.notes if "physical limit" in n] == noted


def test_moduli_that_no_soft_material_has_are_noted() -> None:
    """Records in MPa that were said to be in kPa had a verdict like any other."""
    found = diagnose(FakeModel(drawn=noise(1)))
    usual = replace(found.baseline, shear_modulus_Pa={"S0": 30e3, "S1": 9e6})
    assert replace(found, baseline=usual).implausible == ()
    assert written(replace(found, baseline=usual))["notes"] == list(found.notes)
    stiff = replace(found, baseline=replace(usual, shear_modulus_Pa={"S0": 30e3, "S1": 30e6}))
    said = (
        "S1: a shear modulus of 3e+07 Pa is outside what soft tissue and rubber have (100 Pa to 10 MPa):"
        " check the units of the records (kPa, N, mm)"
    )
    assert written(stiff)["notes"] == [said, *found.notes]
    # with a cause the modulus is that beside it
    assert replace(stiff, extended=usual).implausible == ()
    assert replace(found, extended=replace(usual, shear_modulus_Pa={"S0": 3.0})).implausible[0][:16] == (
        "S0: a shear modu"
    )


def test_where_else_a_cause_may_sit_is_a_note() -> None:
    """A bend in the beams of S0 alone is a candidate for all beams, and for S0."""
    shapes = library()
    one = {"bend": np.where(of_material("S0"), shapes["bend"], 0.0), "kink": shapes["kink"]}
    model = FakeModel(shapes=one, scoped=("bend",), hidden=20.0 * one["bend"], drawn=noise(2))
    found = diagnose(model)
    assert found.finding.verdict == "found"
    (note,) = [n for n in found.notes if "cannot separate" in n]
    assert note.startswith("the data cannot separate bend from bend of S0, which would be ")
    assert "size_mm with shear moduli of S0 " in note
    apart = diagnose(FakeModel(scoped=("bend",), hidden=hidden("bend", 12.0), drawn=noise(2)))
    assert not [n for n in apart.notes if "cannot separate" in n]


def test_reduced_chi_square_is_over_the_degrees_of_freedom() -> None:
    model = FakeModel(hidden=hidden("bend", 12.0), drawn=noise(2))
    data = written(diagnose(model, gain=False))
    fits = []
    for columns in (model.by_u, np.column_stack([model.by_u, library()["bend"]])):
        left = model.data - columns @ np.linalg.lstsq(columns, model.data, rcond=None)[0]
        fits.append(left @ left / (72 - columns.shape[1]))
    assert data["baseline"]["reduced_chi2"] == pytest.approx(fits[0], rel=1e-6)
    assert data["extended"]["reduced_chi2"] == pytest.approx(fits[1], rel=1e-6)
    assert data["gain"] is None


def test_ambiguous() -> None:
    shapes = library()
    shapes["twin"] = shapes["bend"] + 0.03 * shapes["ripple"]
    diagnosis = diagnose(FakeModel(shapes=shapes, hidden=hidden("bend", 9.0), drawn=noise(3)))
    data = written(diagnosis)
    check_schema(data)
    assert data["verdict"] == "ambiguous"
    assert {tuple(a) for a in data["alternatives"]} == {("bend",), ("twin",)}
    assert [c["effect"] for c in data["causes"]] == data["alternatives"][0]
    first, second = data["alternatives"]
    assert data["next_experiment"] == f"no experiment of the catalogue parts {first[0]}, {second[0]}"
    assert diagnosis.sentence().endswith(f"({first[0]}); or {second[0]}.")


def test_where_a_rival_is_the_simulators_own_fault_that_is_mended_first() -> None:
    """No specimen is measured to test it, since the prediction would be that of the faulty simulator."""
    shapes = library()
    shapes["twin"] = shapes["bend"] + 0.03 * shapes["ripple"]
    model = FakeModel(shapes=shapes, hidden=hidden("bend", 9.0), drawn=noise(3))
    twin = model.effects["twin"]
    own = replace(twin, effect=replace(twin.effect, belongs_to="simulator"))
    model.effects = {**model.effects, "twin": own}
    data = written(diagnose(model, gain=False))
    assert data["verdict"] == "ambiguous"
    assert data["next_experiment"] == "before another experiment: measure twin (twin)"


def test_unexplained() -> None:
    shapes = library()
    shapes.pop("ripple")
    diagnosis = diagnose(FakeModel(shapes=shapes, hidden=hidden("ripple", 12.0), drawn=noise(4)))
    data = written(diagnosis)
    check_schema(data)
    assert data["verdict"] == "unexplained"
    assert data["causes"] == []
    assert data["alternatives"] == []
    assert data["extended"] is None
    assert data["gain"] is None
    assert "no cause in the library" in diagnosis.sentence()


def test_none_says_what_cannot_be_seen() -> None:
    shapes = library() | {"density": by_modulus("S0"), "faint": 1e-3 * library()["bend"]}
    effects = {"faint": effect("faint", prior_scale=1.0), "bend": effect("bend", prior_scale=1e9)}
    diagnosis = diagnose(FakeModel(shapes=shapes, effects=effects, drawn=noise(5)))
    data = written(diagnosis)
    check_schema(data)
    assert data["verdict"] == "none"
    assert data["next_experiment"] == "measure density (density cannot be seen)"
    unseen = {entry["effect"]: entry for entry in data["not_visible"]}
    assert unseen["density"] == {"effect": "density", "size_mm": None, "instead": "measure density"}
    threshold = 5.0 / (1e-3 * sigmas(library()["bend"], FakeModel()))
    assert unseen["faint"]["size_mm"] == pytest.approx(1e3 * threshold, rel=1e-6)
    assert "bend" not in unseen
    assert "agrees with the measurements" in diagnosis.sentence()


def test_an_effect_that_only_one_beam_has_says_so_in_scope_and_gain() -> None:
    only = np.where(of_length(3.0) & of_material("S0"), library()["bend"], 0.0)
    model = FakeModel(shapes=library() | {"bend": only}, scoped=("bend",))
    model.data = model.data + 15.0 / sigmas(only, model) * only + noise(6)
    data = written(diagnose(model))
    check_schema(data)
    assert data["verdict"] == "found"
    assert data["gain"]["held_out"] == "none"
    assert data["gain"]["rms_mm_before"] is None
    assert data["gain"]["log_likelihood"] is None
    assert data["gain"]["note"] == "no fold leaves enough of the effect in training"


def test_fits_that_did_not_converge_are_noted() -> None:
    class Slow(FakeModel):
        def start(self) -> np.ndarray:
            return np.array([400.0, -400.0])

    data = written(diagnose(Slow(drawn=noise(7)), gain=False))
    assert any(n.startswith("fit of baseline: not converged") for n in data["notes"])
