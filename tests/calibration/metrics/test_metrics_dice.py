"""Dice coefficients against closed forms, agreement of the two methods, refusals."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from calibration.errors import InputError
from calibration.metrics import dice


def moved(body: trimesh.Trimesh, by: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.Trimesh(body.vertices + by, body.faces, process=False)


def lens(radius: float, gap: float) -> float:
    """Volume of the intersection of two spheres with centres `gap` apart."""
    return np.pi * (4 * radius + gap) * (2 * radius - gap) ** 2 / 12


@pytest.mark.parametrize("method", ["boolean", "winding"])
@pytest.mark.parametrize("gap", [0.004, 0.012])
def test_two_spheres(method, gap: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.01)
    true = lens(0.01, gap) / (4 / 3 * np.pi * 0.01**3)
    assert dice(ball, moved(ball, (gap, 0, 0)), method=method) == pytest.approx(true, abs=1e-3)


@pytest.mark.parametrize("method", ["boolean", "winding"])
def test_cylinder_displaced_sideways(method) -> None:
    """The paper's Dice of 0.95 corresponds to a lateral shift of 0.79 mm of a 20 mm beam."""
    rod = trimesh.creation.cylinder(radius=0.01, height=0.1, sections=256)
    d = 0.00079
    shared = 2 * 1e-4 * np.arccos(d / 0.02) - d / 2 * np.sqrt(4e-4 - d**2)
    assert shared / (np.pi * 1e-4) == pytest.approx(0.95, abs=1e-3)
    assert dice(rod, moved(rod, (d, 0, 0)), method=method) == pytest.approx(shared / (np.pi * 1e-4), abs=2e-4)


@pytest.mark.parametrize("method", ["boolean", "winding"])
def test_boxes_of_different_size(method) -> None:
    long, short = trimesh.creation.box((0.02, 0.02, 0.12)), trimesh.creation.box((0.02, 0.02, 0.06))
    share = 2 * 6 / (6 + 12)
    inside = moved(short, (0.0, 0.0, 0.0123))
    assert dice(long, inside, method=method) == pytest.approx(share, abs=1e-6)
    assert dice(inside, long, method=method) == pytest.approx(share, abs=1e-6)


@pytest.mark.parametrize("method", ["boolean", "winding"])
def test_same_and_disjoint(method) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.01)
    assert dice(ball, ball, method=method) == pytest.approx(1.0, abs=1e-6)
    assert dice(ball, moved(ball, (0.03, 0, 0)), method=method) == 0.0


def test_far_from_the_origin() -> None:
    """manifold3d has single precision, with an error of 0.5 per mille at ten metres."""
    box = trimesh.creation.box((0.02, 0.02, 0.1))
    away = (10.0, -7.0, 3.0)
    near = dice(box, moved(box, (0.001, 0, 0)))
    far = dice(moved(box, away), moved(moved(box, away), (0.001, 0, 0)))
    assert near == pytest.approx(0.95, abs=1e-6)
    assert far == pytest.approx(near, abs=1e-6)


def test_the_winding_method_takes_a_surface_that_crosses_itself() -> None:
    """Two overlapping boxes in one surface: their intersection counts once."""
    box = trimesh.creation.box((0.02, 0.02, 0.02))
    crossed = trimesh.util.concatenate([box, moved(box, (0.01, 0, 0))])
    whole = moved(trimesh.creation.box((0.03, 0.02, 0.02)), (0.005, 0, 0))
    assert dice(crossed, whole, method="winding", spacing=0.1e-3) == pytest.approx(1.0, abs=0.01)
    half = dice(crossed, moved(whole, (0.015, 0, 0)), method="winding", spacing=0.1e-3)
    assert half == pytest.approx(0.5, abs=0.01)


def test_refusals() -> None:
    box = trimesh.creation.box((0.02, 0.02, 0.02))
    opened = trimesh.Trimesh(box.vertices, box.faces[1:], process=False)
    turned = trimesh.Trimesh(box.vertices, box.faces[:, ::-1], process=False)
    with pytest.raises(InputError, match="simulated body: expected a closed surface"):
        dice(opened, box)
    with pytest.raises(InputError, match="measured body: expected faces turned outward"):
        dice(box, turned)
    with pytest.raises(InputError, match="no triangles"):
        dice(trimesh.Trimesh(), box)
    with pytest.raises(ValueError, match="'boolean' or 'winding'"):
        dice(box, box, method="voxel")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="spacing"):
        dice(box, box, method="winding", spacing=0.0)


def test_a_failing_boolean_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no fallback to another method."""
    box = trimesh.creation.box((0.02, 0.02, 0.02))

    def fails(*_: object, **__: object) -> None:
        raise ValueError("not manifold")

    monkeypatch.setattr(trimesh.boolean, "intersection", fails)
    with pytest.raises(InputError, match="could not be intersected: not manifold"):
        dice(box, box)
    monkeypatch.setattr(
        trimesh.boolean, "intersection", lambda *_, **__: trimesh.creation.box((0.1, 0.1, 0.1))
    )
    with pytest.raises(InputError, match="does a surface cross itself"):
        dice(box, box)
