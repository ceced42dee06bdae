"""Distances between surfaces: mean and 95th percentile, over points spread by area; the same of vertices.

`vertex_distance` and `vertex_hd95` take nodes for a surface. They are here to reproduce published figures
(studies/metrics), not to judge a fit: with the nodes of a volume mesh they are far from zero for two
identical bodies.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from calibration.metrics._metric import Metric, check_body

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

SAMPLES_LOG2 = 13  # 8,192 points a direction
SEED = 20  # of the scrambling; fixed, so that a figure can be made again


@lru_cache(maxsize=1)  # a mesh hashes by its content, so a changed mesh is a new pair
def both_ways(
    first: trimesh.Trimesh, second: trimesh.Trimesh, *, samples_log2: int, seed: int
) -> tuple[Array, Array]:
    """Distances [m] of points on the first surface to the second one, and the other way round (read only).

    The last pair is remembered: two metrics ask for the same distances.
    """
    there = point_to_surface(surface_points(first, samples_log2=samples_log2, seed=seed), second)
    back = point_to_surface(surface_points(second, samples_log2=samples_log2, seed=seed), first)
    there.flags.writeable = back.flags.writeable = False
    return there, back


def surface_points(mesh: trimesh.Trimesh, *, samples_log2: int = SAMPLES_LOG2, seed: int = SEED) -> Array:
    """2**samples_log2 points spread evenly by area over a surface, (n, 3) [m].

    Sobol points (scrambled with `seed`) choose the triangle, in proportion to its area, and the place in it:
    independent draws would leave ten times more noise in a mean.
    """
    from scipy.stats import qmc  # imported when needed: scipy.stats takes half a second

    draw = qmc.Sobol(d=3, rng=np.random.default_rng(seed)).random_base2(samples_log2)
    area = np.cumsum(mesh.area_faces)
    which = np.minimum(np.searchsorted(area, draw[:, 0] * area[-1]), len(area) - 1)
    u = np.sqrt(draw[:, 1])[:, None]
    v = draw[:, 2][:, None]
    a, b, c = (np.asarray(mesh.triangles)[which, m] for m in range(3))
    return np.asarray((1 - u) * a + u * (1 - v) * b + u * v * c)


def point_to_surface(points: Array, surface: trimesh.Trimesh) -> Array:
    """Distance of each point to the nearest place on a surface, exact to rounding.

    A tree of boxes about the triangles is descended for all points at once, by the pairs of point and box
    that are not further apart than the best distance known so far. (trimesh's closest_point takes squared
    distances within 1e-8 for equal, which at our size in metres is wrong by up to 0.1 mm.)

    Parameters
    ----------
    points : array, shape (n, 3) [m]
    surface : trimesh.Trimesh

    Returns
    -------
    array, shape (n,) [m]
    """
    points = np.asarray(points, dtype=float)
    triangles = np.asarray(surface.triangles, dtype=float)
    centres = triangles.mean(axis=1)
    _, nearest = cKDTree(centres).query(points)
    squares = _squared_distance(points, triangles[nearest])
    order, levels = _boxes(centres, triangles.min(axis=1), triangles.max(axis=1))
    axes = np.ascontiguousarray(points.T)
    first = min(3, len(levels) - 1)  # above it next to no box is left out
    for rows in np.array_split(np.arange(len(points)), max(1, len(points) // 1024)):
        at, box = np.repeat(rows, 2**first), np.tile(np.arange(2**first), len(rows))
        for level in range(first, len(levels)):
            if level > first:
                at, box = np.repeat(at, 2), np.repeat(2 * box, 2)
                box[1::2] += 1
            room = squares[at]
            for place, (low, high) in zip(axes, levels[level], strict=True):
                w = place[at]
                room -= np.maximum(np.maximum(low[box] - w, w - high[box]), 0.0) ** 2
            near = room >= 0.0
            at, box = at[near], box[near]
        np.minimum.at(squares, at, _squared_distance(points[at], triangles[order[box]]))
    return np.asarray(np.sqrt(squares))


def _boxes(centres: Array, low: Array, high: Array) -> tuple[NDArray[np.intp], list[Array]]:
    """The triangles in the order of a binary tree's leaves, and by level its boxes, (3, 2, number).

    Box k holds boxes 2 k and 2 k + 1 of the next level: halves at the median along the longest side of its
    centres. Some triangles occur twice, which fills the last level up.
    """
    depth = int(np.ceil(np.log2(len(centres))))
    order = np.resize(np.arange(len(centres)), 2**depth)
    for level in range(depth):
        groups = order.reshape(2**level, -1)
        axis = np.ptp(centres[groups], axis=1).argmax(axis=1)
        by = np.argsort(centres[groups, axis[:, None]], axis=1, kind="stable")
        order = np.take_along_axis(groups, by, axis=1).ravel()
    levels = [np.stack([low[order].T, high[order].T], axis=1)]
    for _ in range(depth):
        pairs = levels[-1].reshape(3, 2, -1, 2)
        levels.append(np.stack([pairs[:, 0].min(axis=-1), pairs[:, 1].max(axis=-1)], axis=1))
    return order, levels[::-1]


def _squared_distance(points: Array, triangles: Array) -> Array:
    """Squared distance of points (k, 3) to triangles (k, 3, 3): within the prism to the plane, else edge."""
    p = np.ascontiguousarray(points.T)  # coordinates apart: several times faster than rows of three
    a, b, c = np.ascontiguousarray(np.moveaxis(triangles, 0, -1))
    normal = _cross(b - a, c - a)
    size = _dot(normal, normal)
    inside = size > 0.0  # a triangle without area is its edges
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge, offset = end - start, p - start
        length = _dot(edge, edge)
        share = np.clip(_dot(offset, edge) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        away = offset - share * edge
        best = np.minimum(best, _dot(away, away))
        inside &= _dot(_cross(edge, offset), normal) >= 0.0
    height = _dot(p - a, normal)
    return np.where(inside, height**2 / np.where(size > 0.0, size, 1.0), best)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _cross(a: Array, b: Array) -> Array:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def surface_distance(
    simulated: trimesh.Trimesh,
    measured: trimesh.Trimesh,
    *,
    samples_log2: int = SAMPLES_LOG2,
    seed: int = SEED,
) -> float:
    """Mean distance [m] from points of either surface to the nearest place on the other one.

    The mean over each surface's area, then the mean of the two directions ("average symmetric surface
    distance"): 2**samples_log2 points a surface, spread by area, to triangles, not to vertices.
    Raises InputError where a surface is not closed.
    Source: Heimann et al., IEEE Trans. Med. Imaging 28 (2009) 1251-1265, there with pooled points.
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    there, back = both_ways(simulated, measured, samples_log2=samples_log2, seed=seed)
    return float(there.mean() + back.mean()) / 2


SURFACE_DISTANCE = Metric(
    name="surface_distance",
    title="mean surface distance",
    unit="m",
    higher_is_better=False,
    compute=surface_distance,
)


def hd95(
    simulated: trimesh.Trimesh,
    measured: trimesh.Trimesh,
    *,
    samples_log2: int = SAMPLES_LOG2,
    seed: int = SEED,
) -> float:
    """The larger of the two directed distances [m] that 95 % of a surface's area stays within.

    Points as for `surface_distance`. Some programs average the directions or pool them; on beams whose
    surfaces are alike that makes little difference.
    Raises InputError where a surface is not closed.
    Source: Huttenlocher, Klanderman and Rucklidge, IEEE Trans. PAMI 15 (1993) 850-863 (ranked Hausdorff
    distance); Taha and Hanbury, BMC Medical Imaging 15:29 (2015).
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    there, back = both_ways(simulated, measured, samples_log2=samples_log2, seed=seed)
    return float(max(np.percentile(there, 95), np.percentile(back, 95)))


HD95 = Metric(name="hd95", title="HD95", unit="m", higher_is_better=False, compute=hd95)


def vertex_distance(first: Array, second: Array) -> float:
    """Mean distance [m] from the points of either set to the nearest point of the other one.

    first, second: points (n, 3) and (m, 3) [m]; the mean over each set, then the mean of both directions.
    Raises ValueError for empty sets or other shapes.
    Source: average symmetric surface distance, on vertices instead of surfaces.
    """
    there, back = _both_ways(first, second)
    return float(there.mean() + back.mean()) / 2


def vertex_hd95(first: Array, second: Array) -> float:
    """Mean of the two directed 95th percentiles of the distance [m] to the other set's nearest point.

    The mean, where `hd95` takes the larger one: with all nodes of a volume mesh in one set the larger one is
    8 mm for 20 mm beams, twice what has been published.
    first, second and errors as for `vertex_distance`.
    """
    there, back = _both_ways(first, second)
    return float(np.percentile(there, 95) + np.percentile(back, 95)) / 2


def _both_ways(first: Array, second: Array) -> tuple[Array, Array]:
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    for name, points in (("first", first), ("second", second)):
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise ValueError(f"{name} points: expected shape (n, 3), got {points.shape}")
    there, _ = cKDTree(second).query(first)
    back, _ = cKDTree(first).query(second)
    return np.asarray(there, dtype=float), np.asarray(back, dtype=float)
