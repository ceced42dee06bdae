"""A rigid box, rotated about the vertical; a cube in recipes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from tisim.inclusions._recipe import RecipeParameter, RecipeShape
from tisim.inclusions._shape import Array, Inclusion, Prism, Vector


@dataclass(frozen=True, kw_only=True)
class BoxInclusion(Inclusion):
    """Rigid box: size (a, b, c) along its own axes and centre [m], rotation `angle` [rad] about z."""

    kind: ClassVar[str] = "box"
    angles: ClassVar[tuple[str, ...]] = ("angle",)

    size: Vector
    angle: float = 0.0

    def mesh_geometry(self) -> Prism:
        a, b = 0.5 * self.size[0], 0.5 * self.size[1]
        c, s = np.cos(self.angle), np.sin(self.angle)
        turn = np.array([[c, s], [-s, c]])
        corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]]) @ turn + np.asarray(self.centre[:2])
        return Prism(
            low=self.centre[2] - 0.5 * self.size[2],
            high=self.centre[2] + 0.5 * self.size[2],
            inscribed=float(min(a, b)),
            circumscribed=float(np.hypot(a, b)),
            corners=corners,
        )

    def signed_distance(self, points: ArrayLike) -> Array:
        local = np.asarray(points, dtype=float) - np.asarray(self.centre)
        c, s = np.cos(self.angle), np.sin(self.angle)
        u = c * local[..., 0] + s * local[..., 1]
        v = -s * local[..., 0] + c * local[..., 1]
        beyond = np.abs(np.stack([u, v, local[..., 2]], axis=-1)) - np.asarray(self.size) / 2
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return np.asarray(outside + np.minimum(beyond.max(axis=-1), 0.0))

    @property
    def extent(self) -> Vector:
        a, b, c = (0.5 * v for v in self.size)
        cosine, sine = abs(math.cos(self.angle)), abs(math.sin(self.angle))
        return a * cosine + b * sine, a * sine + b * cosine, c

    @property
    def volume(self) -> float:
        return float(np.prod(self.size))


def _standing(p: Mapping[str, float], x: float, y: float, angle: float) -> Inclusion:
    side = p["side"]
    return BoxInclusion(size=(side, side, side), centre=(x, y, side / 2), angle=angle)


RECIPE = RecipeShape(
    name="cube",
    parameters=(RecipeParameter("side"),),
    standing=_standing,
    reach=lambda p: p["side"] / 2**0.5,
    top=lambda p: p["side"],
    turned=True,
)
