"""Verdicts, figures and nuisances as readable text."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml
from report_cases import beam_folder, calibration, estimate, failed

from calibration.cli import law_table
from calibration.experiment import BeamTrial, read
from calibration.measurements.outlines._photographs import photographs_of
from calibration.pages import significant, with_sd
from calibration.report._compare import compare, far_nuisances
from calibration.report._draw_parameters import _shear
from calibration.report._words import verdict
from calibration.study.calibration import Calibration
from calibration.study.cards import shear_interval


def test_laws_that_are_alike() -> None:
    said = verdict([calibration(), calibration("ogden", chi2=89.5, shear_modulus=1.02e5)])
    assert said == (
        "A: shear modulus 100.0 ± 0.7 kPa by neo-hookean; the 2 laws cannot be told apart by this data"
        " (G 100.0 to 102.0 kPa among them)."
    )


def test_overlaps_have_no_noise_to_miss() -> None:
    """A Dice is no likelihood: neither a misfit nor Akaike's difference is stated."""

    def dice(label: str, value: float) -> Calibration:
        chi2 = 9.0 * (1.0 - value) / 1e-4
        return calibration(
            label, objective="dice", points=9, chi2=chi2, reduced_chi2=chi2 / 7.0, estimates=()
        )

    found = [dice("neo-hookean", 0.955), dice("ogden", 0.95)]
    said = verdict(found)
    assert "fitted to overlaps, mean Dice 0.9550 of 9 photographs, of ogden 0.9500" in said
    assert "misses" not in said
    assert "told apart" not in said
    comparison = compare(found)
    assert comparison is not None
    assert comparison.differences == {}


def test_a_law_that_the_data_prefer() -> None:
    said = verdict([calibration(), calibration("ogden", chi2=60.0, reduced_chi2=60.0 / 97.0), failed()])
    assert said == (
        "A: shear modulus 100.0 ± 0.7 kPa by ogden; the data prefer it to all others"
        " (next neo-hookean, Akaike difference 28.0)."
    )


def test_a_law_that_is_a_little_better() -> None:
    said = verdict([calibration(), calibration("ogden", chi2=91.0)])
    assert said.endswith("the data slightly prefer it to others (next ogden, Akaike difference 3.00).")


def test_some_laws_are_alike() -> None:
    laws = [calibration(), calibration("ogden", chi2=89.0), calibration("mooney-rivlin", chi2=120.0)]
    assert "this data cannot tell it from ogden" in verdict(laws)
    found = compare(laws)
    assert found is not None
    assert found.refuted == ("mooney-rivlin",)


def test_a_law_at_a_bound_is_not_alike_but_better() -> None:
    said = verdict([calibration(), calibration("ogden", chi2=60.0, unsettled=("alpha",))])
    assert "cannot be told apart" not in said
    assert "none has a fit with all constants inside their bounds" in said
    assert "ogden fits better (Akaike difference -28.0), but a constant of it is at a bound" in said


def test_misfit_shrinks_differences() -> None:
    # a difference of 30 in chi-square is decisive at the noise level, but not if all laws miss by ten times
    # it
    laws = [
        calibration(chi2=980.0, reduced_chi2=10.0),
        calibration("ogden", chi2=970.0, reduced_chi2=10.0),
    ]
    found = compare(laws)
    assert found is not None
    assert found.chosen.label == "neo-hookean"  # the other one has a constant more
    assert found.differences["ogden"] == pytest.approx(2.0 - 10.0 / 10.0)
    assert "even this law misses the data by more than the stated noise (reduced chi-square 10.0)" in verdict(
        laws
    )


def test_one_law() -> None:
    assert verdict([calibration()]).endswith("by neo-hookean; no other law was tried.")
    assert "of 1 other laws none has a fit" in verdict([calibration(), failed("ogden")])


@pytest.mark.parametrize("seen", ["not identified", "at a bound"])
def test_a_modulus_that_the_data_do_not_determine(seen: Any) -> None:
    """A record at rest was calibrated to "0 ± 3 kPa", as if that were measured."""
    unseen = calibration(estimates=(replace(estimate("shear_modulus"), seen=seen),))
    assert "100.0 ± 0.7 kPa by neo-hookean; the data do not determine it" in verdict([unseen])
    assert "determine it" not in verdict([calibration(estimates=(estimate("shear_modulus"),))])


def test_fits_that_are_not_whole() -> None:
    assert "of a fit that did not converge" in verdict([calibration(status="not converged")])
    assert "without error bars, since the fit was not polished" in verdict([calibration(estimates=())])
    stopped = verdict([calibration(status="stopped", estimates=(), reduced_chi2=9.0)])
    assert stopped.endswith("the best so far of a search that was stopped, without error bars.")
    assert verdict([failed()]) == "A: no result, since no law has a fit (1 no equilibrium)."


@pytest.mark.parametrize(
    ("value", "sd", "text"),
    [
        (9.6812, 0.0683, "9.68 ± 0.07"),
        (9.6812, 0.0123, "9.681 ± 0.012"),
        (29.27, 0.0096, "29.270 ± 0.010"),
        (368.92, 6.4, "369 ± 6"),
        (36892.0, 640.0, "36900 ± 600"),
        (9.6812, float("nan"), "9.681"),
        (float("nan"), 1.0, "–"),
    ],
)
def test_as_many_digits_as_the_sd_allows(value: float, sd: float, text: str) -> None:
    assert with_sd(value, sd) == text


def test_significant() -> None:
    assert [significant(x) for x in (0.0, 0.01234, 1.0, 999.6, 12345.0)] == [
        "0",
        "0.0123",
        "1.00",
        "1000",
        "12300",
    ]


def test_nuisances_beyond_two_sd(tmp_path: Path) -> None:
    moved = {
        "shift x of hanging at 60 s": 2.5,
        "roll of hanging at 60 s": -4.0,
        "radius of S1": 3.0,
        "free length of hanging": 1.9,
        "density of S1": -2.2,
        "mesh of hanging": 2.1,
    }
    found = far_nuisances(calibration(material="S1", nuisances=moved), read(beam_folder(tmp_path / "data")))
    # sds of the experiment: shift 0.1 mm, roll 0.15 degrees, radius 0.05 mm, density 5 kg/m3
    assert [(m.name, m.amount) for m in found] == [
        ("roll of hanging at 60 s", "-0.6 deg"),
        ("radius of S1", "+0.15 mm"),
        ("shift x of hanging at 60 s", "+0.25 mm"),
        ("density of S1", "-11 kg/m³"),
        ("mesh of hanging", ""),
    ]


def test_nuisances_of_two_photographs_of_one_instant_are_told_apart(tmp_path: Path) -> None:
    """Under one name those of the second hid those of the first, in the result and in its lack of fit."""
    folder = beam_folder(tmp_path / "data")
    content = yaml.safe_load((folder / "experiment.yaml").read_text(encoding="utf-8"))
    hanging = next(t for t in content["trials"] if t["id"] == "hanging")
    again = {**hanging["captures"][0], "registration_sd": {"shift_mm": 0.2, "roll_deg": 0.15, "scale": 0.003}}
    hanging["captures"] += [again, {**again, "time_s": 90.0}]
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    experiment = read(folder)
    beam = next(t for t in experiment.trials if isinstance(t, BeamTrial) and t.id == "hanging")
    names = [p.name for p in photographs_of([beam])]
    assert names == ["hanging at 60 s (1)", "hanging at 60 s (2)", "hanging at 90 s"]
    moved = {f"shift x of {name}": 2.5 for name in names}
    found = far_nuisances(calibration(material="S1", nuisances=moved), experiment)
    assert [m.amount for m in found] == ["+0.25 mm", "+0.5 mm", "+0.5 mm"]


def test_the_interval_of_a_modulus_is_that_of_its_constants() -> None:
    """Student's, where the scatter of a few specimens is in it, for laws of several terms too."""
    one = calibration(estimates=(replace(estimate(), low=0.75e5, high=1.33e5),))
    assert shear_interval(one) == (-0.25, 0.33)
    label, value, low, high, _ = _shear(one)
    assert (label, value, low, high) == ("neo-hookean", 100.0, 75.0, 133.0)
    wide = math.exp(4.3 * 0.007)
    term = replace(estimate("shear_modulus_1"), low=1e5 / wide, high=1e5 * wide)
    two = calibration(estimates=(term, estimate("bulk_ratio", value=300.0)))
    half = 4.3 * two.shear_modulus_sd / two.shear_modulus
    assert shear_interval(two) == pytest.approx((-half, half), abs=1e-5)
    assert _shear(two)[2:4] == pytest.approx((100.0 * (1 - half), 100.0 * (1 + half)), abs=1e-2)
    # a diagnosis has the sd alone
    assert shear_interval(calibration(estimates=())) == pytest.approx((-1.96 * 0.007, 1.96 * 0.007), abs=1e-5)


@pytest.mark.parametrize(
    ("modulus", "sd", "text"), [(1e5, 700.0, "100.00 +- 0.70"), (153.2, 4.1, "0.1532 +- 0.0041")]
)
def test_the_screen_has_the_digits_of_a_soft_gel(modulus: float, sd: float, text: str) -> None:
    found = calibration(shear_modulus=modulus, shear_modulus_sd=sd)
    assert text in [cell for column in law_table([found]).columns for cell in column.cells]
