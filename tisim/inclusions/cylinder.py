"""A rigid upright cylinder."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim.inclusions._recipe import RecipeParameter, RecipeShape
from tisim.inclusions._shape import Array, Inclusion, Prism, Vector


@dataclass(frozen=True, kw_only=True)
class CylinderInclusion(Inclusion):
    """Rigid upright cylinder: radius, height and centre [m]."""

    kind: ClassVar[str] = "cylinder"

    radius: float
    height: float

    def mesh_geometry(self) -> Prism:
        low, high = self.centre[2] - 0.5 * self.height, self.centre[2] + 0.5 * self.height
        return Prism.round(radius=self.radius, low=low, high=high)

    def signed_distance(self, points: ArrayLike) -> Array:
        local = np.asarray(points, dtype=float) - np.asarray(self.centre)
        beside = np.hypot(local[..., 0], local[..., 1]) - self.radius
        above = np.abs(local[..., 2]) - self.height / 2
        outside = np.hypot(np.maximum(beside, 0.0), np.maximum(above, 0.0))
        return np.asarray(outside + np.minimum(np.maximum(beside, above), 0.0))

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        local = np.asarray(points, dtype=float) - np.asarray(self.centre)
        within = (local[..., :2] ** 2).sum(axis=-1) <= self.radius**2
        return np.asarray(within & (np.abs(local[..., 2]) <= self.height / 2))

    @property
    def extent(self) -> Vector:
        return self.radius, self.radius, 0.5 * self.height

    @property
    def volume(self) -> float:
        return math.pi * self.radius**2 * self.height


RECIPE = RecipeShape(
    name="cylinder",
    parameters=(RecipeParameter("radius"), RecipeParameter("height")),
    standing=lambda p, x, y, _: CylinderInclusion(
        radius=p["radius"], height=p["height"], centre=(x, y, p["height"] / 2)
    ),
    reach=lambda p: p["radius"],
    top=lambda p: p["height"],
)
