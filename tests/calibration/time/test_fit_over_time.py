"""`calibration.fit --time --damage` on homogeneous tests with a clock."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from timed_coupons import CYCLES, RELAXATION, REST, SOLID, TRUTH, trial, write

import calibration
import tisim
from benchmarks.blind.timed import recover
from calibration.errors import InputError, OptionError
from calibration.experiment import read
from calibration.results import Fits
from calibration.study import parts
from calibration.study.calibration import Calibration
from factory.materials import load_card
from tisim.course import Course

FAST = {"generations": 4, "workers": 1, "seed": 1}  # the polish converges to the same optimum


def experiment(folder: Path) -> Path:
    made = [
        trial("relaxation", "uniaxial", RELAXATION, noise=0.01, seed=1),
        trial("cycles", "uniaxial", CYCLES, noise=0.01, seed=2),
        trial("planar", "planar", CYCLES, noise=0.01, seed=3),
    ]
    return write(folder, made)


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Fits:
    folder = tmp_path_factory.mktemp("timed")
    return calibration.fit(
        experiment(folder / "experiment"),
        model="ogden",
        time="prony:2",
        damage="mullins",
        out=folder / "out",
        **FAST,  # type: ignore[arg-type]
    )


def test_all_parameters_are_found_within_their_error_bars(fitted: Fits) -> None:
    (found,) = fitted
    assert found.status == "converged"
    assert 0.8 < found.reduced_chi2 < 1.2
    known = {e.name: e for e in found.estimates}
    for name, truth in TRUTH.items():
        e = known[name]
        middle, half = 0.5 * (e.low + e.high), 0.5 * (e.high - e.low)
        assert abs(truth - middle) < 1.5 * half, name
        assert half < 0.3 * truth, name
    inside = [known[n].low <= truth <= known[n].high for n, truth in TRUTH.items()]
    assert sum(inside) >= len(inside) - 1


def test_the_result_says_what_its_moduli_are(fitted: Fits) -> None:
    (found,) = fitted
    assert found.label == "ogden+prony-2+mullins"
    assert "moduli are long-time ones" in found.note
    again = Calibration.from_json(found.to_json())
    assert again.parts == ("prony:2", "mullins")
    assert again.parametrisation.material(again.u) == found.parametrisation.material(found.u)


def test_tisim_simulates_the_card(fitted: Fits, tmp_path: Path) -> None:
    (path,) = fitted.write_cards(tmp_path)
    assert "long-time" in path.read_text()
    material = load_card("M", tmp_path).for_law("ogden")
    assert isinstance(material.viscosity, tisim.Prony)
    assert isinstance(material.softening, tisim.OgdenRoxburgh)
    times, values = RELAXATION.corners()
    course = Course(start=1.0, times=tuple(times[1:]), values=tuple(values[1:]), growth=0.1)
    simulated = tisim.simulate(tisim.Coupon(material=material, course=course))
    assert simulated.status == "converged"
    measured = trial("t", "uniaxial", RELAXATION)
    assert measured.time is not None
    expected = np.interp(simulated.time, measured.time, measured.stress)
    assert simulated.nominal_stress is not None
    assert np.abs(simulated.nominal_stress - expected).max() < 0.02 * measured.stress.max()


def test_the_report_shows_the_stress_over_time(fitted: Fits, tmp_path: Path) -> None:
    page = fitted.write_report(tmp_path).read_text()
    assert "--time prony:2 --damage mullins" in page
    assert "long-time" in page
    assert "viscosity = Prony(fractions=(" in page
    assert "softening = OgdenRoxburgh(" in page
    assert page.count("K/G was held at") == 1
    assert "do not determine K/G" not in page
    assert (tmp_path / "pictures" / "M-coupons.png").stat().st_size > 10_000


def test_the_data_choose_the_number_of_terms(tmp_path: Path) -> None:
    """Both fits are kept; the second term improves the fit by far more than its two constants cost."""
    hold = REST.ramp(1.5, 0.5).hold(300.0)
    solid = replace(SOLID, softening=None)
    folder = write(tmp_path / "e", [trial("t", "uniaxial", hold, solid=solid, noise=0.005)])
    found = [
        calibration.fit(folder, model="neo-hookean", time=f"prony:{n}", **FAST)[0]  # type: ignore[arg-type]
        for n in (1, 2)
    ]
    chosen = parts.choose(found)
    assert chosen.parts == ("prony:2",)
    assert "neo-hookean+prony-1 +" in chosen.note
    # for noise alone chi-square decreases by about one per constant, and the smaller fit is chosen
    alike = [
        replace(found[0], chi2=found[1].chi2 + 2.0, reduced_chi2=1.0),
        replace(found[1], reduced_chi2=1.0),
    ]
    assert parts.choose(alike).parts == ("prony:1",)
    lost = replace(found[1], status="no equilibrium")
    note = parts.choose([found[0], lost]).note
    assert "information criterion (neo-hookean+prony-2 no equilibrium)" in note


def test_damage_needs_no_clock(tmp_path: Path) -> None:
    solid = replace(SOLID, prony=type(SOLID.prony)())
    made = [
        trial("cycles", "uniaxial", CYCLES, solid=solid, noise=0.01, seed=2),
        trial("planar", "planar", CYCLES, solid=solid, noise=0.01, seed=3),
    ]
    folder = write(tmp_path / "e", made, clock=False)
    found = calibration.fit(folder, model="ogden", damage="mullins", **FAST)[0]  # type: ignore[arg-type]
    assert found.status == "converged"
    known = {e.name: e for e in found.estimates}
    for name in ("shear_modulus", "mullins_r", "mullins_m"):
        assert known[name].value == pytest.approx(TRUTH[name], rel=0.1)
    with pytest.raises(InputError, match=r"trial cycles.*time_s"):
        calibration.fit(folder, model="ogden", time="prony:1", **FAST)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"time": "maxwell"}, "--time maxwell: expected one of prony"),
        ({"time": "prony:-2"}, "--time prony:-2: expected one of prony"),
        ({"time": "mullins"}, "--time mullins: expected one of prony"),
        ({"damage": "prony"}, "--damage prony: expected mullins"),
        ({"time": "prony", "objective": "dice"}, "--time prony: expected --objective likelihood"),
    ],
)
def test_bad_options_are_named(tmp_path: Path, options: dict[str, str], sentence: str) -> None:
    folder = write(tmp_path / "e", [trial("t", "uniaxial", CYCLES)])
    with pytest.raises(OptionError) as error:
        calibration.fit(folder, out=tmp_path / "out", **options)  # type: ignore[arg-type]
    assert error.value.option.startswith(sentence)
    assert not (tmp_path / "out").exists()


def test_a_record_without_a_clock_ends_in_one_sentence(tmp_path: Path) -> None:
    folder = write(tmp_path / "e", [trial("t", "uniaxial", CYCLES)], clock=False)
    command = [sys.executable, "-m", "calibration.fit", str(folder), "--out", str(tmp_path / "out")]
    done = subprocess.run(
        [*command, "--time", "prony"], capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == 2
    assert done.stderr == "error: trial t: --time prony: expected a column time_s in its record\n"


def test_other_tests_of_the_material_are_named() -> None:
    bench = Path(__file__).parents[3] / "datasets" / "measured" / "bench" / "clean"
    with pytest.raises(InputError, match=r"trial \S+: --damage: expected no \w+, "):
        parts.check(read(bench), list(read(bench).materials), ("mullins",))


@pytest.mark.slow
def test_nine_of_ten_intervals_hold_the_truth(tmp_path: Path) -> None:
    assert recover.main(["coupons", "--seeds", "20", "--out", str(tmp_path)]) == 0
