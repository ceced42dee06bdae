"""Surface distances and HD95 against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.integrate import quad

from calibration.metrics import hd95, point_to_surface, surface_distance, surface_points, volume_difference


def cylinder(radius: float, *, sections: int = 256) -> trimesh.Trimesh:
    return trimesh.creation.cylinder(radius=radius, height=0.1, sections=sections)


def test_point_to_surface_is_exact_below_a_tenth_of_a_millimetre() -> None:
    """trimesh's own proximity query, in metres, is not exact there."""
    rod = trimesh.creation.box((0.02, 0.02, 0.1)).subdivide().subdivide().subdivide()
    points = np.random.default_rng(1).uniform(-1, 1, (200, 3)) * [0.0099, 0.0099, 0.0499]
    true = (np.array([0.01, 0.01, 0.05]) - np.abs(points)).min(axis=1)
    assert point_to_surface(points, rod) == pytest.approx(true, abs=1e-12)


def test_surface_points_are_spread_by_area() -> None:
    box = trimesh.creation.box((0.02, 0.04, 0.10))
    points = surface_points(box)
    assert point_to_surface(points, box).max() < 1e-12
    total = 2 * (2 * 4 + 2 * 10 + 4 * 10)
    for axis, half, area in ((0, 0.01, 40), (1, 0.02, 20), (2, 0.05, 8)):
        on = np.abs(points[:, axis] - half) < 1e-12
        assert on.mean() == pytest.approx(area / total, abs=2e-3)
        assert points[on].mean(axis=0) == pytest.approx(np.eye(3)[axis] * half, abs=3e-4)


def test_concentric_spheres() -> None:
    outer, inner = (trimesh.creation.icosphere(subdivisions=5, radius=r) for r in (0.010, 0.008))
    assert surface_distance(outer, inner) == pytest.approx(0.002, rel=2e-3)
    assert hd95(outer, inner) == pytest.approx(0.002, rel=2e-3)
    assert volume_difference(inner, outer) == pytest.approx(1 - 0.8**3, rel=1e-9)
    assert volume_difference(outer, inner) == pytest.approx(1 / 0.8**3 - 1, rel=1e-9)


def test_concentric_cylinders() -> None:
    """With coplanar caps, the inner side is nearer to the outer caps than to the outer side near its ends."""
    R, r, L = 0.010, 0.008, 0.1
    d = R - r
    ring = 2 * np.pi * quad(lambda rho: (rho - r) * rho, r, R)[0]
    outwards = (2 * np.pi * R * L * d + 2 * ring) / (2 * np.pi * R * (L + R))
    inwards = 2 * np.pi * r * (L * d - d**2) / (2 * np.pi * r * (L + r))
    assert surface_distance(cylinder(r), cylinder(R)) == pytest.approx((outwards + inwards) / 2, rel=2e-3)
    assert hd95(cylinder(r), cylinder(R)) == pytest.approx(d, rel=2e-3)


@pytest.mark.parametrize("shift", [0.00079, 0.003])
def test_cylinder_displaced_sideways(shift: float) -> None:
    """On the side the distance is |distance to the other axis - R|; the caps stay in their planes."""
    R, L = 0.010, 0.1

    def gap(rho: float, phi: float) -> float:
        return float(np.hypot(rho * np.cos(phi) - shift, rho * np.sin(phi)) - R)

    # inside the other cylinder the plane of a cap may be nearer, within g of either end
    side = quad(lambda phi: abs(gap(R, phi)) - max(-gap(R, phi), 0.0) ** 2 / L, 0, np.pi)[0] / np.pi
    grid_rho, grid_phi = np.meshgrid((np.arange(400) + 0.5) / 400 * R, (np.arange(400) + 0.5) / 400 * np.pi)
    outside = np.maximum(np.hypot(grid_rho * np.cos(grid_phi) - shift, grid_rho * np.sin(grid_phi)) - R, 0.0)
    cap = (outside * grid_rho).sum() / grid_rho.sum()
    true = (side * L + cap * R) / (L + R)
    other = cylinder(R).apply_translation((shift, 0.0, 0.0))
    assert surface_distance(cylinder(R), other) == pytest.approx(true, rel=3e-3)
    assert side == pytest.approx(2 * shift / np.pi, rel=0.02)  # equals R (1 - Dice)


def test_hd95_is_the_larger_direction() -> None:
    """A box against one that is 10 mm longer.

    4.2 % of the longer box's area is its end face, 10 mm away, and the next 0.8 % reach 1 mm along its sides;
    only 4.5 % of the shorter box's area is away from the longer one. Ten of 8,192 points correspond to 0.15
    mm of the sides.
    """
    short = trimesh.creation.box((0.02, 0.02, 0.1))
    long = trimesh.creation.box((0.02, 0.02, 0.11)).apply_translation((0, 0, 0.005))
    assert hd95(short, long) == pytest.approx(0.009, abs=1.5e-4)
    assert hd95(long, short) == pytest.approx(0.009, abs=1.5e-4)


def test_a_mesh_changed_in_place_is_measured_anew() -> None:
    a, b = cylinder(0.01, sections=64), cylinder(0.009, sections=64)
    before = surface_distance(a, b)
    b.apply_scale(0.9)
    assert surface_distance(a, b) > 1.5 * before


def test_figures_can_be_made_again() -> None:
    a, b = cylinder(0.01, sections=64), cylinder(0.009, sections=64)
    assert surface_distance(a, b) == surface_distance(a, b)
    assert surface_distance(a, b, seed=1) != surface_distance(a, b, seed=2)
    assert surface_distance(a, b, seed=1) == pytest.approx(surface_distance(a, b, seed=2), rel=1e-3)


# values of VTK's cell locator (pyvista 0.46: find_closest_cell of each point), which was used earlier
BY_VTK = {
    ("box", "rod"): (0.0017092104217383793, 0.004912090162183505),
    ("ball", "far"): (0.03267246941445546, 0.048562905866707584),
    ("rod", "ball"): (0.010235190407971126, 0.030547653594728122),
}


@pytest.mark.parametrize("pair", BY_VTK, ids="-".join)
def test_distances_are_those_of_vtk(pair: tuple[str, str]) -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.02)
    rod = trimesh.creation.cylinder(radius=0.01, height=0.1, sections=64)
    bodies = {
        "box": trimesh.creation.box((0.02, 0.02, 0.1)),
        "rod": rod.apply_translation((0.001, 0.002, 0.0)),
        "ball": ball,
        "far": ball.copy().apply_translation((0.05, 0.0, 0.0)),
    }
    first, second = (bodies[name] for name in pair)
    assert surface_distance(first, second) == pytest.approx(BY_VTK[pair][0], rel=1e-12)
    assert hd95(first, second) == pytest.approx(BY_VTK[pair][1], rel=1e-12)


def test_triangles_of_all_sizes_are_searched() -> None:
    """Against samples of every triangle: long caps, small facets, one without area."""
    rod = cylinder(0.01, sections=64).subdivide()
    flat = np.vstack([rod.faces, [[0, 0, 1]]])
    surface = trimesh.Trimesh(rod.vertices, flat, process=False)
    points = np.random.default_rng(2).uniform(-0.06, 0.06, (40, 3))
    grid = np.linspace(0.0, 1.0, 41)
    u, v = (x[np.add.outer(grid, grid) <= 1.0 + 1e-12] for x in np.meshgrid(grid, grid, indexing="ij"))
    a, b, c = (np.asarray(rod.triangles)[:, m] for m in range(3))
    for point, found in zip(points, point_to_surface(points, surface), strict=True):
        spread = a[:, None] + u[:, None] * (b - a)[:, None] + v[:, None] * (c - a)[:, None]
        sampled = np.linalg.norm(spread - point, axis=2).min()
        assert found <= sampled + 1e-12
        assert found > sampled - 1e-3  # resolution of the samples
