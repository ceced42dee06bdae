"""The setup of an indentation: the block with the grid on its top face, and the indenter. SI units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from learn.data._format import GRID

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """A block, whose grid's points are the centres of equal cells of its top face, and the indenter.

    Attributes
    ----------
    points, normals : rest positions [m] and outward unit normals of the grid, shape (n, 3).
    level_depth : depth of each level of the profiles below the surface [m], shape (levels,).
    rod_radius, rod_edge : radii of the indenter and of its tip's edge, equal for a hemisphere [m].
    """

    points: Floats
    normals: Floats
    level_depth: Floats
    rod_radius: float
    rod_edge: float

    @cached_property
    def middle(self) -> Floats:
        """Middle of the top face, (x, y) [m]."""
        return np.asarray((self.points[:, :2].min(axis=0) + self.points[:, :2].max(axis=0)) / 2)

    @cached_property
    def block_size(self) -> tuple[float, float, float]:
        """Length, width and height of the block [m]."""
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        length, width = (high - low)[:2] * GRID / (GRID - 1)
        return float(length), float(width), float(self.level_depth[0] + self.level_depth[-1])

    @cached_property
    def top(self) -> float:
        """Height of the top face [m]."""
        return float(self.points[0, 2])

    def contact_site(self, start: Floats, direction: Floats) -> Floats:
        """Intersection of the indenter's axis with the rest surface, (x, y) [m].

        `start` is the centre of the tip at first contact [m], `direction` the unit vector of the push.
        """
        return np.asarray(start[:2] + (self.top - start[2]) / direction[2] * direction[:2])

    def first_touch(self, site: Sequence[float], direction: Floats) -> Floats:
        """Centre of the tip [m], (3,), when the indenter first touches the top.

        `site` is the intersection of its axis with the top, (x, y) [m], `direction` the unit vector of the
        push.
        """
        cosine = -float(direction[2])
        sine = math.hypot(float(direction[0]), float(direction[1]))
        above = self.rod_edge * (1 - cosine) + (self.rod_radius - self.rod_edge) * sine
        return np.asarray(np.array([site[0], site[1], self.top]) - direction * (above / cosine))

    def with_block(self, size: Sequence[float]) -> Setup:
        """The indenter on a block of another size [m], which has the same base and middle."""
        length, width, height = size
        cells = (np.arange(GRID) + 0.5) / GRID - 0.5
        x, y = np.meshgrid(self.middle[0] + cells * length, self.middle[1] + cells * width)
        top = self.top - self.block_size[2] + height
        points = np.stack([x, y, np.full_like(x, top)], axis=-1)
        levels = len(self.level_depth)
        return replace(
            self,
            points=points.reshape(-1, 3),
            normals=grid_normals(points),
            level_depth=np.asarray((np.arange(levels) + 0.5) * (height / levels), dtype=np.float64),
        )


def grid_normals(grid: Floats) -> Floats:
    """Unit normals (n, 3) of a grid of points (rows, columns, 3): step of columns x step of rows."""
    along, up = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    normal = np.cross(along, up).reshape(-1, 3)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
