"""Shapes of meshes and scenes: sections, rigid inclusions, blocks and rods. SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from tisim.inclusions import BoxInclusion, CylinderInclusion, Inclusion, SphereInclusion, Vector


@dataclass(frozen=True, kw_only=True)
class Circle:
    """Circular section.

    Attributes
    ----------
    radius : float
        Radius [m].
    """

    radius: float

    @property
    def half_width(self) -> float:
        """Half the extent along y [m]."""
        return self.radius

    @property
    def half_height(self) -> float:
        """Half the extent along z [m]."""
        return self.radius

    @property
    def area(self) -> float:
        """Area [m2]."""
        return math.pi * self.radius**2

    def second_moment(self, axis: Literal["y", "z"]) -> float:
        """Second moment of area about the central axis y or z [m4]; of a circle the same about both."""
        del axis
        return math.pi * self.radius**4 / 4.0

    def scaled(self, factor: float) -> Circle:
        """The circle with its radius times `factor` [-]."""
        return Circle(radius=factor * self.radius)

    def grown(self, by: float) -> Circle:
        """The circle with its edge moved outward by `by` [m], inward where negative."""
        return Circle(radius=self.radius + by)


@dataclass(frozen=True, kw_only=True)
class Rectangle:
    """Rectangular section.

    Attributes
    ----------
    width, height : float
        Sizes along y and along z [m].
    """

    width: float
    height: float

    @property
    def half_width(self) -> float:
        """Half the extent along y [m]."""
        return 0.5 * self.width

    @property
    def half_height(self) -> float:
        """Half the extent along z [m]."""
        return 0.5 * self.height

    @property
    def area(self) -> float:
        """Area [m2]."""
        return self.width * self.height

    def second_moment(self, axis: Literal["y", "z"]) -> float:
        """Second moment of area about the central axis y or z [m4]: about y, heights count cubed."""
        along, across = (self.width, self.height) if axis == "y" else (self.height, self.width)
        return along * across**3 / 12.0

    def scaled(self, factor: float) -> Rectangle:
        """The rectangle with both sizes times `factor` [-]."""
        return Rectangle(width=factor * self.width, height=factor * self.height)

    def grown(self, by: float) -> Rectangle:
        """The rectangle with each edge moved outward by `by` [m], inward where negative."""
        return Rectangle(width=self.width + 2.0 * by, height=self.height + 2.0 * by)


@dataclass(frozen=True, kw_only=True)
class Block:
    """A rectangular soft block, x and y centred on 0, z from 0 (fixed base) to size[2] (free top) [m].

    Attributes
    ----------
    size : (float, float, float)
        Lengths along x, y and z [m].
    inclusion : Inclusion, optional
        A rigid body embedded in the block and bonded to it; its part below z = 0 is ignored.
    """

    size: Vector = (0.100, 0.100, 0.032)
    inclusion: Inclusion | None = None


@dataclass(frozen=True, kw_only=True)
class Rod:
    """A rigid round rod.

    Attributes
    ----------
    radius, length : float
        Radius and length [m]; the length is that of pictures, in contact the shaft has no end.
    tip : "flat" or "hemisphere"
        Shape of the tip.
    edge_radius : float
        Radius of the rounded edge of a flat tip [m].
    """

    radius: float = 0.0025
    length: float = 0.040
    tip: Literal["flat", "hemisphere"] = "flat"
    edge_radius: float = 0.001

    @property
    def edge(self) -> float:
        """Radius of the tip's edge [m]: `radius` for a hemisphere, else `edge_radius`, at most `radius`."""
        return self.radius if self.tip == "hemisphere" else min(self.edge_radius, self.radius)

    def reach(self, down: float) -> float:
        """Height of the tip's centre over its lowest point [m], for an axis of vertical component `down`.

        The lowest point is on the torus of the edge, whose centre circle lies `edge` behind the tip.
        """
        tilt = math.sqrt(max(0.0, 1.0 - down**2))
        return (self.radius - self.edge) * tilt + self.edge * (1.0 - down)


__all__ = [
    "Block",
    "BoxInclusion",
    "Circle",
    "CylinderInclusion",
    "Inclusion",
    "Rectangle",
    "Rod",
    "SphereInclusion",
    "Vector",
]
