"""Weights and residuals of homogeneous tests in a fit."""

from __future__ import annotations

from dataclasses import replace

import coupon_cases as made
import numpy as np
import pytest

from calibration.errors import InputError
from calibration.experiment.model import CouponTrial
from calibration.inference import Problem
from calibration.measurements._baseline import Baseline
from calibration.measurements._state import State
from calibration.measurements.homogeneous import nominal_stress, relative_sd
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.objective import ModelObjective
from calibration.parameters import Parametrisation, parametrisation

S = np.linspace(1.0, 3.0, 81)
LAW = parametrisation("mooney-rivlin")


def _law(mode: str, s: np.ndarray) -> np.ndarray:
    return made.mooney(1e4, 4e3, mode, s)


def model_of(*trials: CouponTrial, law: Parametrisation = LAW) -> HomogeneousModel:
    return HomogeneousModel(made.experiment(*trials), baseline=Baseline.of_law(trials, law))


def state(c10: float, c01: float, bulk_ratio: float = 5000.0) -> State:
    """State of a Mooney-Rivlin material, nearly incompressible by default."""
    shear_modulus = 2.0 * (c10 + c01)
    values = {"shear_modulus": shear_modulus, "second_share": 2.0 * c01 / shear_modulus}
    values["bulk_ratio"] = bulk_ratio
    return State(u=np.array([c.inside(values[c.name]) for c in LAW.coordinates]))


TRUE = state(1e4, 4e3)


def residuals(model: HomogeneousModel, at: State) -> np.ndarray:
    """Residuals of the measured points, without priors."""
    return model.residuals([at])[0][: model.points]


def test_residuals_are_model_minus_data_whitened() -> None:
    trial = made.coupon("planar", S, _law, stress_sd=200.0)
    model = model_of(trial)
    assert model.points == 81
    states = [TRUE, state(2e4, 8e3)]
    expected = [(nominal_stress(LAW.material(x.u), "planar", S) - trial.stress) / 200.0 for x in states]
    np.testing.assert_allclose(model.residuals(states)[:, :81], expected, atol=1e-9)
    assert expected[1][-1] - expected[0][-1] == pytest.approx(_law("planar", S[-1:])[0] / 200.0, rel=1e-3)


def test_stretch_errors_enter_by_the_slope() -> None:
    """Chi-square per point of the true law is 1, with stretch errors as nine tenths of the total error."""
    totals = []
    for seed in range(20):
        trial = made.coupon("uniaxial", S, _law, stress_sd=100.0, stretch_sd=0.03, seed=seed)
        totals.append(float((residuals(model_of(trial), TRUE) ** 2).mean()))
    # 1620 points: chi-square per point has sd 0.035
    assert abs(np.mean(totals) - 1.0) < 0.14
    blind = model_of(replace(trial, stretch_sd=0.0))
    assert (residuals(blind, TRUE) ** 2).mean() > 4.0


def test_without_a_lab_sd_the_scatter_speaks() -> None:
    found = [
        relative_sd(S[5:], made.coupon("uniaxial", S[5:], _law, relative=0.03, seed=k).stress)
        for k in range(20)
    ]
    assert abs(np.mean(found) - 0.03) < 0.003
    trial = made.coupon("uniaxial", S, _law, relative=0.03)
    (record,) = model_of(trial).records
    assert record.estimated
    relative = relative_sd(trial.stretch, trial.stress)
    largest = trial.stress.max()
    np.testing.assert_allclose(record.sd[0], 0.005 * largest)  # near rest, from the curve's largest stress
    # of a smooth curve, which at the end is nearer to the law than the last point
    np.testing.assert_allclose(record.sd[-1], relative * _law("uniaxial", S)[-1], rtol=0.03)


def test_smooth_or_short_curves_get_the_smallest_relative_sd() -> None:
    assert relative_sd(S, _law("uniaxial", S)) == 0.005
    assert relative_sd(S[:5], np.array([0.0, 9.0, 1.0, 7.0, 2.0])) == 0.005


def test_repeated_stretches_are_scatter_too() -> None:
    """Coarsely recorded stretches, with eight readings at each."""
    coarse = np.repeat(np.linspace(1.2, 3.0, 20), 8)
    found = []
    for seed in range(20):
        stress = made.coupon("uniaxial", coarse, _law, relative=0.03, seed=seed).stress
        found.append(relative_sd(coarse, stress))
    assert abs(np.mean(found) - 0.03) < 0.006
    trial = replace(made.coupon("uniaxial", coarse, _law), stress=stress, stretch_sd=0.01)
    assert np.isfinite(model_of(trial).noise.sd).all()


def test_no_answer_is_a_row_of_nan() -> None:
    law = parametrisation("st-venant-kirchhoff")
    model = model_of(made.coupon("uniaxial", S, _law, stress_sd=200.0), law=law)
    gentle = model_of(made.coupon("uniaxial", S[:4], _law, stress_sd=200.0), law=law)
    dead = State(u=law.start(shear=3e4))
    assert np.isnan(model.residuals([dead])[0]).all()
    assert np.isfinite(gentle.residuals([dead])[0]).all()


def test_curves_together_are_the_parts_in_order() -> None:
    trials = [made.coupon(m, S, _law, stress_sd=200.0) for m in made.MODES]
    apart = np.concatenate([residuals(model_of(t), TRUE) for t in trials])
    np.testing.assert_allclose(residuals(model_of(*trials), TRUE), apart, rtol=0, atol=1e-9)


def test_the_search_takes_it() -> None:
    objective = ModelObjective(model_of(made.coupon("planar", S, _law, stress_sd=200.0)), name="coupons")
    costs = Problem(parametrisation=LAW, objectives=(objective,)).costs(
        np.array([LAW.start(shear=2.8e4), LAW.start(shear=5.6e4)])
    )
    # K/G of 300 and C01 at the start are not the truth's, but close
    assert costs[0] < 5 * objective.points < 0.1 * costs[1]


def test_each_point_has_a_positive_sd() -> None:
    """Also if the lab states none and the curve has no scatter; a curve without stress is refused."""
    trial = made.coupon("planar", S, _law)
    sd = model_of(trial).noise.sd
    assert (np.isfinite(sd) & (sd > 0.0)).all()
    nothing = replace(trial, stress=np.zeros(81))
    with pytest.raises(InputError, match=r"trials\.planar: expected some stress that is not 0"):
        model_of(nothing)
    assert model_of(replace(nothing, stress_sd=10.0)).noise.sd == pytest.approx(10.0)
