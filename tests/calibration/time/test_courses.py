"""Ramps and holds of a record, and the effects that they identify."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.experiment.model import CouponTrial, PokeRecord, PokeTrial
from calibration.measurements._course import ramp_start
from calibration.measurements.homogeneous import protocol_window
from calibration.measurements.homogeneous._course import holds_of
from calibration.measurements.homogeneous._record import records_of as homogeneous_records
from calibration.measurements.indentation._course import window_of
from calibration.measurements.indentation._record import records_of
from tisim import Block


def drive(
    times: list[float], stretches: list[float], *, rows: int = 400, noise: float = 0.0, seed: int = 1
) -> CouponTrial:
    at = np.unique(np.concatenate([np.linspace(0.0, times[-1], rows), times]))
    stretch = np.interp(at, times, stretches) + noise * np.random.default_rng(seed).standard_normal(at.size)
    return CouponTrial(
        id="t",
        material="M",
        mode="uniaxial",
        stretch=stretch,
        stress=stretch - 1.0,
        time=at,
        stress_sd=1.0,
        stretch_sd=noise,
    )


@pytest.mark.parametrize("noise", [0.0, 5e-4])
def test_holds_are_found_between_ramps_of_either_direction(noise: float) -> None:
    made = drive([0, 10, 60, 80, 180, 200], [1.0, 1.2, 1.2, 1.5, 1.5, 1.0], noise=noise)
    assert made.time is not None
    found = [(made.time[h.start], made.time[h.stop - 1]) for h in holds_of(made)]
    assert len(found) == 2
    assert found[0] == pytest.approx((10.0, 60.0), abs=1.0)
    assert found[1] == pytest.approx((80.0, 180.0), abs=1.0)


@pytest.mark.parametrize(
    "stretches", [[1.0, 1.5, 1.0, 1.5], [1.0, 1.1, 1.2, 1.5], [1.0, 1.5, 1.5 - 1e-6, 1.0]]
)
def test_ramps_have_no_holds(stretches: list[float]) -> None:
    assert (
        holds_of(drive([0, 30, 30.01, 60] if stretches[2] == 1.5 - 1e-6 else [0, 20, 40, 60], stretches))
        == []
    )


def test_a_smooth_oscillation_has_no_holds() -> None:
    made = drive([0.0, 60.0], [1.0, 1.0])
    assert made.time is not None
    wave = 1.25 - 0.25 * np.cos(2.0 * np.pi * made.time / 20.0)
    oscillating = CouponTrial(
        id="t", material="M", mode="uniaxial", stretch=wave, stress=wave - 1.0, time=made.time
    )
    assert holds_of(oscillating) == []


def test_the_window_of_a_hold_alone_begins_with_the_interval_between_rows() -> None:
    at = np.concatenate([[0.0], np.geomspace(0.1, 1000.0, 50)])
    held = CouponTrial(
        id="t", material="M", mode="uniaxial", stretch=np.full(51, 1.3), stress=np.exp(-at), time=at
    )
    window = protocol_window([held])
    assert window.first == pytest.approx(np.diff(at).min())
    assert window.last == pytest.approx(1000.0)


@pytest.mark.parametrize("seed", range(4))
def test_noise_is_no_ramp(seed: int) -> None:
    """The stretch of a hold alone differs between its ends by its noise, which is 1 % of the strain."""
    made = drive([0.0, 1000.0], [1.3, 1.3], noise=3e-3, seed=seed)
    assert made.time is not None
    assert protocol_window([made]).first == pytest.approx(np.diff(made.time).min())


@pytest.mark.parametrize("seed", range(4))
def test_noise_does_not_end_the_ramp_that_is_followed_back_to_rest(seed: int) -> None:
    """The record begins 5 s after its ramp, in which noise turns the stretch by over 1 % of the strain."""
    made = drive([0.0, 20.0, 100.0], [1.05, 1.25, 1.25], rows=4000, noise=1e-3, seed=seed)
    (record,) = homogeneous_records([made], courses=True)
    assert record.course is not None
    assert record.course.time[0] == pytest.approx(-5.0, abs=3.0)  # else 0, a jump


def test_the_window_goes_from_the_shortest_ramp_to_the_longest_hold() -> None:
    slow = drive([0, 40, 340, 380], [1.0, 1.4, 1.4, 1.0])
    fast = drive([0, 5, 65, 70], [1.0, 1.5, 1.5, 1.0])
    found = protocol_window([slow, fast])
    assert found.first == pytest.approx(5.0, rel=0.1)
    assert found.last == pytest.approx(300.0, rel=0.02)
    assert found.peaks == 2


def test_without_holds_the_window_ends_with_the_test() -> None:
    found = protocol_window([drive([0, 5, 10, 15], [1.0, 1.5, 1.0, 1.5])])
    assert found.first == pytest.approx(5.0, rel=0.02)
    assert found.last == pytest.approx(15.0)
    assert found.peaks == 1


def test_loading_alone_has_no_peak() -> None:
    assert protocol_window([drive([0, 5, 50], [1.0, 1.5, 1.5])]).peaks == 0


def poke(time: np.ndarray, depth_mm: np.ndarray, *, above_mm: float = 0.0) -> PokeTrial:
    """An indentation whose noise of depth is not stated."""
    return PokeTrial(
        id="t",
        material="M",
        specimen=None,
        block=Block(size=(0.1, 0.1, 0.03)),
        inclusion_mesh=None,
        rod_radius=2.5e-3,
        rod_tip="hemisphere",
        start=(0.0, 0.0, 0.03 + 1e-3 * above_mm),
        direction=(0.0, 0.0, -1.0),
        record=PokeRecord(
            time=time, depth=1e-3 * depth_mm, force=0.1 + 0.1 * np.exp(-time / 10.0), force_vector=None
        ),
        force_sd=1e-3,
        depth_sd=0.0,
        surfaces=(),
    )


SECONDS = np.arange(0.0, 100.0, 0.1)


@pytest.mark.parametrize(
    "depth_mm",
    [
        2.0 + 0.0 * SECONDS,
        2.0 + 1e-5 * SECONDS,  # the stage creeps by 1 um
        2.0 - 2e-3 * np.exp(-SECONDS),  # or settles
        *(2.0 + 5e-4 * np.random.default_rng(k).standard_normal(SECONDS.size) for k in range(3)),
    ],
)
def test_an_indentation_that_begins_in_the_hold_has_been_applied_at_once(depth_mm: np.ndarray) -> None:
    trial = poke(SECONDS, depth_mm)
    (record,) = records_of([trial], courses=True)
    assert record.course is not None
    assert record.course.time[0] == 0.0
    window = window_of([trial])
    assert window.first == pytest.approx(0.1)
    assert window.last == pytest.approx(99.9)


def test_time_in_the_air_is_neither_ramp_nor_hold() -> None:
    """2 mm at 1 mm/s, 60 s of hold, back: begun 18 mm above the surface, and left above it for 600 s."""
    corners = np.array([0.0, 2.0, 62.0, 64.0])
    time = np.arange(0.0, 64.05, 0.1)
    near = window_of([poke(time, np.interp(time, corners, [0.0, 2.0, 2.0, 0.0]))])
    long = np.arange(0.0, 700.0, 0.1)
    depth = np.interp(long, [0.0, *(18.0 + corners[1:]), 100.0], [0.0, 20.0, 20.0, 18.0, 0.0])
    far = window_of([poke(long, depth, above_mm=18.0)])
    assert near.first == pytest.approx(2.0, abs=0.3)
    assert near.last == pytest.approx(60.0, abs=1.0)
    assert (far.first, far.last) == pytest.approx((near.first, near.last), abs=0.6)


def test_peaks_are_depths_from_first_touch() -> None:
    """Loadings by 1 and 2 mm, after one in the air, differ alike from on the surface and from 18 mm above."""
    time = np.arange(0.0, 60.0, 0.1)
    path = np.interp(time, np.arange(0.0, 61.0, 10.0), [-10.0, -0.5, -10.0, 1.0, -10.0, 2.0, -10.0])
    assert window_of([poke(time, np.maximum(path, 0.0))]).peaks == 2
    assert window_of([poke(time, 18.0 + path, above_mm=18.0)]).peaks == 2


@pytest.mark.parametrize("rate", [5.0, 500.0])
def test_a_ramp_is_followed_back_to_rest_however_often_it_was_sampled(rate: float) -> None:
    time = np.arange(3.0, 10.0, 1.0 / rate)
    assert ramp_start(time, 0.02 * time, time.size) == pytest.approx(0.0, abs=1e-6)
    assert ramp_start(time, -0.02 * time, time.size) == pytest.approx(0.0, abs=1e-6)


def test_the_speed_of_a_noisy_ramp_is_that_of_more_than_four_rows() -> None:
    time = np.arange(3.0, 10.0, 0.002)
    for seed in range(3):
        noise = 5e-5 * np.random.default_rng(seed).standard_normal(time.size)
        assert ramp_start(time, 0.02 * time + noise, time.size) == pytest.approx(0.0, abs=0.5)


def test_a_rest_at_the_surface_is_no_hold() -> None:
    """The stage stands within a micrometre of it for 50 s, before 2 s of ramp and 10 s of hold."""
    time = np.arange(0.0, 62.0, 0.1)
    depth = 1e-3 + np.interp(time, [50.0, 52.0], [0.0, 2.0])
    window = window_of([poke(time, depth)])
    assert window.last == pytest.approx(10.0, abs=0.5)


def test_creep_is_not_the_end_of_a_ramp() -> None:
    time = np.linspace(0.0, 1000.0, 500)
    assert ramp_start(time, 0.2 + 2e-5 * time, time.size) is None
    assert ramp_start(time, 0.2 - 2e-5 * time, time.size) is None
    assert ramp_start(time, np.zeros(500), 500) is None


def test_a_creep_test_begins_by_a_jump() -> None:
    made = drive([0.0, 1000.0], [1.2, 1.22])
    (record,) = homogeneous_records([made], courses=True)
    assert record.course is not None
    assert record.course.time[0] == 0.0
