"""What of a record is fitted: the first loading, and nothing hidden about the rest."""

from __future__ import annotations

from dataclasses import replace

import made_pokes as made
import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.pokes import loading_branch

UP = np.linspace(0.0, 3e-3, 61)
DOWN = UP[-2::-1]


def force(depth: np.ndarray) -> np.ndarray:
    return 500.0 * np.maximum(depth, 0.0)


def test_it_ends_at_the_reversal() -> None:
    depth = np.concatenate([UP, DOWN, UP])
    branch = loading_branch(made.trial(depth, force(depth)))
    assert branch.depth[-1] == pytest.approx(3e-3, abs=1e-5)
    assert 59 <= len(branch.depth) <= 61
    assert (np.diff(branch.depth) > 0).all()
    assert branch.left_out.startswith(f"{182 - len(branch.depth)} of 182 samples")
    assert "end of the loading at 6 s" in branch.left_out


def test_it_ends_at_a_hold_on_the_way() -> None:
    """Half way a hold of twice the loading's time, in which the force relaxes."""
    depth = np.concatenate([UP[:31], np.full(120, UP[30]), UP[31:]])
    branch = loading_branch(made.trial(depth, force(depth)))
    assert UP[28] <= branch.depth[-1] <= UP[30] * (1 + 1e-9)
    assert "hold" in branch.left_out


def test_steps_with_holds_end_at_the_first() -> None:
    """Pushed in 1 mm at a time at 100 samples a second, held 1 s after each."""
    depth = np.concatenate(
        [np.r_[np.linspace(k, k + 1, 50, endpoint=False), np.full(100, k + 1.0)] for k in range(4)]
    )
    t = made.trial(depth * 1e-3, force(depth * 1e-3), time=0.01 * np.arange(len(depth)))
    assert loading_branch(t).depth[-1] == pytest.approx(1e-3, rel=0.05)


def test_a_hold_at_the_end_is_left_out() -> None:
    depth = np.concatenate([UP, np.full(60, UP[-1])])
    branch = loading_branch(made.trial(depth, force(depth)))
    assert len(branch.depth) <= 61
    assert "in a hold" in branch.left_out


def test_noise_in_depth_is_no_reversal() -> None:
    rng = np.random.default_rng(1)
    depth = np.concatenate([np.linspace(0.0, 3e-3, 601), np.linspace(3e-3, 0.0, 601)])
    noisy = depth + rng.normal(0.0, 2e-5, depth.shape)
    branch = loading_branch(made.trial(noisy, force(depth), time=0.01 * np.arange(1202), depth_sd=2e-5))
    assert 2.85e-3 < branch.depth[-1] < 3.06e-3
    # 601 samples on the way in, some before touch is sure, three a point
    assert 180 <= len(branch.depth) <= 200
    assert branch.sd.mean() == pytest.approx(np.hypot(1e-3, 500.0 * 2e-5) / np.sqrt(3), rel=0.1)


def test_a_steady_or_sparse_record_is_whole() -> None:
    for n in (12, 60, 600):
        depth = np.linspace(0.0, 3e-3, n)
        branch = loading_branch(made.trial(depth, force(depth)))
        assert branch.depth[-1] == pytest.approx(3e-3, rel=0.01)
    assert len(loading_branch(made.trial(UP[::5], force(UP[::5]))).depth) == 12


def test_a_start_above_the_block_is_a_way_to_go() -> None:
    """2 mm above, 30 degrees from the vertical: the first touch is 2 / cos 30 mm on."""
    way = 2e-3 / np.cos(np.pi / 6)
    depth = np.linspace(0.0, way + 3e-3, 200)
    t = made.trial(
        depth, force(depth - way), start=(0.0, 0.0, 0.032), direction=(0.5, 0.0, -float(np.sqrt(0.75)))
    )
    branch = loading_branch(t)
    np.testing.assert_allclose(branch.force, force(branch.depth), atol=1e-9)
    assert "before the first touch" in branch.left_out


def test_max_depth_is_said() -> None:
    branch = loading_branch(made.trial(UP, force(UP)), max_depth=1e-3)
    assert branch.depth[-1] <= 1e-3
    assert "40 deeper than 1 mm" in branch.left_out


def test_without_a_force_sd_the_scatter_speaks() -> None:
    rng = np.random.default_rng(2)
    clean = force(UP[1:])
    noisy = clean * (1.0 + rng.normal(0.0, 0.03, clean.shape))
    branch = loading_branch(made.trial(UP[1:], noisy, force_sd=None))
    assert branch.sd_estimated
    assert branch.sd[-1] / clean[-1] == pytest.approx(0.03, rel=0.4)


def test_records_that_say_nothing_are_refused() -> None:
    with pytest.raises(InputError, match=r"trial p1: record: expected a depth beyond the first touch"):
        loading_branch(made.trial(-UP, force(UP)))
    with pytest.raises(InputError, match=r"trial p1: record: expected at least 5 samples in its first load"):
        loading_branch(made.trial(UP[:3], force(UP[:3])))
    with pytest.raises(InputError, match=r"trial p1: record: expected a force above 0"):
        loading_branch(made.trial(UP, -force(UP)))
    with pytest.raises(InputError, match=r"trial p1: start_mm: .* 5 mm below"):
        loading_branch(made.trial(UP, force(UP), start=(0.0, 0.0, 0.025)))


def test_trials_are_left_as_they_are() -> None:
    t = made.trial(UP, force(UP))
    before = replace(t, record=replace(t.record, depth=t.record.depth.copy(), force=t.record.force.copy()))
    loading_branch(t)
    np.testing.assert_array_equal(t.record.depth, before.record.depth)
    np.testing.assert_array_equal(t.record.force, before.record.force)
    assert isinstance(t.block, tisim.Block)
