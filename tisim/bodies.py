"""Sections, rigid inclusions, blocks and rods: the shapes that meshes and scenes are made of. SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tisim.inclusions import BoxInclusion, CylinderInclusion, Inclusion, SphereInclusion, Vector


@dataclass(frozen=True, kw_only=True)
class Circle:
    """Circular section.

    Attributes
    ----------
    radius : float
        [m].
    """

    radius: float


@dataclass(frozen=True, kw_only=True)
class Rectangle:
    """Rectangular section.

    Attributes
    ----------
    width, height : float
        Along y and along z [m].
    """

    width: float
    height: float


@dataclass(frozen=True, kw_only=True)
class Block:
    """A rectangular soft block, x and y centred on 0, z from 0 (fixed base) to size[2] (free top) [m].

    Attributes
    ----------
    size : (float, float, float)
        [m].
    inclusion : Inclusion, optional
        A rigid body embedded in it, bonded; what reaches below z = 0 does not count.
    """

    size: Vector = (0.100, 0.100, 0.032)
    inclusion: Inclusion | None = None


@dataclass(frozen=True, kw_only=True)
class Rod:
    """A rigid round rod.

    Attributes
    ----------
    radius, length : float
        [m].
    tip : "flat" or "hemisphere"
    edge_radius : float
        Of the rounded edge of a flat tip [m].
    """

    radius: float = 0.0025
    length: float = 0.040
    tip: Literal["flat", "hemisphere"] = "flat"
    edge_radius: float = 0.001

    @property
    def edge(self) -> float:
        """Radius of the tip's edge whatever the tip is, that of the rod where it is a hemisphere [m]."""
        return self.radius if self.tip == "hemisphere" else min(self.edge_radius, self.radius)


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
