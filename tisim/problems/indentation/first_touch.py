"""Where a rod first touches the surface at rest: depths are counted from there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim._checks import FieldError
from tisim.bodies import Rod
from tisim.discretisation.quadrature import facet_areas
from tisim.mesh import Mesh
from tisim.problems.indentation.turning import axes
from tisim.scene import Poke

Array = NDArray[np.float64]

FLAT = 1e-9  # range of heights of a plane surface, relative to its distance from the base
SAMPLES = 7  # per side of a facet of a surface that is no plane


def near_facets(scene: Poke, mesh: Mesh) -> NDArray[np.int32]:
    """Facets (f, a) of the top that the rod can touch on its course."""
    top = mesh.facet_sets["top"]
    centres = mesh.nodes[top].mean(axis=1)[:, :2] - np.asarray(scene.site)
    reach = 0.5 * scene.depth + 4.0 * scene.rod.radius
    near = np.zeros(len(top), dtype=bool)
    for along in axes(scene)[:, :2]:
        travel = np.clip(centres @ along / max(float(along @ along), 1e-12), 0.0, scene.depth)
        near |= np.linalg.norm(centres - travel[:, None] * along, axis=1) < reach
    return np.ascontiguousarray(top[near], dtype=np.int32)


class FirstTouch:
    """Position of the rod at first contact with the top at rest, by direction of its axis.

    Parameters
    ----------
    scene : Poke
    mesh : Mesh
        Mesh with a facet set "top".
    facets : ndarray of int, shape (f, a)
        Facets of the top that the rod can touch.

    Raises
    ------
    FieldError
        No facet is below the site.
    """

    def __init__(self, scene: Poke, mesh: Mesh, facets: NDArray[np.int32]) -> None:
        self._rod, self._site = scene.rod, scene.site
        heights = mesh.nodes[facets, 2]
        self._height = float(heights.max()) if len(facets) else 0.0
        below = self._height - float(mesh.nodes[:, 2].min())
        self._points: Array | None = None
        if not len(facets):
            raise _off_the_top(scene, mesh)
        if np.ptp(heights) > FLAT * below:
            shape, _ = facet_areas(mesh.nodes, facets, SAMPLES)
            corners = mesh.nodes[np.unique(facets)]
            self._points = np.concatenate([(shape @ mesh.nodes[facets]).reshape(-1, 3), corners])
            found = _height_at(mesh, facets, np.asarray(scene.site))
            if found is None:
                raise _off_the_top(scene, mesh)
            self._height = found

    def tip(self, axis: Array) -> Array:
        """Centre of the tip [m] at first contact, for a unit vector along the rod."""
        if self._points is None:
            return plane_contact(self._rod, self._site, self._height, axis)
        # a point at the radius r from the axis is touched when the tip is h(r) beyond it
        target = np.array([*self._site, self._height])
        ahead = (self._points - target) @ axis
        radius = np.linalg.norm(self._points - target - ahead[:, None] * axis, axis=1)
        under = radius < self._rod.radius
        edge = self._rod.edge
        beyond = np.maximum(radius[under] - (self._rod.radius - edge), 0.0)
        travel = ahead[under] + edge - np.sqrt(np.maximum(edge**2 - beyond**2, 0.0))
        return np.asarray(target + float(travel.min()) * axis)


def plane_contact(rod: Rod, site: tuple[float, float], height: float, axis: Array) -> Array:
    """Centre of the tip [m] at first contact with the plane z = height, the axis passing through the site."""
    down = float(abs(axis[2]))
    target = np.array([site[0], site[1], height])
    return target - axis * (rod.reach(down) / down)


def _height_at(mesh: Mesh, facets: NDArray[np.int32], site: Array) -> float | None:
    """Height z [m] of the surface at (x, y), the highest of several; None where there is none."""
    corners = 3 if facets.shape[1] in (3, 6) else 4
    cuts = [(0, k, k + 1) for k in range(1, corners - 1)]
    a, b, c = (mesh.nodes[facets[:, [cut[k] for cut in cuts]].ravel()] for k in range(3))
    u, v, w = b[:, :2] - a[:, :2], c[:, :2] - a[:, :2], site - a[:, :2]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(area == 0.0, np.inf, area)
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / area
    t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / area
    inside = np.isfinite(area) & (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1.0 + 1e-9)
    heights = a[:, 2] + s * (b[:, 2] - a[:, 2]) + t * (c[:, 2] - a[:, 2])
    return float(heights[inside].max()) if inside.any() else None


def _off_the_top(scene: Poke, mesh: Mesh) -> FieldError:
    top = mesh.nodes[np.unique(mesh.facet_sets["top"])]
    (x0, y0), (x1, y1) = top[:, :2].min(axis=0), top[:, :2].max(axis=0)
    wanted = f"a place on the mesh's top (x {x0:.4g} to {x1:.4g} m, y {y0:.4g} to {y1:.4g} m)"
    return FieldError("site", wanted, scene.site)
