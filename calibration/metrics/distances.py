"""Distances from points spread over one surface to another surface."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pyvista
import trimesh
from numpy.typing import NDArray
from scipy.stats import qmc

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
    draw = qmc.Sobol(d=3, rng=np.random.default_rng(seed)).random_base2(samples_log2)
    area = np.cumsum(mesh.area_faces)
    which = np.minimum(np.searchsorted(area, draw[:, 0] * area[-1]), len(area) - 1)
    u = np.sqrt(draw[:, 1])[:, None]
    v = draw[:, 2][:, None]
    a, b, c = (np.asarray(mesh.triangles)[which, m] for m in range(3))
    return np.asarray((1 - u) * a + u * (1 - v) * b + u * v * c)


def point_to_surface(points: Array, surface: trimesh.Trimesh) -> Array:
    """Distance [m] of each point (n, 3) to the nearest place on a surface.

    By VTK: trimesh's closest_point takes squared distances within 1e-8 for equal, which at our size in
    metres is wrong by up to 0.1 mm.
    """
    shell = pyvista.PolyData.from_regular_faces(np.asarray(surface.vertices, dtype=float), surface.faces)
    _, nearest = shell.find_closest_cell(points, return_closest_point=True)
    return np.asarray(np.linalg.norm(np.asarray(nearest).reshape(-1, 3) - points, axis=1))
