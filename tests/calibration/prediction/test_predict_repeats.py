"""Repeats without a stated error: those that are fitted tell the noise of those that are predicted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

import calibration
from calibration.diagnosis import model_of
from calibration.experiment import Experiment

FITTED, GAIN, WHITE = 6, 0.005, 0.001  # records; scatter of the load cell's gain, and from point to point


@pytest.fixture(scope="module")
def repeats(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    """Eight pulls of a neo-Hookean strip, whose scatter from point to point is below what is assumed of one
    record alone (0.5 % of its largest stress)."""
    rng = np.random.default_rng(3)
    stretch = np.linspace(1.0, 1.5, 40)
    stress = 30.0 * (stretch - stretch**-2)
    tables, trials = {}, []
    for name in (f"t{n}" for n in range(1, 9)):
        noisy = stress * (1.0 + GAIN * rng.standard_normal())
        noisy = noisy + WHITE * stress[-1] * rng.standard_normal(stretch.size)
        tables[f"{name}.csv"] = {"stretch": stretch, "nominal_stress_kPa": noisy}
        entry = coupon_entry(name, f"{name}.csv", stretch_sd=0.0)
        del entry["stress_sd_kPa"]
        trials.append(entry)
    folder = write_experiment(tmp_path_factory.mktemp("repeats") / "strip", trials, tables=tables)
    return calibration.read_experiment(folder)


def test_fitted_and_predicted_repeats_have_one_noise(repeats: Experiment) -> None:
    """The model that predicts kept the noise that is assumed of a record alone."""
    alone = model_of(replace(repeats, trials=repeats.trials[:FITTED]), workers=1)
    known = alone.settle_noise("stated")
    assert known.components.repeats
    together = model_of(repeats, workers=1)
    fold = together.row_record >= FITTED
    train, test = (together.subset(fold, others=others) for others in (True, False))
    train.take_noise(known)
    test.take_noise(known, predicted=True)
    assert train.noise.sd[~fold] == pytest.approx(alone.noise.sd)
    assert train.noise.columns[~fold][:, : alone.noise.columns.shape[1]] == pytest.approx(alone.noise.columns)
    whole = alone.noise.sd**2 + np.sum(alone.noise.columns**2, axis=1)
    one = whole[alone.row_record == 0]
    for k in (FITTED, FITTED + 1):
        assert test.noise.sd[test.row_record == k] ** 2 == pytest.approx(one, rel=0.05)
    assert np.median(alone.noise.sd) == pytest.approx(WHITE * 30e3 * (1.5 - 1.5**-2), rel=0.3)


def test_the_interval_of_a_repeat_is_as_wide_as_repeats_scatter(repeats: Experiment) -> None:
    names = "t1,t2,t3,t4,t5,t6"
    found = calibration.predict(repeats, calibrate=names, predict="t7,t8", law="neo-hookean", workers=1)
    largest = 30e3 * (1.5 - 1.5**-2)
    for record in found.prediction.records:
        noise = record.sd("baseline", "noise") / largest
        assert noise.max() < 3.0 * GAIN
        assert WHITE < noise.min() < 0.003  # 0.005 was assumed of each point, and the scatter beside it
