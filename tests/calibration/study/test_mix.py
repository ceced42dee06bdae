"""Any mix of trials is one fit: used trials, and remarks on the ones left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _folders import beam_entry, coupon_entry, marker_columns, measured, poke_entry, write_experiment

from calibration.errors import InputError
from calibration.experiment import read
from calibration.experiment.model import BeamTrial, Experiment
from calibration.parameters import parametrisation
from calibration.report import page
from calibration.report._draw_records import coupon_errors
from calibration.study import calibrate, measurements, write_card
from factory.materials import load_card

NEO = parametrisation("neo-hookean")

TIME = np.arange(0.0, 3.0, 0.02)


def mixed(folder: Path, *, kinds: str) -> Path:
    stretch = np.linspace(1.05, 2.0, 20)
    drop = np.zeros((len(TIME), 3))
    drop[TIME > 0.5, 2] = -4.0
    depth = np.linspace(0.0, 2.0, 21)
    trials = {
        "coupon": coupon_entry("pull", "pull.csv"),
        "poke": poke_entry("press", "press.csv"),
        "beam": beam_entry(
            "bar",
            markers="markers.csv",
            marker_sd_mm=0.05,
            marker_positions_mm={"tip": [100.0, 0.0, 0.0]},
        ),
    }
    tables = {
        "pull.csv": {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)},
        "press.csv": {"time_s": depth, "depth_mm": depth, "force_N": 0.5 * depth},
        "markers.csv": marker_columns(TIME, {"tip": drop}),
    }
    return write_experiment(folder, [trials[k] for k in kinds.split()], tables=tables)


def test_beams_pokes_and_coupons_are_one_fit(tmp_path: Path) -> None:
    data = measurements(read(mixed(tmp_path, kinds="coupon poke beam")), "S0", NEO, workers=1)
    assert [o.name for o in data.objectives] == ["coupons pull", "pokes press", "markers of bar"]
    assert any(t.startswith("bar: the motion") for t in data.ignored)
    assert sum(o.points for o in data.objectives) == 20 + 21 + 3


def test_compression_beyond_what_is_compared_is_told_and_no_part_of_the_errors(tmp_path: Path) -> None:
    """Stiffer beyond a strain of one half than the law: the report's rms was that of the whole record."""
    stretch = np.linspace(1.0, 0.35, 66)
    stress = 10.0 * (stretch - stretch**-2) * np.where(stretch < 0.499, 1.5, 1.0)
    table = {"stretch": stretch, "nominal_stress_kPa": stress}
    experiment = read(
        write_experiment(tmp_path, [coupon_entry("push", "push.csv")], tables={"push.csv": table})
    )
    data = measurements(experiment, "S0", NEO, workers=1)
    (told,) = data.ignored
    assert told.startswith("push: its part beyond a strain of 0.5, of 0.65 measured:")
    (coupon,) = page._coupons(data)
    assert coupon[1].points == 51
    found = calibrate(data)
    assert found.shear_modulus == pytest.approx(1e4, rel=0.02)
    (error,) = coupon_errors(coupon, [found]).values()
    assert error < 1.0


def test_doubts_that_a_fit_of_markers_takes_as_exact_are_told(tmp_path: Path) -> None:
    experiment = read(mixed(tmp_path, kinds="beam"))
    (bar,) = experiment.trials
    assert isinstance(bar, BeamTrial)
    certain = replace(
        experiment,
        trials=(replace(bar, free_length_sd=0.0, section_sd=(0.0,)),),
        materials={"S0": replace(experiment.materials["S0"], density_sd=0.0)},
    )

    def told(given: Experiment) -> list[str]:
        return [t for t in measurements(given, "S0", NEO, workers=1).ignored if "as exact" in t]

    assert told(certain) == []
    (all_of_them,) = told(experiment)
    assert all_of_them.startswith("bar: the stated standard deviation of free length, section and density:")
    (density,) = told(replace(certain, materials=experiment.materials))
    assert density.startswith("bar: the stated standard deviation of density:")


def test_settled_markers_say_the_modulus(tmp_path: Path) -> None:
    """A beam with tip deflection w: E = rho g L^4 A / (8 w I), small enough for beam theory."""
    data = measurements(read(mixed(tmp_path, kinds="beam")), "S0", NEO, workers=1)
    found = calibrate(data)
    young = 1000.0 * 9.81 * 0.1**4 / (8.0 * 0.004) * 4.0 / 0.01**2
    assert found.status == "converged"
    # beam theory neglects shear and the clamp's compliance; a marker's position is known to 1 mm only
    assert found.shear_modulus == pytest.approx(young / 3.0, rel=0.06)


def test_wide_intervals_are_those_of_the_likelihood(tmp_path: Path) -> None:
    """The strip stiffens by 0.5 % more than a neo-Hookean one: early locking is excluded.

    The likelihood's interval is narrower at its lower end than that of linear theory.
    """
    stretch = np.linspace(1.05, 2.0, 20)
    stress = 30.0 * (stretch - stretch**-2) * (1.0 + 0.005 * (stretch - 1.0))
    tables = {"pull.csv": {"stretch": stretch, "nominal_stress_kPa": stress}}
    folder = write_experiment(tmp_path, [coupon_entry("pull", "pull.csv")], tables=tables)
    law = parametrisation("arruda-boyce")
    found = calibrate(measurements(read(folder), "S0", law, workers=1))
    (locking,) = [e for e in found.estimates if e.name == "locking"]
    assert locking.seen != "identified"
    assert locking.low < locking.value <= locking.high
    assert np.log(locking.value / locking.low) < 0.8 * 1.96 * locking.sd


def test_nothing_to_fit_is_one_sentence(tmp_path: Path) -> None:
    folder = mixed(tmp_path, kinds="coupon")
    with pytest.raises(InputError, match="expected at least one beam with a traced outline"):
        measurements(read(folder), "S0", NEO, objective="dice")


@pytest.mark.slow
def test_the_bar_in_vibration_and_at_rest() -> None:
    """An elastic bar neither relaxes nor creeps, as this one does: the fit ends, and says what it lacks."""
    folder = measured() / "real" / "clamped-beam-dragonskin10" / "experiment"
    found = calibrate(measurements(read(folder), "dragonskin10", NEO))
    assert found.status == "lack of fit"
    # E of gravity-a: 279 kPa by its settled pose, 293 by its frequency (studies/release), which weighs more
    assert 279e3 < 3.0 * found.shear_modulus < 298e3


def test_the_factory_takes_a_card_with_a_negative_second_constant(tmp_path: Path) -> None:
    experiment = read(mixed(tmp_path, kinds="coupon"))
    p = parametrisation("mooney-rivlin")
    fit = calibrate(measurements(experiment, "S0", p, workers=1))
    u = np.array([np.log(1e4), np.log(300.0), -0.3])
    odd = replace(fit, u=tuple(u), parameters=p.parameters(u), shear_modulus=1e4)
    write_card(tmp_path / "cards", [odd], experiment)
    material = load_card("S0", tmp_path / "cards").for_law("mooney-rivlin")
    assert material.parameters["c01"] == pytest.approx(-1500.0)
    assert material.parameters["c10"] == pytest.approx(6500.0)
