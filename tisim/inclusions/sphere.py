"""A rigid sphere, which may be partly below the base."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim.inclusions._recipe import RecipeParameter, RecipeShape
from tisim.inclusions._shape import Array, Inclusion, Spheroid, Vector


@dataclass(frozen=True, kw_only=True)
class SphereInclusion(Inclusion):
    """Rigid sphere: radius and centre [m]."""

    kind: ClassVar[str] = "sphere"

    radius: float

    def mesh_geometry(self) -> Spheroid:
        return Spheroid(radius=self.radius, half_height=self.radius)

    def signed_distance(self, points: ArrayLike) -> Array:
        local = np.asarray(points, dtype=float) - np.asarray(self.centre)
        return np.asarray(np.linalg.norm(local, axis=-1) - self.radius)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        local = np.asarray(points, dtype=float) - np.asarray(self.centre)
        return np.asarray((local**2).sum(axis=-1) <= self.radius**2)

    @property
    def extent(self) -> Vector:
        return self.radius, self.radius, self.radius

    @property
    def volume(self) -> float:
        return 4.0 / 3.0 * math.pi * self.radius**3


RECIPE = RecipeShape(
    name="sphere",
    parameters=(RecipeParameter("radius"), RecipeParameter("sunk", default=0.0, positive=False)),
    standing=lambda p, x, y, _: SphereInclusion(radius=p["radius"], centre=(x, y, p["radius"] - p["sunk"])),
    reach=lambda p: p["radius"],
    top=lambda p: 2 * p["radius"] - p["sunk"],
)
