"""Eight-node facets of the stored surface: found again in its triangles, and exact between the nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from factory.sampling import surface_triangles
from learn.data import Store, open_store
from learn.data._facets import eight_node_facets, facet_weights
from learn.data.clouds import SurfaceField
from tests.learn.small_store import write_store

# three facets side by side: a square, a skewed one, and one whose edge (2, 3) is collapsed to a point
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.2, -0.3], [1.8, 1.4], [3.0, 0.6]])
SQUARE, SKEWED, COLLAPSED = [0, 1, 2, 3], [1, 4, 5, 2], [4, 6, 5, 5]


def _mesh() -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Positions (m, 2) and facets (3, 8), with middle nodes; the last facet has one node for an edge."""
    xy, facets, number = list(CORNERS), [], {}
    for corners in (SQUARE, SKEWED, COLLAPSED):
        middle = []
        for a, b in zip(corners, np.roll(corners, -1), strict=True):
            edge = tuple(sorted((int(a), int(b))))
            if a != b and edge not in number:
                number[edge] = len(xy)
                xy.append((CORNERS[a] + CORNERS[b]) / 2)
            middle.append(int(a) if a == b else number[edge])
        facets.append([*corners, *middle])
    return np.array(xy), np.array(facets, dtype=np.int32)


def test_facets_are_found_in_the_triangles_that_the_factory_stores() -> None:
    _, facets = _mesh()
    used, triangles = surface_triangles(facets)
    assert len(triangles) == 6 + 6 + 4
    found = used[eight_node_facets(triangles)]
    np.testing.assert_array_equal(found, facets)


def test_a_surface_of_triangles_has_no_such_facets() -> None:
    triangles = np.array([[0, 1, 2], [0, 2, 3], [2, 1, 4], [4, 5, 2]])
    assert eight_node_facets(triangles).shape == (0, 8)
    assert eight_node_facets(triangles[:2]).shape == (0, 8)


def test_weights_reproduce_fields_of_the_element() -> None:
    """Linear fields in each facet, quadratic ones in a parallelogram; none outside."""
    xy, facets = _mesh()
    random = np.random.default_rng(0)
    points = random.uniform([-0.5, -0.5], [3.2, 1.6], (400, 2))
    inside, nodes, weights = facet_weights(xy, facets.astype(np.int64), points)
    in_square = (np.abs(points - 0.5) <= 0.5).all(axis=1)
    assert inside[in_square].all()
    assert not inside[(points[:, 0] < 0) | (points[:, 0] > 3)].any()
    outline = CORNERS[[0, 1, 4, 6, 5, 2, 3]]
    x, y = outline.T
    area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    assert inside.mean() == pytest.approx(area / (3.7 * 2.1), abs=0.06)
    np.testing.assert_allclose(np.einsum("nk,nkc->nc", weights, xy[nodes])[inside], points[inside], atol=1e-9)
    np.testing.assert_allclose(weights[inside].sum(axis=1), 1.0, atol=1e-12)

    def quadratic(p: NDArray[np.float64]) -> NDArray[np.float64]:
        return 1 + p[..., 0] ** 2 - 3 * p[..., 0] * p[..., 1] + 2 * p[..., 1] ** 2

    found = (weights * quadratic(xy[nodes])).sum(axis=1)
    np.testing.assert_allclose(found[in_square], quadratic(points[in_square]), atol=1e-9)
    assert not weights[~inside].any()


def test_a_store_of_such_facets_is_interpolated_by_their_shape_functions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A facet of the grid's nodes bends by its middle nodes; the same triangles in another order do not."""
    store = open_store(write_store(tmp_path / "s.zarr", sites=1, frames=1))
    rest, _, _ = store.surface(0)
    at = [k * 32 + j for k, j in ((0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0))]
    split = np.array([[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]])
    moved = np.zeros((1, len(rest), 3), dtype=np.float32)
    moved[0, :, 2] = 1e4 * (rest[:, 0] - rest[0, 0]) ** 2
    inner = (rest[at[0]] + 0.3 * (rest[at[2]] - rest[at[0]]))[None]
    exact = 1e4 * (inner[0, 0] - rest[0, 0]) ** 2
    for order, exactly in (([0, 1, 2, 3, 4, 5], True), ([1, 0, 2, 3, 4, 5], False)):
        triangles = np.array(at)[split[order]].astype(np.int32)
        monkeypatch.setattr(Store, "surface", lambda *_, t=triangles: (rest, t, moved))
        found = SurfaceField(store, [0]).displacement(np.array([0]), inner)[0, 0, 2]
        assert bool(abs(found / exact - 1) < 1e-5) is exactly
