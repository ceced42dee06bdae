"""Ramps and holds of a record, and the effects that they identify."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.experiment.model import CouponTrial
from calibration.measurements.homogeneous import protocol_window
from calibration.measurements.homogeneous._course import holds_of


def drive(times: list[float], stretches: list[float], *, rows: int = 400, noise: float = 0.0) -> CouponTrial:
    at = np.unique(np.concatenate([np.linspace(0.0, times[-1], rows), times]))
    stretch = np.interp(at, times, stretches) + noise * np.random.default_rng(1).standard_normal(at.size)
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
