"""Which of several fits of one law a material card takes."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any

import pytest
from _folders import coupon_entry, write_experiment

from calibration.experiment import Experiment, read
from calibration.study import Calibration, card
from tisim import laws


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    table = {"stretch": [1.0, 1.1, 1.2], "nominal_stress_kPa": [0.0, 1.0, 2.0]}
    folder: Path = tmp_path_factory.mktemp("coupons")
    return read(write_experiment(folder, [coupon_entry("pull", "a.csv")], tables={"a.csv": table}))


def made(label: str, shear: float, chi2: float, **more: Any) -> Calibration:
    law = "ogden" if label.startswith("ogden") else label.partition("+")[0]
    return Calibration(
        material="S0",
        law=law,
        label=label,
        status="converged",
        message="",
        density=1000.0,
        u=(1.0, 1.0) if "+" not in label else (1.0, 1.0, 0.0, 1.0),
        parameters=laws.get(law).from_moduli(shear, 300.0 * shear),
        shear_modulus=shear,
        bulk_modulus=300.0 * shear,
        chi2=chi2,
        points=100,
        reduced_chi2=chi2 / 98.0,
        **more,
    )


TIMED = {"parts": ("prony:1",), "protocol": {"first": 1.0, "last": 100.0, "peaks": 0}}


def test_of_two_fits_of_one_law_the_chosen_one_is_taken(experiment: Experiment) -> None:
    """Moduli of the plain fit beside a better one of two terms, and an elastic fit beside a viscosity."""
    plain, two = made("ogden", 100e3, 400.0), made("ogden-2", 30e3, 100.0)
    for fits in permutations([plain, two]):
        found = card(fits, experiment)
        assert found["laws"]["ogden"]["mu"] == pytest.approx(list(two.parameters["mu"]))  # type: ignore[arg-type]
        assert "Fitted but not taken (another fit of its law is better): ogden." in found["provenance"]

    elastic, timed = made("neo-hookean", 36e3, 400.0), made("neo-hookean+prony-1", 30e3, 100.0, **TIMED)
    for fits in permutations([elastic, timed]):
        found = card(fits, experiment)
        assert "viscosity" in found
        assert found["laws"]["neo-hookean"]["mu"] == pytest.approx(30e3)


def test_a_law_fitted_beside_other_parts_is_filled_in(experiment: Experiment) -> None:
    timed = made("neo-hookean+prony-1", 30e3, 100.0, **TIMED)
    elastic = made("ogden", 36e3, 400.0)
    other = made("mooney-rivlin+prony-1", 31e3, 110.0, **TIMED)
    found = card([elastic, timed, other], experiment)
    moduli = {name: laws.get(name).moduli(p).shear_modulus for name, p in found["laws"].items()}
    assert moduli["ogden"] == pytest.approx(30e3)
    assert moduli["mooney-rivlin"] == pytest.approx(31e3)
    why = "beside other parts than those of neo-hookean+prony-1"
    assert f"Fitted but not taken ({why}): ogden." in found["provenance"]
    assert "No fit taken, moduli taken from neo-hookean+prony-1: ogden." in found["provenance"]


def test_of_two_fits_of_another_law_the_better_one_is_taken(experiment: Experiment) -> None:
    best = made("neo-hookean", 30e3, 100.0)
    plain, two = made("ogden", 35e3, 150.0), made("ogden-2", 31e3, 105.0)
    for fits in permutations([best, plain, two]):
        shear = laws.get("ogden").moduli(card(fits, experiment)["laws"]["ogden"]).shear_modulus
        assert shear == pytest.approx(31e3)
