"""Verdicts, figures and nuisances as readable text."""

from __future__ import annotations

from pathlib import Path

import pytest
from report_cases import beam_folder, calibration, failed

from calibration.experiment import read
from calibration.pages import significant, with_sd
from calibration.report._compare import compare, far_nuisances
from calibration.report._words import verdict


def test_laws_that_are_alike() -> None:
    said = verdict([calibration(), calibration("ogden", chi2=89.5, shear_modulus=1.02e5)])
    assert said == (
        "A: shear modulus 100.0 ± 0.7 kPa by neo-hookean; the 2 laws cannot be told apart by this data"
        " (G 100.0 to 102.0 kPa among them)."
    )


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
    assert found.chosen.label == "ogden"
    assert found.differences["neo-hookean"] == pytest.approx(10.0 / 10.0 - 2.0)
    assert "even this law misses the data by more than the stated noise (reduced chi-square 10.0)" in verdict(
        laws
    )


def test_one_law() -> None:
    assert verdict([calibration()]).endswith("by neo-hookean; no other law was tried.")
    assert "of 1 other laws none has a fit" in verdict([calibration(), failed("ogden")])


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
