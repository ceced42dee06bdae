"""Weights and residuals of a coupon as an objective."""

from __future__ import annotations

from dataclasses import replace

import coupon_cases as made
import numpy as np
import pytest

import tisim
from calibration.coupons import CouponObjective, Coupons, relative_sd
from calibration.search import Objective, Problem

S = np.linspace(1.0, 3.0, 81)
SOFT = tisim.Material(law="mooney-rivlin", parameters={"c10": 1e4, "c01": 4e3, "bulk": 1e10})


def _law(mode: str, s: np.ndarray) -> np.ndarray:
    return made.mooney(1e4, 4e3, mode, s)


def test_residuals_are_whitened_data_minus_model() -> None:
    trial = made.coupon("planar", S, _law, stress_sd=200.0)
    objective: Objective = CouponObjective(trial=trial)
    stiffer = tisim.Material(law="mooney-rivlin", parameters={"c10": 2e4, "c01": 8e3, "bulk": 2e10})
    found = objective.residuals([SOFT, stiffer])
    assert (objective.name, objective.size(), objective.points) == ("coupon planar", 81, 81)
    assert found.shape == (2, 81)
    np.testing.assert_allclose(found[0], (trial.stress - _law("planar", S)) / 200.0, atol=1e-2)
    np.testing.assert_allclose(found[1], (trial.stress - 2 * _law("planar", S)) / 200.0, atol=2e-2)


def test_stretch_errors_enter_by_the_slope() -> None:
    """Chi-square of the true law stays one a point, with errors in stretch that are nine tenths of all."""
    totals = []
    for seed in range(20):
        trial = made.coupon("uniaxial", S, _law, stress_sd=100.0, stretch_sd=0.03, seed=seed)
        totals.append(float((CouponObjective(trial=trial).residuals([SOFT]) ** 2).mean()))
    # 1620 points: chi-square a point has sd 0.035
    assert abs(np.mean(totals) - 1.0) < 0.14
    blind = CouponObjective(trial=replace(trial, stretch_sd=0.0))
    assert (blind.residuals([SOFT]) ** 2).mean() > 4.0


def test_without_a_lab_sd_the_scatter_speaks() -> None:
    found = [
        relative_sd(S[5:], made.coupon("uniaxial", S[5:], _law, relative=0.03, seed=k).stress)
        for k in range(20)
    ]
    assert abs(np.mean(found) - 0.03) < 0.003
    trial = made.coupon("uniaxial", S, _law, relative=0.03)
    objective = CouponObjective(trial=trial)
    assert objective.sd_estimated
    relative = relative_sd(trial.stretch, trial.stress)
    largest = trial.stress.max()
    np.testing.assert_allclose(objective.sd[0], relative * 0.05 * largest)  # the floor, at rest
    np.testing.assert_allclose(objective.sd[-1], relative * trial.stress[-1])


def test_smooth_or_short_curves_get_the_smallest_relative_sd() -> None:
    assert relative_sd(S, _law("uniaxial", S)) == 0.005
    assert relative_sd(S[:5], np.array([0.0, 9.0, 1.0, 7.0, 2.0])) == 0.005


def test_repeated_stretches_are_scatter_too() -> None:
    """A lab that notes its stretches coarsely: eight readings at each."""
    coarse = np.repeat(np.linspace(1.2, 3.0, 20), 8)
    found = []
    for seed in range(20):
        stress = made.coupon("uniaxial", coarse, _law, relative=0.03, seed=seed).stress
        found.append(relative_sd(coarse, stress))
    assert abs(np.mean(found) - 0.03) < 0.006
    trial = replace(made.coupon("uniaxial", coarse, _law), stress=stress, stretch_sd=0.01)
    assert np.isfinite(CouponObjective(trial=trial).sd).all()


def test_no_answer_is_a_row_of_nan() -> None:
    dead = tisim.material_from_moduli("st-venant-kirchhoff", shear=3e4, bulk=9e6)
    found = CouponObjective(trial=made.coupon("uniaxial", S, _law, stress_sd=200.0)).residuals([dead, SOFT])
    assert np.isnan(found[0]).all()
    assert np.isfinite(found[1]).all()


def test_curves_together_are_the_parts_in_order() -> None:
    parts = tuple(CouponObjective(trial=made.coupon(m, S, _law, stress_sd=200.0)) for m in made.MODES)
    joint = Coupons(parts=parts)
    apart = np.concatenate([p.residuals([SOFT]) for p in parts], axis=1)
    np.testing.assert_allclose(joint.residuals([SOFT]), apart, rtol=0, atol=1e-9)


def test_the_search_takes_it() -> None:
    from calibration.parameters import parametrisation

    law = parametrisation("mooney-rivlin")
    objective = CouponObjective(trial=made.coupon("planar", S, _law, stress_sd=200.0))
    costs = Problem(parametrisation=law, objectives=(objective,)).costs(
        np.array([law.start(shear=2.8e4), law.start(shear=5.6e4)])
    )
    # the start's K/G of 300 and its C01 are not the truth's, but near
    assert costs[0] < 5 * objective.points < 0.1 * costs[1]


def test_a_sd_that_is_no_sd_is_refused() -> None:
    trial = made.coupon("planar", S, _law)
    with pytest.raises(ValueError, match="coupon planar: expected a positive standard deviation"):
        CouponObjective(trial=trial, sd=np.zeros(81))
