"""Intervals cover what they promise, where the noise differs from point to point."""

from __future__ import annotations

import numpy as np
import pytest

from learn.errors import InputError
from learn.evaluation.intervals import coverage, fit_intervals, rank_correlation
from learn.metrics import Cases


def _noisy(pokes: int, seed: int, *, more: float = 1.0) -> Cases:
    """Predictions with errors that fall with the distance from the tip and grow with the depth."""
    random = np.random.default_rng(seed)
    frames, n = pokes * 4, 300
    away = random.uniform(0, 0.05, (frames, n))
    depth = np.tile([2e-3, 4e-3, 6e-3, 8e-3], pokes)
    truth = np.zeros((frames, n, 3))
    truth[..., 2] = -depth[:, None] * np.exp(-away / 0.01)
    scale = more * 0.02 * depth[:, None] * np.exp(-away / 0.02)
    predicted = truth + random.normal(size=truth.shape) * scale[..., None]
    force = depth * 500
    return Cases(
        truth=truth.astype(np.float32),
        predicted=predicted.astype(np.float32),
        force=force,
        force_predicted=force * np.exp(0.05 * random.normal(size=frames)),
        away=away,
        depth=depth,
        poke=np.repeat(np.arange(pokes), 4),
        softness=np.full(frames, "S0"),
    )


def test_ninety_per_cent_are_covered() -> None:
    intervals = fit_intervals(_noisy(60, 0))
    test = _noisy(100, 1)
    points, force = coverage(intervals, test)
    assert 0.88 <= points <= 0.92
    assert 0.86 <= force <= 0.94
    assert rank_correlation(intervals, test) > 0.6


def test_coverage_holds_near_and_far() -> None:
    """Not only on the whole: the scale follows the noise."""
    intervals = fit_intervals(_noisy(60, 0))
    test = _noisy(100, 1)
    inside = test.distance_mm <= intervals.radius_mm(test)
    for low, high in ((0, 0.005), (0.005, 0.02), (0.02, 0.05)):
        ring = (test.away >= low) & (test.away < high)
        assert 0.85 <= inside[ring].mean() <= 0.95


def test_a_worse_model_is_not_covered() -> None:
    """The count can fail: errors three times as large fall outside."""
    intervals = fit_intervals(_noisy(60, 0))
    assert coverage(intervals, _noisy(100, 1, more=3.0))[0] < 0.5


def test_one_poke_is_not_enough() -> None:
    with pytest.raises(InputError, match="at least two validation pokes"):
        fit_intervals(_noisy(1, 0))
