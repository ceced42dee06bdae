"""Noise of homogeneous tests that the lab does not state, and errors of the stretch."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment
from made_experiment import experiment as made

import calibration
from calibration.experiment.model import CouponTrial
from calibration.measurements._noise_known import POINTS_PER_FREEDOM
from calibration.measurements.homogeneous._scatter import grows, slope
from calibration.parameters import parametrisation
from calibration.study import Calibration, FitOptions, calibrate, measurements
from calibration.study.assessment import largest_by_chance

SHEAR = 30e3


def neo_hookean(stretch: np.ndarray) -> np.ndarray:
    return np.asarray(SHEAR * (stretch - stretch**-2))


def fitted(*trials: CouponTrial) -> Calibration:
    data = measurements(made(*trials), "M", parametrisation("neo-hookean"))
    return calibrate(data, options=FitOptions(leave_one_out=False))


def test_constant_scatter_is_seldom_taken_for_growing() -> None:
    """Never that of a long record, and that of a stiffening curve that does grow is found in short ones."""
    found = {}
    for points, seeds in ((30, 200), (120, 100)):
        stretch = np.linspace(1.0, 1.6, points)
        found[points] = 0
        for seed in range(seeds):
            noise = np.random.default_rng([1, seed]).standard_normal(points)
            found[points] += grows([(stretch, neo_hookean(stretch) + 1e3 * noise)])
    assert found[30] <= 4
    assert found[120] == 0
    stretch = np.linspace(1.0, 1.6, 30)
    stress = SHEAR * np.expm1(4.0 * (stretch - 1.0))
    growing = sum(
        grows([(stretch, stress * (1.0 + 0.03 * np.random.default_rng([2, seed]).standard_normal(30)))])
        for seed in range(40)
    )
    assert growing >= 35


def test_the_strokes_of_a_record_decide_together_if_its_scatter_grows() -> None:
    """Fourteen points seldom do alone."""
    stretch = np.linspace(1.0, 1.6, 14)
    stress = SHEAR * np.expm1(4.0 * (stretch - 1.0))
    alone = together = 0
    for seed in range(40):
        random = np.random.default_rng([4, seed])
        strokes = [(stretch, stress * (1.0 + 0.03 * random.standard_normal(14))) for _ in range(4)]
        alone += grows(strokes[:1])
        together += grows(strokes)
    assert alone <= 18
    assert together >= 34


def test_a_slope_is_not_flattened_by_errors_of_the_stretch() -> None:
    true = np.linspace(1.0, 1.6, 30)
    slopes = []
    for seed in range(50):
        seen = true + 0.01 * np.random.default_rng([3, seed]).standard_normal(30)
        slopes.append(slope(seen, SHEAR * true, 0.01).mean())
    assert np.mean(slopes) == pytest.approx(SHEAR, rel=0.1)


def test_noise_that_is_estimated_from_few_points_is_not_certain() -> None:
    """Perfect data of a neo-Hookean strip without a stated error: no lack of fit; of another law there is."""
    stretch = np.linspace(1.0, 1.6, 30)
    lacking, freedoms = 0, set()
    for seed in range(25):
        noise = 1e3 * np.random.default_rng([4, seed]).standard_normal(30)
        trial = CouponTrial(
            id="a", material="M", mode="uniaxial", stretch=stretch, stress=neo_hookean(stretch) + noise
        )
        found = fitted(trial)
        freedoms.add(found.noise_freedom)
        lacking += found.status != "converged"
    assert freedoms == {30.0 / POINTS_PER_FREEDOM}
    assert lacking <= 1
    stiffening = neo_hookean(stretch) * (1.0 + 2.0 * (stretch - 1.0) ** 2)
    noise = 50.0 * np.random.default_rng(5).standard_normal(30)
    assert fitted(replace(trial, stress=stiffening + noise)).status == "lack of fit"
    assert fitted(replace(trial, stress_sd=1e3)).noise_freedom is None


def test_the_largest_misfit_by_chance() -> None:
    known = Calibration(
        material="M", law="neo-hookean", label="neo-hookean", status="converged", message="", density=None,
        u=(1.0, 2.0), held_coordinates=1, points=51, reduced_chi2=1.75, parameters={"mu": 1.0},
    )  # fmt: skip
    random = np.random.default_rng(0)
    alone = random.chisquare(50, 200_000) / 50
    assert np.mean(alone > largest_by_chance(known.freedom)) == pytest.approx(1.35e-3, rel=0.2)
    assert known.assessed().lacking
    doubtful = replace(known, noise_freedom=10.0)
    drawn = (random.chisquare(50, 200_000) / 50) / (random.chisquare(10, 200_000) / 10)
    largest = largest_by_chance(doubtful.freedom, doubtful.noise_freedom)
    assert np.mean(drawn > largest) == pytest.approx(1.35e-3, rel=0.2)
    assert not doubtful.assessed().lacking


def specimens(count: int, scatter: float, seed: int) -> Calibration:
    """Fit of strips whose shear moduli scatter by `scatter`, with a stated noise of 0.5 kPa."""
    random = np.random.default_rng([6, seed])
    stretch = np.linspace(1.0, 1.6, 60)
    return fitted(
        *(
            CouponTrial(
                id=f"pull {k}",
                material="M",
                specimen=f"S{k}",
                mode="uniaxial",
                stretch=stretch,
                stress=neo_hookean(stretch) * np.exp(scatter * random.standard_normal())
                + 500.0 * random.standard_normal(stretch.size),
                stress_sd=500.0,
            )
            for k in range(count)
        )
    )


def test_error_bars_hold_the_scatter_between_specimens() -> None:
    """95 % intervals of the mean of four specimens contain the truth; without scatter nothing changes."""
    inside = 0
    for seed in range(30):
        found = specimens(4, 0.03, seed)
        (shear,) = (e for e in found.estimates if e.name == "shear_modulus")
        inside += shear.low <= SHEAR <= shear.high
        assert "the 4 specimens differ by more than the noise" in found.note
    assert inside >= 26
    alike = [specimens(4, 0.0, seed) for seed in range(30)]
    assert sum("specimens differ" in found.note for found in alike) <= 2
    one = specimens(1, 0.0, 0)
    assert np.median([f.shear_modulus_sd for f in alike]) == pytest.approx(
        one.shear_modulus_sd / 2.0, rel=0.1
    )


def repeats(folder: Path, *, seed: int, count: int, gain: float, stated: bool) -> Path:
    """Repeats of a pull on one neo-Hookean specimen, each with its own gain, and white noise of 0.2 %."""
    random = np.random.default_rng(seed)
    stretch = np.linspace(1.0, 1.5, 40)
    trials, tables = [], {}
    for k in range(count):
        own = SHEAR * (1.0 + gain * random.standard_normal())
        stress = own * (stretch - stretch**-2) + 0.002 * SHEAR * random.standard_normal(40)
        tables[f"r{k:02d}.csv"] = {"stretch": stretch, "nominal_stress_kPa": 1e-3 * stress}
        entry = coupon_entry(f"r{k:02d}", f"r{k:02d}.csv", specimen="A", stress_sd_kPa=2e-6 * SHEAR)
        for key in ("stretch_sd", "stress_sd_kPa")[: 1 if stated else 2]:
            del entry[key]
        trials.append(entry)
    return write_experiment(folder / f"repeats-{seed}-{stated}", trials, tables=tables)


@pytest.mark.parametrize(
    ("stated", "count", "gain"), [(True, 8, 0.01), (False, 8, 0.01), (True, 12, 0.03), (False, 12, 0.03)]
)
def test_clean_repeats_have_no_cause(stated: bool, count: int, gain: float, tmp_path: Path) -> None:
    """Ordinary scatter of the load cell, whether the lab states the noise from point to point or not."""
    verdicts = []
    for seed in range(920, 926):
        folder = repeats(tmp_path, seed=seed, count=count, gain=gain, stated=stated)
        found = calibration.diagnose(calibration.read_experiment(folder), gain=False, workers=1)
        verdicts.append(found.diagnosis.finding.verdict)
    assert verdicts.count("none") >= 5, verdicts


def test_predicted_repeats_scatter_as_the_fitted_ones(tmp_path: Path) -> None:
    """Intervals of trials that are predicted hold the scatter between the repeats that were fitted."""
    shares = []
    for seed in range(930, 936):
        folder = repeats(tmp_path, seed=seed, count=12, gain=0.03, stated=True)
        found = calibration.predict(
            folder, calibrate="r0[0-7]", predict="r0[89],r1?", law="neo-hookean", workers=1
        ).prediction
        shares.append(found.coverage(found.records, found.models[0]))
    assert np.mean(shares) > 0.8, shares
