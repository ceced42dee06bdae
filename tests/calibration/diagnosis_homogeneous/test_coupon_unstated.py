"""Homogeneous tests whose noise is not stated: its estimate is uncertain, and the verdict knows it."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from diagnosis_coupon_cases import G, coupon_model, experiment, ramps, trial
from scipy.stats import f as f_distribution

from calibration.diagnosis.engine.null import EVERYTHING, Null
from calibration.diagnosis.engine.run import searched
from calibration.experiment import CouponMode, CouponTrial
from calibration.measurements._noise_known import POINTS_PER_FREEDOM, Estimated

NOISE = 0.012 * G


def loops(seed: int, *, slack: float = 0.0) -> list[CouponTrial]:
    """A loop of 30 points up and down in each mode; slack : of the strain in simple tension."""
    found = []
    for n, mode in enumerate(get_args(CouponMode)):
        t = trial(f"{mode}", mode, ramps(1.5, 2, 30), sd=NOISE, seed=10 * seed + n)
        moved = t.stretch + (slack if mode == "uniaxial" else 0.0)
        found.append(replace(t, stretch=moved, stress_sd=None))
    return found


def test_noise_alone_is_seldom_more_than_noise() -> None:
    verdicts = [searched(coupon_model(experiment(*loops(seed)))).finding.verdict for seed in range(20)]
    assert verdicts.count("none") >= 18, verdicts


def test_a_cause_beyond_the_noise_is_found() -> None:
    found = searched(coupon_model(experiment(*loops(1, slack=0.03)))).finding
    assert found.equivalent[0] == ("strain-offset",)


def test_each_stroke_has_an_estimate() -> None:
    unstated, *_ = loops(3)
    stated = replace(unstated, id="stated", stress_sd=NOISE)
    few = replace(unstated, id="few", stretch=unstated.stretch[:7], stress=unstated.stress[:7], time=None)
    smooth = replace(unstated, id="smooth", stress=G * (unstated.stretch - unstated.stretch**-2))
    model = coupon_model(experiment(unstated, stated, few, smooth))
    found = model.estimated_noise()
    assert found.freedom == pytest.approx(59.0 * np.array([29.0, 30.0]) / 59.0 / POINTS_PER_FREEDOM, abs=0.3)
    rows = dict(zip(("a", "stated", "few", "smooth"), range(4), strict=True))
    for name, k in rows.items():
        numbers = set(found.group[: model.points][model.row_record == k])
        assert numbers == ({0, 1} if name == "a" else {-1}), name
    assert set(found.group[model.points :]) <= {-1}


def test_sums_of_squares_over_an_estimated_noise_follow_f() -> None:
    size, freedom = 24, 9.0
    one = Estimated(group=np.zeros(size, dtype=np.intp), freedom=np.array([freedom]))
    null = Null(size, {}, seed=1, estimated=one)
    z = np.sqrt(np.full(size, f_distribution.isf(0.02, size, freedom)))
    found = null.lack_of_fit(z, np.zeros((size, 0)))
    assert found.each[EVERYTHING] == pytest.approx(0.02, abs=0.006)
    far = null.lack_of_fit(20.0 * z, np.zeros((size, 0)))
    assert far.p_value < 1e-3
    known = Null(size, {}, seed=1, estimated=Estimated(group=one.group - 1, freedom=np.zeros(0)))
    assert (known.noise == Null(size, {}, seed=1).noise).all()
