"""The centre line of traced edges against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shape_cases as cases

from calibration.errors import InputError
from calibration.shape import Centreline, centreline


def test_mid_line_of_exact_edges() -> None:
    line = centreline(cases.traced(), supports="clamped-free", free_length=0.1)
    points, angle = cases.hanging(line.s, length=0.1, drop=0.8)
    assert line.length == pytest.approx(0.1, abs=2e-5)
    assert np.linalg.norm(line.points - points, axis=1).max() < 3e-5
    assert np.abs(line.angle - angle).max() < np.radians(0.5)
    assert line.half_height == pytest.approx(cases.H, abs=2e-5)
    assert line.points[0, 0] == 0.0


def test_line_ends_at_the_middle_of_the_end_face() -> None:
    line = centreline(cases.traced(), supports="clamped-free", free_length=0.1)
    end, _ = cases.hanging(np.array([0.1]), length=0.1, drop=0.8)
    assert line.points[-1] == pytest.approx(end[0], abs=3e-5)


def test_bridge_reaches_the_far_clamp() -> None:
    x = np.linspace(1e-3, 0.149, 60)
    z = -0.004 * (1 - np.cos(2 * np.pi * x / 0.15))
    slope = np.arctan(-0.004 * 2 * np.pi / 0.15 * np.sin(2 * np.pi * x / 0.15))
    normal = np.column_stack([-np.sin(slope), np.cos(slope)])
    mid = np.column_stack([x, z])
    outline = replace(cases.traced(), upper=mid + cases.H * normal, lower=mid - cases.H * normal)
    line = centreline(outline, supports="clamped-clamped", free_length=0.15)
    assert line.points[-1] == pytest.approx([0.15, 0.0], abs=5e-5)
    assert line.points[[0]] == pytest.approx(np.zeros((1, 2)), abs=5e-5)
    assert line.points[:, 1].min() == pytest.approx(-0.008, abs=1e-5)


def test_shift_and_roll_stay_in_the_line() -> None:
    """The line keeps a misalignment of the photograph, since it represents the data."""
    roll, up = np.radians(1.0), 0.5e-3
    outline = cases.traced(drop=0.0)
    turn = np.array([[np.cos(roll), np.sin(roll)], [-np.sin(roll), np.cos(roll)]])
    moved = replace(outline, upper=outline.upper @ turn + [0, up], lower=outline.lower @ turn + [0, up])
    line = centreline(moved, supports="clamped-free", free_length=0.1)
    assert line.points[0, 1] == pytest.approx(up, abs=1e-5)
    assert line.angle == pytest.approx(roll, abs=np.radians(0.1))


def test_sd_is_the_scatter_of_the_line() -> None:
    """Over noisy tracings of one beam, the normal error has the stated sd."""
    scores = []
    for seed in range(16):
        outline = cases.traced(noise=1e-4, seed=seed)
        line = centreline(outline, supports="clamped-free", free_length=0.1, spacing=5e-3)
        assert line.sd is not None
        inside = (line.s > 2e-3) & (line.s < 0.098)
        points, angle = cases.hanging(line.s, length=0.1, drop=0.8)
        normal = np.column_stack([-np.sin(angle), np.cos(angle)])
        scores.append((((line.points - points) * normal).sum(axis=1) / line.sd)[inside])
    assert np.sqrt(np.mean(np.concatenate(scores) ** 2)) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda o: replace(o, upper=o.upper[:5]), "upper edge: expected at least 8 points, got 5"),
        (lambda o: replace(o, lower=o.lower[:, :1]), "lower edge: expected finite points"),
        (lambda o: replace(o, upper=o.upper * np.nan), "upper edge: expected finite points"),
        (lambda o: replace(o, upper=o.upper[np.r_[0, 0:45]]), "two in a row are the same"),
        (lambda o: replace(o, upper=o.upper[20:], lower=o.lower[20:]), "start within"),
        (lambda o: replace(o, upper=o.upper[:30], lower=o.lower[:25]), "about as long as the free length"),
        (lambda o: replace(o, upper=o.lower, lower=o.upper), "mixed up"),
    ],
)
def test_unfit_outlines_are_refused_in_one_sentence(change, message) -> None:
    with pytest.raises(InputError, match=message) as caught:
        centreline(change(cases.traced()), supports="clamped-free", free_length=0.1)
    assert "\n" not in str(caught.value)


def test_bridge_traced_over_half_its_length_is_refused() -> None:
    with pytest.raises(InputError, match="far clamp face"):
        centreline(cases.traced(drop=0.0), supports="clamped-clamped", free_length=0.12)


def test_centreline_checks_its_arrays() -> None:
    s = np.linspace(0, 0.1, 5)
    with pytest.raises(ValueError, match="points"):
        Centreline(s=s, points=np.zeros((4, 2)), angle=s)
    with pytest.raises(ValueError, match="increase from 0"):
        Centreline(s=s[::-1], points=np.zeros((5, 2)), angle=s)
