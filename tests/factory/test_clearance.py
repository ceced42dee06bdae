"""A rod that is inside an inclusion or the base is found, whatever its tip, its direction and the block."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from numpy.typing import NDArray

from factory import open_dataset, verify_dataset
from factory.checks.clearance import SPACING, gaps_of, rod_points
from factory.simulation.record import unit
from factory.store.files import write_manifest
from factory.verify import app
from tests.factory.conftest import run_app

CHECK = "indenter outside rigid bodies"
FLAT = {"radius_mm": 2.5, "tip": "flat", "edge_radius_mm": 1.0}
BALL = {"radius_mm": 2.5, "tip": "hemisphere", "edge_radius_mm": 1.0}


def _edit(store: Path, **changes: Callable[[NDArray[Any]], NDArray[Any]]) -> None:
    """Change arrays of a store, and write the checksums that belong to it."""
    group: Any = zarr.open_group(store=store, mode="r+")
    for name, change in changes.items():
        group[name][...] = change(group[name][...])
    write_manifest(store)


def _one_frame(store: Path, index: int, tip: tuple[float, float, float], axis: NDArray[np.float64]) -> int:
    """Put the rod of a poke's last frame somewhere else; return the frame's number."""
    rows = open_dataset(store).rows(index, "frame")

    def placed(values: NDArray[Any], value: object) -> NDArray[Any]:
        values[rows.stop - 1] = value
        return values

    _edit(store, rod_tip=lambda v: placed(v, tip), rod_axis=lambda v: placed(v, axis))
    return rows.stop - rows.start - 1


def test_a_sound_store_has_no_fault(finished_store: Path, quick_store: Path) -> None:
    for store in (finished_store, quick_store):
        assert verify_dataset(store).faults[CHECK] == []
        data = open_dataset(store)
        for index in range(data.n_pokes):
            gaps = gaps_of(data, index)
            # the tip of a rod that is pushed in comes nearer to the base, frame by frame
            assert (np.diff(gaps["base"]) < 0).all()
            assert (gaps["inclusion"] > 0).all()


@pytest.mark.parametrize(("rod", "bottom"), [(FLAT, 1.5e-3), (BALL, 0.0)])
def test_points_are_on_the_rods_surface(rod: dict[str, Any], bottom: float) -> None:
    points = rod_points(rod, 0.01)
    away, up = np.hypot(points[:, 0], points[:, 1]), -points[:, 2]
    edge = 2.5e-3 - bottom
    rounded = (up < edge - 1e-9) & (away > bottom + 1e-9)
    np.testing.assert_allclose(np.hypot(away - bottom, up - edge)[rounded], edge, atol=1e-12)
    assert (np.isclose(up, 0.0) == (away < bottom + 1e-9)).all()
    np.testing.assert_allclose(away[up > edge - 1e-9], 2.5e-3, atol=1e-12)
    assert (up.min(), up.max()) == pytest.approx((0.0, 0.01))
    # none of its surface is farther from a point than the spacing
    chosen = points[np.random.default_rng(2).choice(len(points), 300)]
    distance = np.linalg.norm(points - chosen[:, None], axis=2)
    assert (np.sort(distance, axis=1)[:, 1] < 1.001 * SPACING).all()


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_the_gap_above_a_cube_and_the_base_is_the_closed_form(store: Path, angle: float) -> None:
    """Of the cube of 18 mm below; the lowest point of an inclined tip is on its rounded edge."""
    turn = math.radians(angle)
    axis = unit((math.sin(turn), 0.0, -math.cos(turn)))
    data = open_dataset(store)
    centre = data.inclusion(0).centre
    frame = _one_frame(store, 0, (centre[0], centre[1], 0.025), axis)
    lowest = 0.025 - 1.5e-3 * math.sin(turn) + 1e-3 * (math.cos(turn) - 1.0)
    gaps = gaps_of(open_dataset(store), 0)
    assert gaps["inclusion"][frame] == pytest.approx(lowest - 0.018, abs=2e-6)
    assert gaps["base"][frame] == pytest.approx(lowest, abs=2e-6)


def test_a_rod_in_the_inclusion_is_found(store: Path) -> None:
    """Its tip is on the axis of the cube of 18 mm, 0.4 mm below its top."""
    data = open_dataset(store)
    centre = data.inclusion(0).centre
    frame = _one_frame(store, 1, (centre[0], centre[1], 0.0176), np.array([0.0, 0.0, -1.0]))
    depth = data.poke(1).depth[frame] * 1e3
    fault = f"poke 1, frame {frame} at {depth:.4g} mm: the indenter is 0.4 mm inside the inclusion"
    verified = run_app(app, store)
    assert verified.exit_code == 1
    assert f"{CHECK}: {fault}\n" in verified.output
    assert verify_dataset(store).faults[CHECK] == [fault]


def test_a_rod_in_the_base_is_found(store: Path) -> None:
    frame = _one_frame(store, 2, (0.04, 0.04, -0.0012), np.array([0.0, 0.0, -1.0]))
    verified = run_app(app, store)
    assert verified.exit_code == 1
    assert f"{CHECK}: poke 2, frame {frame} at " in verified.output
    assert "mm: the indenter is 1.2 mm inside the base\n" in verified.output


def test_a_shaft_that_leans_through_the_inclusion_is_found(store: Path) -> None:
    """The tip is beside the cube, at half of its height."""
    data = open_dataset(store)
    inclusion = data.inclusion(0)
    tip = (inclusion.centre[0] + 0.016, inclusion.centre[1], 0.009)
    assert inclusion.signed_distance(tip) > 2e-3
    leaning = unit((1.0, 0.0, -1.0))
    frame = _one_frame(store, 0, tip, leaning)
    assert gaps_of(open_dataset(store), 0)["inclusion"][frame] < 0.0
    upright = np.array([0.0, 0.0, -1.0])
    _one_frame(store, 0, tip, upright)
    assert gaps_of(open_dataset(store), 0)["inclusion"][frame] > 0.0


def test_an_inclusion_that_reaches_the_rod_is_found(store: Path) -> None:
    """A cube of nearly the block's height in place of the one that was simulated."""
    _edit(
        store,
        inclusion_size=lambda v: v * [5.0, 5.0, 29.5 / 18.0],
        inclusion_centre=lambda v: v * [1.0, 1.0, 29.5 / 18.0],
    )
    data = open_dataset(store)
    faults = verify_dataset(store).faults[CHECK]
    assert [fault.partition(",")[0] for fault in faults] == [f"poke {index}" for index in range(data.n_pokes)]
    gaps = gaps_of(data, 3)["inclusion"] * 1e3
    first = int(np.argmax(gaps <= 0.0))
    later = len(gaps) - first - 1
    assert gaps[0] > 0.0
    assert faults[3] == (
        f"poke 3, frame {first} at {first + 1} mm: "
        f"the indenter is {-gaps[first]:.2g} mm inside the inclusion, as in {later} more frames, "
        f"up to {-gaps[-1]:.2g} mm"
    )


@pytest.mark.parametrize(("name", "factor"), [("rod_axis", 0.0), ("rod_axis", 1.01), ("rod_tip", np.nan)])
def test_a_pose_that_is_none_is_a_fault(name: str, factor: float, store: Path) -> None:
    _edit(store, **{name: lambda v: v * factor})
    faults = verify_dataset(store).faults[CHECK]
    assert len(faults) == 4
    assert faults[2] == "poke 2: rod_tip and rod_axis: expected finite positions and unit vectors"
