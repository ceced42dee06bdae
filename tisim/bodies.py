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
