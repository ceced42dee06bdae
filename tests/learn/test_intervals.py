"""Intervals have the promised coverage for noise that varies between points and between pokes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from learn.errors import InputError
from learn.evaluation.intervals import coverage, fit_intervals, pooled_quantile, rank_correlation
from learn.evaluation.summary import by_distance
from learn.metrics import Predictions, join_predictions


def _noisy(
    pokes: int,
    seed: int,
    *,
    more: float = 1.0,
    apart: float = 0.0,
    growth: float = 0.0,
    shapes: int = 1,
    near: float = 0.0,
    inclined: float = 0.0,
) -> Predictions:
    """Predictions with errors that decrease with the distance from the tip and increase with the depth.

    `apart` is the standard deviation of the logarithm of a factor common to all errors of a poke. The
    logarithm of the errors grows by `growth` per mm of the inclusion's size, with `shapes` sizes of 1 mm and
    more, by `near` per mm of the gap, and by `inclined` per degree; each poke has its own gap of 2 to 6 mm
    and its own angle of 0 to 45 degrees.
    """
    random = np.random.default_rng(seed)
    frames, n = pokes * 4, 300
    away = random.uniform(0, 0.05, (frames, n))
    depth = np.tile([2e-3, 4e-3, 6e-3, 8e-3], pokes)
    truth = np.zeros((frames, n, 3))
    truth[..., 2] = -depth[:, None] * np.exp(-away / 0.01)
    shape = np.repeat(np.arange(pokes) % shapes, 4)
    gap = np.repeat(np.random.default_rng([seed, 1]).uniform(2, 6, pokes), 4)
    angle = np.repeat(np.random.default_rng([seed, 2]).uniform(0, 45, pokes), 4)
    own = np.repeat(np.exp(apart * random.normal(size=pokes)), 4)
    own *= np.exp(growth * (1 + shape) + near * (gap - 4) + inclined * (angle - 20))
    scale = more * 0.02 * (own * depth)[:, None] * np.exp(-away / 0.02)
    predicted = truth + random.normal(size=truth.shape) * scale[..., None]
    force = depth * 500
    return Predictions(
        truth=truth.astype(np.float32),
        predicted=predicted.astype(np.float32),
        force=force,
        force_predicted=force * np.exp(0.05 * own * random.normal(size=frames)),
        away=away,
        depth=depth,
        poke=np.repeat(np.arange(pokes), 4),
        softness=np.full(frames, "S0"),
        shape=shape.astype(str),
        covariates=np.stack([1.0 + shape, gap, angle], axis=1),
    )


def test_ninety_per_cent_are_covered_near_and_far() -> None:
    intervals = fit_intervals(_noisy(300, 0))
    found = coverage(intervals, _noisy(100, 1))
    assert intervals.promised == 0.9
    assert 0.88 <= found.points <= 0.92
    assert 0.86 <= found.force <= 0.94
    assert all(0.86 <= ring <= 0.94 for ring in found.rings[:-1])  # few points in the last ring
    assert rank_correlation(intervals, _noisy(100, 1)) > 0.6


def test_pokes_that_differ_are_covered_on_average_over_calibrations() -> None:
    """With few pokes the coverage varies, but its mean over calibrations is 90 % or more, as promised."""
    shares = []
    for seed in range(30):
        intervals = fit_intervals(_noisy(24, seed, apart=0.8))
        shares.append(coverage(intervals, _noisy(40, 1000 + seed, apart=0.8)).points)
    assert 0.9 - 2 * np.std(shares) / 30**0.5 <= np.mean(shares) <= 0.97


def test_pooled_quantile_counts_pokes_not_points() -> None:
    """By hand: of nine pokes with one score each, the 0.9 quantile with ten equal weights is the ninth.

    A poke of a thousand points has the same weight as one of a single point.
    """
    nine, of_nine = np.arange(1.0, 10.0), np.arange(9)
    assert pooled_quantile(nine, of_nine, 0.9) == 9
    assert pooled_quantile(nine, of_nine, 0.75) == 8
    scores = np.concatenate([np.linspace(0, 1, 1000), nine])
    poke = np.concatenate([np.full(1000, 99), of_nine])
    assert pooled_quantile(scores, poke, 0.85) == 9
    assert pooled_quantile(scores, poke, 0.6) == 6


def test_few_pokes_promise_less() -> None:
    intervals = fit_intervals(_noisy(8, 0))
    assert (intervals.pokes, intervals.promised) == (8, 8 / 9)


def test_spread_makes_the_intervals_wide_where_the_members_differ() -> None:
    """With a spread that identifies bad pokes the coverage is as promised, and the intervals are narrower."""
    pokes, apart = 80, 1.0

    def known(seed: int) -> Predictions:
        own = np.repeat(np.exp(apart * np.random.default_rng(seed + 1).normal(size=pokes)), 4)  # another draw
        plain = _noisy(pokes, seed, apart=0.0)
        factor = own[:, None, None]
        wrong = (plain.predicted - plain.truth) * factor
        spread = 0.02 * factor[..., 0] * plain.depth[:, None] * np.exp(-plain.away / 0.02)
        predicted = (plain.truth + wrong).astype(np.float32)
        return dataclasses.replace(plain, predicted=predicted, spread=spread)

    fitting, test = known(0), known(5)
    blind = dataclasses.replace(fitting, spread=np.zeros(0))
    blind_test = dataclasses.replace(test, spread=np.zeros(0))
    seeing, without = fit_intervals(fitting), fit_intervals(blind)
    assert 0.87 <= coverage(seeing, test).points <= 0.97
    assert rank_correlation(seeing, test) > rank_correlation(without, blind_test) + 0.05
    assert seeing.radius_mm(test).mean() < without.radius_mm(blind_test).mean()


def test_a_worse_model_is_not_covered() -> None:
    """Errors three times as large are outside: the coverage can fail."""
    found = coverage(fit_intervals(_noisy(60, 0)), _noisy(100, 1, more=3.0))
    assert found.points < 0.5
    assert found.pokes == 0


def test_the_coverage_of_another_sample_is_off_by_the_stated_error() -> None:
    """Samples of 40 pokes that differ; errors of a single point count for nothing beside that."""
    intervals = fit_intervals(_noisy(200, 0, apart=0.8))
    found = [coverage(intervals, _noisy(40, 50 + seed, apart=0.8)) for seed in range(80)]
    for name in ("points", "force"):
        scatter = np.std([getattr(c, name) for c in found])
        assert np.mean([getattr(c, f"{name}_error") for c in found]) == pytest.approx(scatter, rel=0.25)
        assert scatter > 0.01


def test_pokes_of_one_shape_are_one_draw() -> None:
    """Repeated pokes say no more of other shapes; with few shapes the pokes are the draws."""
    intervals, test = fit_intervals(_noisy(60, 0)), _noisy(20, 1, apart=0.8)
    again = dataclasses.replace(test, poke=test.poke + 20)
    each = [dataclasses.replace(one, shape=(one.poke % 20).astype(str)) for one in (test, again)]
    alone, twice = (coverage(intervals, part) for part in (each[0], join_predictions(each)))
    assert twice.points_error == pytest.approx(alone.points_error, rel=1e-9)
    two = [dataclasses.replace(one, shape=(one.poke % 2).astype(str)) for one in (test, again)]
    assert coverage(intervals, two[0]).points_error == pytest.approx(alone.points_error, rel=1e-9)
    assert coverage(intervals, join_predictions(two)).points_error < 0.75 * alone.points_error
    assert np.isnan(coverage(intervals, test.where(test.poke == 0)).points_error)


def test_one_poke_is_not_enough() -> None:
    with pytest.raises(InputError, match="at least two validation pokes"):
        fit_intervals(_noisy(1, 0))


def test_each_frame_is_widened_by_its_own_distance() -> None:
    predictions = _noisy(4, seed=3)
    intervals = fit_intervals(_noisy(30, seed=1))
    distance = np.linspace(0.0, 2.0, len(predictions.depth))
    radius = intervals.radius_mm(predictions, distance=distance)
    factor = intervals.force_log(predictions.force_spread, distance=distance)
    for frame in (0, 3, len(distance) - 1):
        alone = predictions.where(np.arange(len(distance)) == frame)
        assert np.array_equal(radius[frame], intervals.radius_mm(alone, distance=distance[frame])[0])
        assert factor[frame] == intervals.force_log(alone.force_spread, distance=float(distance[frame]))[0]
    assert np.array_equal(radius[0], intervals.radius_mm(predictions)[0])
    assert (np.diff(factor) > 0.0).all()


def test_frames_are_told_apart_by_how_far_outside_they_are() -> None:
    """Errors that grow outside the trained ranges are covered by widened intervals only."""
    intervals = fit_intervals(_noisy(40, seed=1))
    within, beyond = _noisy(20, seed=2), _noisy(20, seed=5, more=12.0)
    predictions = join_predictions([within, beyond])
    distance = np.concatenate([np.zeros(len(within.depth)), np.full(len(beyond.depth), 0.5)])
    found = by_distance(predictions, distance, intervals)
    assert list(found) == ["inside", "0.3 to 1"]
    inside, outside = found["inside"], found["0.3 to 1"]
    assert inside.calibrated == inside.widened is not None
    assert outside.calibrated is not None
    assert outside.widened is not None
    assert inside.calibrated.points > 0.85
    # near the tip; far from it these errors exceed the displacement
    assert outside.calibrated.rings[0] < 0.5 < 0.9 < outside.widened.rings[0]
    assert outside.mean_mm > 8 * inside.mean_mm
    assert [one.frames for one in found.values()] == [len(within.depth), len(beyond.depth)]


def test_errors_that_grow_with_the_inclusion_are_covered_beside_a_larger_one() -> None:
    """The growth is fitted to five shapes; the tested sixth is twice their mean size."""
    five, six = _noisy(200, 0, growth=0.3, shapes=5), _noisy(300, 1, growth=0.3, shapes=6)
    largest = six.where(six.shape == "5")
    intervals = fit_intervals(five)
    assert intervals.growth == pytest.approx((0.3, 0.0, 0.0), abs=0.03)
    assert intervals.force_growth == pytest.approx((0.3, 0.0, 0.0), abs=0.1)
    found = coverage(intervals, largest)
    assert all(0.87 <= ring <= 0.93 for ring in found.rings[:3])  # farther away errors are below 1e-4 mm
    assert 0.82 <= found.force <= 0.96
    unaware = fit_intervals(dataclasses.replace(five, covariates=np.zeros(0)))
    assert max(coverage(unaware, largest).rings[:3]) < 0.75


def test_few_shapes_do_not_say_how_errors_grow() -> None:
    intervals = fit_intervals(_noisy(200, 0, growth=0.3, shapes=4))
    assert (intervals.growth, intervals.force_growth) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_errors_that_grow_near_what_is_rigid_are_covered_there() -> None:
    """Each poke has its own gap."""
    many, other = _noisy(200, 0, near=-0.4, shapes=5), _noisy(400, 1, near=-0.4, shapes=5)
    nearest = other.where(other.covariates[:, 1] < 3.0)
    intervals = fit_intervals(many)
    assert intervals.growth == pytest.approx((0.0, -0.4, 0.0), abs=0.03)
    assert intervals.force_growth == pytest.approx((0.0, -0.4, 0.0), abs=0.1)
    assert all(0.87 <= ring <= 0.93 for ring in coverage(intervals, nearest).rings[:3])
    unaware = fit_intervals(dataclasses.replace(many, covariates=np.zeros(0)))
    assert max(coverage(unaware, nearest).rings[:3]) < 0.8


def test_errors_that_grow_with_the_angle_are_covered_under_an_inclined_indenter() -> None:
    many, other = (_noisy(n, seed, inclined=0.04, shapes=5) for seed, n in enumerate((200, 400)))
    steep = other.where(other.covariates[:, 2] > 35.0)
    intervals = fit_intervals(many)
    assert intervals.growth == pytest.approx((0.0, 0.0, 0.04), abs=0.01)
    assert all(0.87 <= ring <= 0.93 for ring in coverage(intervals, steep).rings[:3])
    unaware = fit_intervals(dataclasses.replace(many, covariates=np.zeros(0)))
    assert max(coverage(unaware, steep).rings[:3]) < 0.8


def test_intervals_of_one_poke_are_those_of_its_frame() -> None:
    intervals = fit_intervals(_noisy(100, 0, growth=0.3, shapes=5, near=-0.2))
    frame = _noisy(5, 1, shapes=5).where(np.arange(20) == 17)
    assert frame.covariates[0][0] == 5.0
    radius = intervals.radius_at_mm(
        np.linalg.norm(frame.predicted[0], axis=1),
        away=frame.away[0],
        depth=float(frame.depth[0]),
        covariates=frame.covariates[0],
    )
    np.testing.assert_allclose(radius, intervals.radius_mm(frame)[0], rtol=1e-6)  # lengths in float32
    of_force = intervals.force_log(covariates=frame.covariates)[0]
    assert intervals.force_log(covariates=frame.covariates[0]) == pytest.approx(of_force, rel=1e-12)
    bare = dataclasses.replace(frame, covariates=np.zeros(0))
    assert (radius > intervals.radius_mm(bare)).all()
