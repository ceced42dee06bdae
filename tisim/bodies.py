"""Sections, rigid inclusions, blocks and rods: the shapes that meshes and scenes are made of. SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Circle:
    """Circular section; radius [m]."""

    radius: float


@dataclass(frozen=True, kw_only=True)
class Rectangle:
    """Rectangular section; width along y, height along z [m]."""

    width: float
    height: float


@dataclass(frozen=True, kw_only=True)
class BoxInclusion:
    """Rigid box: size (a, b, c) along its own axes, centre [m], turned by `angle` [rad] about z."""

    size: Vector
    centre: Vector
    angle: float = 0.0


@dataclass(frozen=True, kw_only=True)
class SphereInclusion:
    """Rigid sphere: radius and centre [m]."""

    radius: float
    centre: Vector


@dataclass(frozen=True, kw_only=True)
class CylinderInclusion:
    """Rigid upright cylinder: radius, height and centre [m]."""

    radius: float
    height: float
    centre: Vector


Inclusion = BoxInclusion | SphereInclusion | CylinderInclusion


@dataclass(frozen=True, kw_only=True)
class Block:
    """A rectangular soft block, x and y centred on 0, z from 0 (fixed base) to size[2] (free top) [m].

    inclusion: a rigid body embedded in it, bonded; its part below z = 0 or outside does not count.
    """

    size: Vector = (0.100, 0.100, 0.032)
    inclusion: Inclusion | None = None


@dataclass(frozen=True, kw_only=True)
class Rod:
    """A rigid round rod.

    radius, length [m]; tip "flat" with a rounded edge of edge_radius [m], or "hemisphere".
    """

    radius: float = 0.0025
    length: float = 0.040
    tip: Literal["flat", "hemisphere"] = "flat"
    edge_radius: float = 0.001
