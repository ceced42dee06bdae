"""Grid, profiles, surfaces and first touch against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from factory.sampling import (
    LEVELS,
    SIZE,
    grid_points,
    interpolation,
    level_depths,
    profiles,
    surface_triangles,
)
from factory.simulation.record import first_touch
from tests.factory.standin import block_mesh
from tisim.bodies import BoxInclusion, CylinderInclusion, Rod, SphereInclusion
from tisim.material import Material
from tisim.scene import Poke

BLOCK = (0.1, 0.1, 0.032)
LINEAR = np.array([[0.3, -0.2, 0.1], [0.05, 0.4, -0.7], [0.2, 0.1, 0.9]])


def _skewed_top(seed: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """A 9 x 9 net of skewed convex quads over the top, some of them split into degenerate quads."""
    random = np.random.default_rng(seed)
    n, line = 9, np.linspace(-0.05, 0.05, 10)
    x, y = np.meshgrid(line, line, indexing="ij")
    nodes = np.stack([x, y, np.full_like(x, 0.032)], axis=-1)
    nodes[1:-1, 1:-1, :2] += random.uniform(-0.0025, 0.0025, (n - 1, n - 1, 2))
    index = np.arange(100).reshape(10, 10)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    facets = []
    for a, b, c, d in quads:
        kind = random.integers(6)
        if kind >= 4:
            facets.append((a, b, c, d))
        else:  # a triangle may repeat any node and start at any node
            for p, q, r in ((a, b, c), (a, c, d)):
                facets.append(((p, p, q, r), (p, q, q, r), (p, q, r, r), (p, q, r, p))[kind])
    return nodes.reshape(-1, 3), np.array(facets, dtype=np.int32)


@given(st.integers(0, 10_000))
def test_interpolation_is_exact_for_linear_fields(seed: int) -> None:
    nodes, facets = _skewed_top(seed)
    points = grid_points(BLOCK).reshape(-1, 3)[seed % 3 :: 3]
    at = interpolation(nodes, facets, points)
    np.testing.assert_allclose(at(nodes @ LINEAR + 1.0), points @ LINEAR + 1.0, atol=1e-12)
    np.testing.assert_allclose(at.weights.sum(axis=1), 1, atol=1e-12)
    assert at.weights.min() > -1e-6


def test_interpolation_between_nodes_is_bilinear() -> None:
    nodes = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    values = np.zeros((2, 4, 3))
    values[1, 2] = 1.0  # the second of two frames
    at = interpolation(nodes, np.array([[0, 1, 2, 3]], dtype=np.int32), np.array([[1.5, 0.5, 0]]))
    np.testing.assert_allclose(at(values)[:, 0, 0], [0, 0.75 * 0.25])


def test_interpolation_of_six_node_triangles_is_quadratic() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    middles = (corners + corners[[1, 2, 0]]) / 2
    nodes = np.concatenate([corners, middles])
    points = np.array([[0.2, 0.3, 0], [0.5, 0.1, 0]])
    at = interpolation(nodes, np.arange(6, dtype=np.int32)[None], points)

    def field(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([x[:, 0] ** 2, x[:, 0] * x[:, 1], 1 - x[:, 1] ** 2], axis=1)

    np.testing.assert_allclose(at(field(nodes)), field(points), atol=1e-14)


def _with_middles(
    nodes: NDArray[np.float64], facets: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Quads of eight nodes; the mid-side node of a collapsed edge is its corner."""
    ends = np.sort(np.stack([facets, np.roll(facets, -1, axis=1)], axis=-1), axis=-1)
    edges, place = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    middles = np.where(ends[..., 0] == ends[..., 1], ends[..., 0], len(nodes) + place.reshape(-1, 4))
    return np.concatenate([nodes, nodes[edges].mean(axis=1)]), np.hstack([facets, middles]).astype(np.int32)


@given(st.integers(0, 10_000))
def test_eight_node_quads_are_exact_for_linear_fields_collapsed_or_not(seed: int) -> None:
    nodes, facets = _with_middles(*_skewed_top(seed))
    points = grid_points(BLOCK).reshape(-1, 3)[seed % 3 :: 3]
    at = interpolation(nodes, facets, points)
    np.testing.assert_allclose(at(nodes @ LINEAR + 1.0), points @ LINEAR + 1.0, atol=1e-10)


def test_interpolation_of_eight_node_quads_is_quadratic() -> None:
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    nodes, facets = _with_middles(corners, np.arange(4, dtype=np.int32)[None])
    points = np.array([[0.2, 1.3, 0], [1.5, 0.1, 0]])

    def field(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([x[:, 0] ** 2, x[:, 0] * x[:, 1], 1 - x[:, 1] ** 2], axis=1)

    np.testing.assert_allclose(interpolation(nodes, facets, points)(field(nodes)), field(points), atol=1e-12)


def test_an_eight_node_quad_becomes_six_triangles_that_cover_it() -> None:
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    nodes, facets = _with_middles(corners, np.array([[0, 1, 2, 3]], dtype=np.int32))
    used, triangles = surface_triangles(facets)
    a, b, c = np.swapaxes(nodes[used][triangles], 0, 1)
    area = 0.5 * np.cross(b - a, c - a)
    assert len(triangles) == 6
    assert (area[:, 2] > 0.0).all()
    assert area.sum(axis=0) == pytest.approx([0.0, 0.0, 4.0])


def test_a_point_outside_the_face_is_an_error() -> None:
    nodes, facets = _skewed_top(1)
    with pytest.raises(ValueError, match="no facet"):
        interpolation(nodes, facets, np.array([[0.0, 0.0, 0], [0.06, 0.0, 0]]))
    hole = np.delete(facets, 40, axis=0)
    with pytest.raises(ValueError, match="no facet"):
        interpolation(nodes, hole, nodes[facets[40]].mean(axis=0)[None])


def test_grid_points_are_the_middles_of_equal_cells() -> None:
    points = grid_points((0.2, 0.1, 0.03))
    assert points.shape == (SIZE, SIZE, 3)
    np.testing.assert_allclose(points[0, 0], [-0.1 + 0.1 / 32, -0.05 + 0.05 / 32, 0.03])
    np.testing.assert_allclose(points[3, 5] - points[3, 4], [0.2 / 32, 0, 0], atol=1e-15)  # columns: x
    np.testing.assert_allclose(points[4, 5] - points[3, 5], [0, 0.1 / 32, 0], atol=1e-15)  # rows: y


INCLUSIONS = [
    BoxInclusion(size=(0.02, 0.03, 0.018), centre=(0.004, -0.003, 0.009), angle=0.7),
    SphereInclusion(radius=0.011, centre=(-0.01, 0.012, 0.009)),
    CylinderInclusion(radius=0.009, height=0.014, centre=(0.02, 0.01, 0.007)),
]


@pytest.mark.parametrize("inclusion", INCLUSIONS, ids=["box", "sphere", "cylinder"])
def test_profiles_reach_the_analytic_top(inclusion: BoxInclusion) -> None:
    """Below each grid point the rigid part begins at the depth given by the inclusion's closed form."""
    grid = grid_points(BLOCK)
    levels = profiles(grid, BLOCK[2], inclusion, 0.4)
    assert levels.shape == (SIZE, SIZE, LEVELS)
    assert set(np.unique(levels)) == {102, 255}
    depths = level_depths(BLOCK[2])
    d = grid[..., :2] - np.array(inclusion.centre[:2])
    if isinstance(inclusion, SphereInclusion):
        half = np.sqrt(np.maximum(inclusion.radius**2 - (d**2).sum(-1), 0))
        under = (d**2).sum(-1) < inclusion.radius**2
    elif isinstance(inclusion, CylinderInclusion):
        half = np.full((SIZE, SIZE), inclusion.height / 2)
        under = (d**2).sum(-1) < inclusion.radius**2
    else:
        turn = complex(math.cos(-inclusion.angle), math.sin(-inclusion.angle))
        local = (d[..., 0] + 1j * d[..., 1]) * turn
        half = np.full((SIZE, SIZE), inclusion.size[2] / 2)
        under = (np.abs(local.real) < inclusion.size[0] / 2) & (np.abs(local.imag) < inclusion.size[1] / 2)
    top = BLOCK[2] - (inclusion.centre[2] + half)  # depth of its top
    bottom = BLOCK[2] - (inclusion.centre[2] - half)
    expected = under[..., None] & (depths > top[..., None]) & (depths < bottom[..., None])
    np.testing.assert_array_equal(levels == 255, expected)
    assert expected.any()


def test_volume_of_the_inclusions() -> None:
    random = np.random.default_rng(0)
    points = random.uniform(-0.05, 0.05, (200_000, 3))
    volumes = [0.02 * 0.03 * 0.018, 4 / 3 * math.pi * 0.011**3, math.pi * 0.009**2 * 0.014]
    for inclusion, volume in zip(INCLUSIONS, volumes, strict=True):
        found = replace(inclusion, centre=(0.0, 0.0, 0.0)).contains(points).mean() * 0.1**3
        assert found == pytest.approx(volume, rel=0.05)


@pytest.mark.parametrize("code", [0.8, 0.4, 0.0, 1.0])
def test_stiffness_codes_are_exact_in_a_byte(code: float) -> None:
    assert round(255 * code) / 255 == pytest.approx(code, abs=1e-15)


def test_surface_is_closed_and_outward() -> None:
    mesh = block_mesh(BLOCK, (3, 4, 2))
    nodes, triangles = surface_triangles(mesh.facet_sets["surface"])
    corners = mesh.nodes[nodes][triangles]
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(np.prod(BLOCK))
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forward = {tuple(edge) for edge in edges}
    assert len(forward) == len(edges)
    assert all((b, a) in forward for a, b in forward)


def test_surface_of_degenerate_quads_and_of_six_node_triangles() -> None:
    _, triangles = surface_triangles(np.array([[4, 4, 7, 9], [4, 7, 9, 9]], dtype=np.int32))
    assert triangles.tolist() == [[0, 1, 2], [0, 1, 2]]
    nodes, triangles = surface_triangles(np.arange(6, dtype=np.int32)[None])
    flat = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])[nodes]
    corners = flat[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    np.testing.assert_allclose(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], 0.25)


@given(st.floats(0, 45), st.floats(0, 360), st.sampled_from(["flat", "hemisphere"]))
def test_first_touch_puts_the_rods_lowest_point_on_the_top(angle: float, heading: float, tip: str) -> None:
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    direction = np.array(
        [sine * math.cos(math.radians(heading)), sine * math.sin(math.radians(heading)), -cosine]
    )
    material = Material(law="ogden", parameters={})
    rod = Rod(radius=0.0025, edge_radius=0.001, tip="hemisphere" if tip == "hemisphere" else "flat")
    poke = Poke(material=material, site=(0.01, -0.02), direction=tuple(direction), rod=rod)
    centre = first_touch(poke)
    # points of the tip: a disc with its rounded edge, or a hemisphere
    t = np.linspace(0, math.pi / 2, 2001)
    if tip == "flat":
        radial, back = 0.0015 + 0.001 * np.sin(t), 0.001 * (1 - np.cos(t))
    else:
        radial, back = 0.0025 * np.sin(t), 0.0025 * (1 - np.cos(t))
    lowest = (centre[2] - back * direction[2] - radial * sine).min()
    assert lowest == pytest.approx(0.032, abs=1e-8)
    # and the axis meets the undeformed surface at the contact point
    reach = (0.032 - centre[2]) / direction[2]
    np.testing.assert_allclose(centre + reach * direction, [0.01, -0.02, 0.032], atol=1e-12)
