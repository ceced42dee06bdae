"""Figures are drawn without pyplot: a notebook keeps its backend and shows a figure once."""

from __future__ import annotations

import base64
import runpy

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from learn.evaluation import pictures


def test_a_notebooks_backend_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(matplotlib.rcParams, "backend", "svg")
    module = runpy.run_path(str(pictures.__file__))
    figure = module["draw_learning"]({"run": [{"epoch": 0, "train_loss": 1.0}]})
    assert base64.b64decode(module["encoded"](figure)).startswith(b"\x89PNG")
    assert matplotlib.rcParams["backend"] == "svg"
    assert not hasattr(figure, "number")  # pyplot numbers the figures that it shows


def test_a_pixel_of_a_map_lies_on_its_point() -> None:
    figure = Figure()
    axis = figure.subplots()
    points = [-48.0, 48.0, -72.0, 72.0]
    pictures._map(figure, axis, np.ones((4, 5)), points, "u", np.zeros(3), "viridis", None)
    x0, x1, y0, y1 = axis.images[0].get_extent()
    np.testing.assert_allclose(x0 + (np.arange(5) + 0.5) * (x1 - x0) / 5, np.linspace(-48, 48, 5))
    np.testing.assert_allclose(y0 + (np.arange(4) + 0.5) * (y1 - y0) / 4, np.linspace(-72, 72, 4))


@pytest.mark.parametrize("size", [0.1, 0.24])
def test_a_cut_has_points_on_a_block_of_any_size(size: float) -> None:
    side = ((np.arange(32) + 0.5) / 32 - 0.5) * size
    points = np.stack([*np.meshgrid(side, 0.5 * side), np.zeros((32, 32))], axis=-1).reshape(-1, 3)
    for angle in np.linspace(0.0, 3.0, 7):
        across = points[:, :2] @ [-np.sin(angle), np.cos(angle)]
        assert (np.abs(across) < pictures._strip(points)).sum() >= 16


@pytest.mark.parametrize("heading_deg", [0.0, 40.0, 90.0])
def test_a_section_of_the_inclusion_has_no_gaps(heading_deg: float) -> None:
    """A rigid cylinder of 10 mm radius, 8 to 12 mm below the top: a rectangle in every vertical plane."""
    side = ((np.arange(32) + 0.5) / 32 - 0.5) * 0.1
    points = np.stack([*np.meshgrid(side, side), np.zeros((32, 32))], axis=-1).reshape(-1, 3)
    levels = (np.arange(128) + 0.5) / 128 * 0.032
    rigid = (np.hypot(*points[:, :2].T) <= 10e-3)[:, None] & (np.abs(levels - 10e-3) <= 2e-3)
    turn = np.radians(heading_deg)
    heading = np.array([np.cos(turn), np.sin(turn)])
    ahead, upper, lower = pictures._section(points, rigid, levels, np.zeros(3), heading)
    hit = np.isfinite(upper)
    np.testing.assert_array_equal(hit, np.abs(ahead) <= np.abs(ahead[hit]).max())
    assert np.abs(ahead[hit]).max() == pytest.approx(10e-3, abs=2.3e-3)  # half a diagonal of a cell
    np.testing.assert_allclose(upper[hit], 8e-3, rtol=1e-9)
    np.testing.assert_allclose(lower[hit], 12e-3, rtol=1e-9)


def test_a_section_ends_where_the_block_does() -> None:
    side = ((np.arange(32) + 0.5) / 32 - 0.5) * 0.1
    points = np.stack([*np.meshgrid(side, side), np.zeros((32, 32))], axis=-1).reshape(-1, 3)
    levels = (np.arange(128) + 0.5) / 128 * 0.032
    rigid = np.ones((len(points), len(levels)), dtype=bool)
    ahead, upper, _ = pictures._section(points, rigid, levels, np.array([0.04, 0, 0]), np.array([1.0, 0]))
    assert ahead[np.isfinite(upper)].max() == pytest.approx(10e-3, abs=0.3e-3)
