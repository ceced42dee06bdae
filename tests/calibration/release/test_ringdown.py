"""A synthetic free vibration with creep is recovered; records without a vibration are refused."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.measurements.release import ringdown


def made(rng=None):
    """7.7 Hz (damped) at 5 % about a centre of -6.3 mm that sinks by 0.4 per decade, with a faster mode."""
    t = np.arange(0.0, 2.0, 0.01)
    w = 2.0 * np.pi * 7.7
    c = 0.05 * w / np.sqrt(1.0 - 0.05**2)
    z = -6.3 - 0.4 * np.log10(np.maximum(t, 1e-3)) + 6.0 * np.exp(-c * t) * np.cos(w * t + 0.4)
    z += 0.5 * np.exp(-30.0 * t) * np.cos(250.0 * t)
    return t, z if rng is None else z + rng.normal(0.0, 0.05, len(t))


def test_made_swing():
    found = ringdown(*made(), last=1.8)
    assert found.frequency == pytest.approx(7.7, rel=1e-3)
    assert found.damping_ratio == pytest.approx(0.05, rel=0.01)
    assert found.centre == pytest.approx(-6.3, abs=2e-3)
    assert found.creep == pytest.approx(-0.4, abs=0.01)


def test_noise_is_told_from_the_swing():
    found = ringdown(*made(np.random.default_rng(1)), last=1.8)
    assert found.left == pytest.approx(0.05, rel=0.15)
    assert found.frequency == pytest.approx(7.7, rel=2e-3)


@pytest.mark.parametrize("slow", [0.1, 0.25, 1.0])
@pytest.mark.parametrize("frequency", [3.0, 6.0, 10.0])
def test_a_film_that_goes_over_into_single_photographs(frequency, slow):
    """The longest interval does not limit the frequency."""
    t = np.concatenate([np.arange(0.0, 1.2, 1.0 / 240.0), np.arange(1.2 + slow, 3.0, slow)])
    w = 2.0 * np.pi * frequency
    c = 0.03 * w / np.sqrt(1.0 - 0.03**2)
    z = -30.0 * (1.0 - np.exp(-c * t) * np.cos(w * t)) + np.random.default_rng(2).normal(0.0, 0.05, len(t))
    found = ringdown(t, z, first=0.02, last=3.0)
    assert found.frequency == pytest.approx(frequency, rel=5e-3)
    assert found.damping_ratio == pytest.approx(0.03, rel=0.1)


@pytest.mark.parametrize("fast", [0.0, 90.0])
def test_a_signal_without_a_resolved_vibration_is_refused(fast):
    """Creep alone, or an oscillation that the sampling does not resolve."""
    t = np.arange(0.0, 2.0, 0.01)
    z = -6.0 - 0.4 * np.log10(np.maximum(t, 1e-3)) + np.random.default_rng(3).normal(0.0, 0.05, len(t))
    if fast:
        z = z + np.random.default_rng(4).normal(0.0, 3.0, len(t))
    with pytest.raises(ValueError, match="expected a signal that oscillates at"):
        ringdown(t, z, last=1.8)


def test_refusals():
    t, z = made()
    with pytest.raises(ValueError, match=r"ten samples between 0.15 and 0.2 s, got"):
        ringdown(t, z, last=0.2)
    with pytest.raises(ValueError, match="that oscillates"):
        ringdown(t, np.zeros_like(t))
