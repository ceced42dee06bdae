"""Swept bodies against closed-form volumes and planes."""

from __future__ import annotations

import numpy as np
import pytest
import shape_cases as cases

import tisim
from calibration.errors import InputError
from calibration.experiment.model import Supports
from calibration.shape import Centreline, sweep

CIRCLE = tisim.Circle(radius=0.01)
AREA = np.pi * 1e-4


def arc(*, radius: float, turn: float, supports: Supports = "clamped-free") -> Centreline:
    s = np.linspace(0.0, abs(radius * turn), 201)
    angle = s / radius
    points = radius * np.column_stack([np.sin(angle), 1 - np.cos(angle)])
    return Centreline(s=s, points=points, angle=angle, supports=supports)


def straight(length: float = 0.1, supports: Supports = "clamped-free") -> Centreline:
    s = np.linspace(0.0, length, 11)
    return Centreline(s=s, points=np.column_stack([s, 0 * s]), angle=0 * s, supports=supports)


def test_straight_cylinder() -> None:
    body = sweep(straight(), CIRCLE)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.volume == pytest.approx(AREA * 0.1, rel=1e-9)
    assert body.bounds[:, 0] == pytest.approx([0.0, 0.1], abs=1e-12)


def test_inscribed_polygon_loses_the_area_of_its_segments() -> None:
    body = sweep(straight(), CIRCLE, segments=30, true_area=False)
    assert body.volume == pytest.approx(30 / 2 * 1e-4 * np.sin(2 * np.pi / 30) * 0.1, rel=1e-9)
    assert np.hypot(body.vertices[:, 1], body.vertices[:, 2]).max() == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize("turn", [-1.3, 0.7])
def test_bent_beam_has_area_times_length(turn: float) -> None:
    line = arc(radius=np.copysign(0.08, turn), turn=abs(turn))
    body = sweep(line, CIRCLE, spacing=0.25e-3)
    assert body.is_watertight
    assert body.volume == pytest.approx(AREA * line.length, rel=2e-4)


def test_free_end_is_cut_across_the_line() -> None:
    line = arc(radius=-0.1, turn=0.8)
    body = sweep(line, CIRCLE)
    along = (body.vertices[:, [0, 2]] - line.points[-1]) @ [np.cos(-0.8), np.sin(-0.8)]
    assert along.max() == pytest.approx(0.0, abs=1e-9)
    assert (np.abs(along) < 1e-9).sum() == 65


def test_clamped_ends_are_cut_along_the_faces() -> None:
    """A line oblique to the clamps' faces ends in their planes."""
    x = np.linspace(0.0, 0.15, 301)
    slope = -0.3 * np.cos(np.pi * x / 0.15)
    z = -0.3 * 0.15 / np.pi * np.sin(np.pi * x / 0.15)
    s = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
    line = Centreline(s=s, points=np.column_stack([x, z]), angle=np.arctan(slope), supports="clamped-clamped")
    body = sweep(line, CIRCLE)
    assert body.bounds[:, 0] == pytest.approx([0.0, 0.15], abs=1e-9)
    for face in (0.0, 0.15):
        assert (np.abs(body.vertices[:, 0] - face) < 1e-9).sum() == 65
    assert body.volume == pytest.approx(AREA * line.length, rel=5e-3)


@pytest.mark.parametrize(("supports", "grips"), [("clamped-free", 1), ("clamped-clamped", 2)])
def test_grips_are_straight_pieces_behind_the_faces(supports: Supports, grips: int) -> None:
    body = sweep(straight(0.15, supports), CIRCLE, grip_length=0.02)
    assert body.is_watertight
    assert body.volume == pytest.approx(AREA * (0.15 + grips * 0.02), rel=1e-9)
    assert body.bounds[:, 0] == pytest.approx([-0.02, 0.15 + 0.02 * (grips - 1)], abs=1e-12)


def test_grip_of_a_line_that_starts_askew_is_closed() -> None:
    s = np.linspace(0.0, 0.1, 101)
    line = Centreline(s=s, points=np.column_stack([s * np.cos(0.2), -s * np.sin(0.2)]), angle=0 * s - 0.2)
    body = sweep(line, CIRCLE, grip_length=0.02)
    assert body.is_watertight
    assert body.volume == pytest.approx(AREA * 0.12, rel=2e-3)


def test_rectangle() -> None:
    body = sweep(straight(), tisim.Rectangle(width=0.03, height=0.02))
    assert body.is_watertight
    assert body.volume == pytest.approx(0.03 * 0.02 * 0.1, rel=1e-9)
    assert body.extents == pytest.approx([0.1, 0.03, 0.02], rel=1e-12)


def test_bend_sharper_than_the_section_is_refused() -> None:
    with pytest.raises(InputError, match="bends too sharply"):
        sweep(arc(radius=0.008, turn=1.5), CIRCLE)


def test_traced_edges_lie_on_the_swept_body() -> None:
    """The image-plane outline of the CAD body of traced edges is these edges."""
    from calibration.shape import centreline

    outline = cases.traced()
    body = sweep(centreline(outline, supports="clamped-free", free_length=0.1), CIRCLE, segments=64)
    rim = np.concatenate([outline.upper, outline.lower])
    on_rim = body.vertices[np.abs(body.vertices[:, 1]) < 1e-9][:, [0, 2]]
    gap = np.linalg.norm(rim[:, None] - on_rim[None], axis=2).min(axis=1)
    assert gap.max() < 0.7e-3  # sections are 1 mm apart: half of that, and a margin
