"""Properties of every metric: symmetry, invariance under rigid motion, range, and equality of bodies."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration import metrics
from calibration.errors import InputError

size = st.floats(0.01, 0.04)
offset = st.floats(-0.015, 0.015)
angle = st.floats(-3.0, 3.0)


@st.composite
def bodies(draw: st.DrawFn) -> trimesh.Trimesh:
    """An ellipsoid near the origin, rotated."""
    body = trimesh.creation.icosphere(subdivisions=2)
    body.apply_scale([draw(size), draw(size), draw(size)])
    body.apply_transform(motion((draw(angle), draw(angle), 0.0), (draw(offset), draw(offset), draw(offset))))
    return body


def motion(turns: tuple[float, float, float], by: tuple[float, float, float]) -> np.ndarray:
    matrix = trimesh.transformations.euler_matrix(*turns)
    matrix[:3, 3] = by
    return matrix


@settings(max_examples=8, deadline=None)
@given(bodies(), bodies())
def test_symmetry_and_range(a: trimesh.Trimesh, b: trimesh.Trimesh) -> None:
    there, back = metrics.compare(a, b), metrics.compare(b, a)
    for name in ("dice", "surface_distance", "hd95"):
        assert there[name] == pytest.approx(back[name], rel=1e-5, abs=1e-9)
    assert 0.0 <= there["dice"] <= 1.0
    assert there["surface_distance"] >= 0.0
    assert there["hd95"] >= 0.0


@settings(max_examples=8, deadline=None)
@given(bodies(), bodies(), st.tuples(angle, angle, angle), st.tuples(offset, offset, offset))
def test_rigid_motion_changes_nothing(a, b, turns, by) -> None:
    matrix = motion(turns, by)
    before = metrics.compare(a, b)
    after = metrics.compare(a.copy().apply_transform(matrix), b.copy().apply_transform(matrix))
    for name, value in before.items():
        assert after[name] == pytest.approx(value, rel=1e-5, abs=1e-7), name


@settings(max_examples=6, deadline=None)
@given(bodies())
def test_the_same_body(a: trimesh.Trimesh) -> None:
    got = metrics.compare(a, a)
    assert got["dice"] == pytest.approx(1.0, abs=1e-5)
    assert got["surface_distance"] < 1e-9
    assert got["hd95"] < 1e-9
    assert got["volume_difference"] == 0.0


@settings(max_examples=6, deadline=None)
@given(bodies(), bodies())
def test_both_ways_to_dice_agree(a: trimesh.Trimesh, b: trimesh.Trimesh) -> None:
    exact = metrics.dice(a, b)
    assert metrics.dice(a, b, method="winding", spacing=0.5e-3) == pytest.approx(exact, abs=3e-3)


def test_registry() -> None:
    assert list(metrics.METRICS) == ["surface_distance", "hd95", "dice", "volume_difference"]
    box = trimesh.creation.box((0.02, 0.02, 0.1))
    got = metrics.compare(box, box)
    assert list(got) == list(metrics.METRICS)
    assert {m.name: m.unit for m in metrics.METRICS.values()}["hd95"] == "m"
    assert [m.name for m in metrics.METRICS.values() if m.higher_is_better] == ["dice"]


@pytest.mark.parametrize("name", ["surface_distance", "hd95", "dice", "volume_difference"])
def test_open_surfaces_are_refused_by_all(name: str) -> None:
    box = trimesh.creation.box((0.02, 0.02, 0.1))
    opened = trimesh.Trimesh(box.vertices, box.faces[1:], process=False)
    with pytest.raises(InputError, match="measured body"):
        metrics.METRICS[name].compute(box, opened)
