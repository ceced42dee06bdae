"""The compared part of a record: all of it, or the first loading, with a remark on the rest."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from typing import Any

import made_pokes as made
import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.experiment.model import PokeTrial
from calibration.measurements.indentation import approach, poke_scene
from calibration.measurements.indentation._record import Record, check_pushed, part_of, records_of

UP = np.linspace(0.0, 3e-3, 61)
DOWN = UP[-2::-1]


def force(depth: np.ndarray) -> np.ndarray:
    return 500.0 * np.maximum(depth, 0.0)


def first_loading(trial: PokeTrial, **options: Any) -> tuple[Record, str]:
    """The record up to the end of its first loading, and the remarks on the rest."""
    (record,), said = part_of(records_of([trial]), **{"max_depth": None, "first_loading": True, **options})
    return record, "; ".join(said)


@pytest.mark.parametrize("tip", ["flat", "hemisphere"])
@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_depth_counts_from_where_the_tip_touches(tip: str, degrees: float) -> None:
    """A tilted indenter that starts 5 mm above the block touches with its rim, before its tip's centre."""
    tilt = np.radians(degrees)
    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    simple = made.trial(UP, force(UP))
    start = np.array([0.0, 0.0, simple.block.size[2]]) - 5e-3 * axis
    trial = replace(simple, rod_tip=tip, start=tuple(start), direction=tuple(axis))
    edge = trial.rod_radius if tip == "hemisphere" else 0.4 * trial.rod_radius
    # the lowest point of a circle of radius R - e about the tip, rounded by e
    rim = (trial.rod_radius - edge) * np.sin(tilt) + edge * (1.0 - np.cos(tilt))
    assert approach(trial) == pytest.approx(5e-3 - rim / np.cos(tilt), abs=1e-12)
    found = tisim.simulate(
        poke_scene(
            trial, tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=2e5), depth=1e-3
        )
    )
    assert found.rod_tip is not None
    travel = (found.rod_tip - start) @ axis
    assert travel - approach(trial) == pytest.approx(found.load, abs=1e-9)


def test_it_ends_at_the_reversal() -> None:
    depth = np.concatenate([UP, DOWN, UP])
    trial = made.trial(depth, force(depth))
    (whole,) = records_of([trial])
    record, said = first_loading(trial)
    assert UP[-3] <= record.depth[-1] <= UP[-1]  # the mean of the last two or three samples
    assert (np.diff(record.depth) > 0).all()
    left = whole.points - record.points
    assert said == f"p1: {left} of {whole.points} points are not used: {left} after the first loading"
    assert part_of([whole], max_depth=None, first_loading=False) == ([whole], ())


def test_it_ends_at_a_hold_on_the_way() -> None:
    """A hold at half of the depth, of twice the loading's duration, in which the force relaxes."""
    depth = np.concatenate([UP[:31], np.full(120, UP[30]), UP[31:]])
    record, said = first_loading(made.trial(depth, force(depth)))
    assert UP[28] <= record.depth[-1] <= UP[30] * (1 + 1e-9)
    assert "after the first loading" in said


def test_steps_with_holds_end_at_the_first() -> None:
    """Steps of 1 mm at 100 samples per second, each followed by a hold of 1 s."""
    depth = np.concatenate(
        [np.r_[np.linspace(k, k + 1, 50, endpoint=False), np.full(100, k + 1.0)] for k in range(4)]
    )
    t = made.trial(depth * 1e-3, force(depth * 1e-3), time=0.01 * np.arange(len(depth)))
    # means of twelve samples, 0.24 mm apart, none of them from the hold
    assert 0.76e-3 < first_loading(t)[0].depth[-1] <= 1e-3


def test_a_hold_at_the_end_is_left_out() -> None:
    depth = np.concatenate([UP, np.full(60, UP[-1])])
    record, said = first_loading(made.trial(depth, force(depth)))
    assert record.points <= 61
    assert (record.direction > 0.0).all()
    assert "after the first loading" in said


def test_noise_in_depth_is_no_reversal() -> None:
    rng = np.random.default_rng(1)
    depth = np.concatenate([np.linspace(0.0, 3e-3, 601), np.linspace(3e-3, 0.0, 601)])
    noisy = depth + rng.normal(0.0, 2e-5, depth.shape)
    record, _ = first_loading(made.trial(noisy, force(depth), time=0.01 * np.arange(1202), depth_sd=2e-5))
    assert 2.85e-3 < record.depth[-1] < 3.06e-3
    # 601 samples of loading, twelve per point; smoothing keeps the noise of depths out of the force's
    assert record.points == 50
    assert record.own_sd.mean() == pytest.approx(1e-3 / np.sqrt(12), rel=0.1)


def test_a_steady_or_sparse_record_is_whole() -> None:
    for n in (12, 60, 600):
        depth = np.linspace(0.0, 3e-3, n)
        record, said = first_loading(made.trial(depth, force(depth)))
        assert record.depth[-1] == pytest.approx(3e-3, rel=0.01)
        assert said == ""
    assert first_loading(made.trial(UP[::5], force(UP[::5])))[0].points == 13


def test_a_start_above_the_block_is_a_way_to_go() -> None:
    """A start 2 mm above, at 30 degrees from the vertical: the rim, 0.88 mm below the tip, touches first."""
    rim = 1.5e-3 * np.sin(np.pi / 6) + 1e-3 * (1.0 - np.cos(np.pi / 6))
    way = (2e-3 - rim) / np.cos(np.pi / 6)
    depth = np.linspace(0.0, way + 3e-3, 200)
    t = made.trial(
        depth, force(depth - way), start=(0.0, 0.0, 0.032), direction=(0.5, 0.0, -float(np.sqrt(0.75)))
    )
    record, _ = first_loading(t)
    # if samples before and after first touch are averaged, the force is not that of their mean depth
    np.testing.assert_allclose(
        record.force, force(record.depth), atol=500.0 * np.diff(record.depth).max() / 4
    )
    assert record.depth[0] == pytest.approx(-way, abs=1e-4)
    assert (record.force[record.depth < -1e-4] == 0.0).all()


def test_max_depth_is_said() -> None:
    record, said = first_loading(made.trial(UP, force(UP)), max_depth=1e-3)
    assert record.depth[-1] <= 1e-3
    assert "deeper than 1 mm" in said


def test_without_a_force_sd_the_scatter_speaks() -> None:
    rng = np.random.default_rng(2)
    clean = force(UP[1:])
    noisy = clean * (1.0 + rng.normal(0.0, 0.03, clean.shape))
    record, _ = first_loading(made.trial(UP[1:], noisy, force_sd=None))
    assert record.estimated
    last = record.own_sd[-1] * np.sqrt(record.count[-1]) / force(record.depth[-1:])[0]
    assert last == pytest.approx(0.03, rel=0.4)


def test_averaging_does_not_take_an_unstated_force_error_below_its_floor() -> None:
    """A load cell errs by a fraction of its range, however many of its samples are averaged."""
    depth = np.linspace(0.0, 2e-3, 1000)
    smooth = 5.0 * (depth / 2e-3) ** 1.3
    record, *_ = records_of([made.trial(depth, smooth, force_sd=None)])
    assert record.count.min() >= 20.0
    assert record.own_sd == pytest.approx(np.full(record.points, 0.005 * 5.0))
    stated, *_ = records_of([made.trial(depth, smooth, force_sd=0.1)])
    assert stated.own_sd == pytest.approx(0.1 / np.sqrt(stated.count))


def test_the_memory_of_a_long_record_grows_with_its_rows() -> None:
    """Its scatter grows with the force, so that a smooth curve is taken; of all rows it took n^2 numbers."""
    rows = 3000
    depth = np.linspace(1e-5, 2e-3, rows)
    force = 5.0 * (depth / 2e-3) ** 1.3 * (1.0 + 0.05 * np.random.default_rng(3).standard_normal(rows))
    tracemalloc.start()
    records_of([made.trial(depth, force, force_sd=None)])
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < rows**2 * 8 / 2


def test_records_that_say_nothing_are_refused() -> None:
    with pytest.raises(InputError, match=r"trial p1: record: expected a depth beyond the first touch"):
        check_pushed(records_of([made.trial(-UP, force(UP))]))
    with pytest.raises(InputError, match=r"trial p1: record: expected at least 5 points to compare, got 3"):
        check_pushed([first_loading(made.trial(UP[:3], force(UP[:3])))[0]])
    with pytest.raises(InputError, match=r"trial p1: record: expected a force above 0"):
        check_pushed(records_of([made.trial(UP, -force(UP))]))
    with pytest.raises(InputError, match=r"trial p1: start_mm: .* 5 mm below"):
        records_of([made.trial(UP, force(UP), start=(0.0, 0.0, 0.025))])


def test_trials_are_left_as_they_are() -> None:
    t = made.trial(UP, force(UP))
    before = replace(t, record=replace(t.record, depth=t.record.depth.copy(), force=t.record.force.copy()))
    first_loading(t)
    np.testing.assert_array_equal(t.record.depth, before.record.depth)
    np.testing.assert_array_equal(t.record.force, before.record.force)
    assert isinstance(t.block, tisim.Block)
