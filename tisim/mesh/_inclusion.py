"""Outline of a rigid inclusion in the plane, and heights of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.inclusions import Inclusion, Spheroid
from tisim.mesh._mesh import MeshError

Floats = NDArray[np.float64]

# material thinner than this between an inclusion and the block's base is meshed as rigid [m]
THINNEST_GAP = 0.001
THINNEST_COVER = 0.001
# relative to the radius: points nearer to an inclusion's surface are on it
ON_SURFACE = 1e-6


@dataclass(frozen=True, kw_only=True)
class Dome:
    """A spheroid with a vertical axis: half axes and the height of its centre [m]."""

    radius: float
    half_height: float
    middle: float


@dataclass(frozen=True, kw_only=True)
class Outline:
    """The plan view of an inclusion: a circle, or a convex polygon, counter-clockwise.

    Attributes
    ----------
    centre : centre [m], shape (2,).
    radius, reach : radii of the inscribed and of the circumscribed circle [m].
    corners : corners of the polygon [m], shape (c, 2); empty for a circle.
    low, high : heights of the flat faces; for a spheroid both are the height of the outline [m].
    dome : the spheroid; None for flat faces.
    """

    centre: Floats
    radius: float
    reach: float
    corners: Floats
    low: float
    high: float
    dome: Dome | None = None

    @property
    def area(self) -> float:
        if not len(self.corners):
            return float(np.pi * self.radius**2)
        x, y = self.corners.T
        return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

    @property
    def volume(self) -> float:
        """Volume of the inclusion above the block's base [m3]."""
        if self.dome is None:
            return self.area * (self.high - self.low)
        half, below = self.dome.half_height, min(self.dome.middle, self.dome.half_height)
        # integral of the sections pi r2 (1 - t2 / h2) at the height t above the centre
        return float(np.pi * self.dome.radius**2 * (2 * half / 3 + below - below**3 / (3 * half**2)))

    @property
    def apex(self) -> float:
        """Height of the highest point of the inclusion [m]."""
        return self.high if self.dome is None else self.dome.half_height + self.dome.middle

    def signed(self, points: Floats) -> Floats:
        """Signed distance from the outline [m], negative inside; too small outside near corners."""
        if not len(self.corners):
            away = points - self.centre
            return np.asarray(np.hypot(away[..., 0], away[..., 1]) - self.radius)
        return np.asarray(self._beyond(points).max(axis=-1))

    def face(self, points: Floats) -> NDArray[np.int64]:
        """Index of the polygon's side of points on the outline, shape (n,); 0 for a circle."""
        if not len(self.corners):
            return np.zeros(len(points), dtype=np.int64)
        return np.asarray(self._beyond(points).argmax(axis=-1), dtype=np.int64)

    def _beyond(self, points: Floats) -> Floats:
        along = np.roll(self.corners, -1, axis=0) - self.corners
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
        return np.asarray(points @ normal.T - np.sum(normal * self.corners, axis=1))

    def crossing(self, inside: Floats, outside: Floats) -> Floats:
        """Points at which segments from inside to outside points cross the outline [m], shapes (n, 2)."""
        low, high = np.zeros(len(inside)), np.ones(len(inside))
        for _ in range(54):
            middle = 0.5 * (low + high)
            within = self.signed(inside + middle[:, None] * (outside - inside)) < 0.0
            low, high = np.where(within, middle, low), np.where(within, high, middle)
        return inside + (0.5 * (low + high))[:, None] * (outside - inside)

    def between(self, ends: Floats) -> Floats:
        """Middles (k, 3) of edges (k, 2, 3) [m], on the curved surface if both ends lie on it."""
        middle = ends.mean(axis=1)
        if len(self.corners):
            return middle
        centre, radius = self.centre, self.radius
        if self.dome is not None:
            half = np.array([self.dome.radius, self.dome.radius, self.dome.half_height])
            there = np.array([*centre, self.dome.middle])
            on = (np.abs(np.linalg.norm((ends - there) / half, axis=2) - 1.0) < ON_SURFACE).all(axis=1)
            away = (middle - there) / half
            out = there + half * away / np.linalg.norm(away, axis=1, keepdims=True)
        else:
            on = (np.abs(np.hypot(*(ends[..., :2] - centre).T).T - radius) < ON_SURFACE * radius).all(axis=1)
            out = middle
        flat = on & (ends[:, 0, 2] == ends[:, 1, 2])  # rims stay in their plane
        middle[on] = out[on]
        at = ends[flat].mean(axis=1)
        away = at[:, :2] - centre
        rim = np.hypot(*(ends[flat, 0, :2] - centre).T)
        at[:, :2] = centre + away * (rim / np.hypot(*away.T))[:, None]
        middle[flat] = at
        return middle

    def cap(self, points: Floats) -> tuple[Floats, Floats]:
        """Heights of the lower and upper surface at points (n, 2) [m]; outside, those of the outline."""
        low, high = np.full(len(points), self.low), np.full(len(points), self.high)
        if self.dome is not None:
            radius, height = self.dome.radius, self.dome.middle
            away = points - self.centre
            rise = np.sqrt(np.maximum(radius**2 - np.sum(away**2, axis=1), 0.0))
            rise *= self.dome.half_height / radius
            inside = self.signed(points) < -1e-9 * radius
            high = np.where(inside, height + rise, high)
            low = np.where(inside, height - rise, low)
        return low, high


def outline_of(inclusion: Inclusion, *, size: tuple[float, float, float]) -> Outline:
    """Outline of an inclusion in a block of `size` [m]; MeshError if it is invalid or does not fit."""
    try:
        inclusion.check()
    except ValueError as error:
        raise MeshError(f"inclusion: {inclusion.kind} {error}") from None
    centre = np.array(inclusion.centre, dtype=np.float64)
    geometry = inclusion.mesh_geometry()
    if isinstance(geometry, Spheroid):
        outline = _of_spheroid(inclusion.kind, geometry, centre)
    else:
        low = 0.0 if geometry.low < THINNEST_GAP else float(geometry.low)
        if geometry.high < THINNEST_GAP:
            top = 1e3 * geometry.high
            raise MeshError(f"inclusion: its top, z = {top:.1f} mm, is at or below the block's base")
        outline = Outline(
            centre=centre[:2],
            radius=float(geometry.inscribed),
            reach=float(geometry.circumscribed),
            corners=np.asarray(geometry.corners, dtype=np.float64),
            low=low,
            high=float(geometry.high),
        )
    _fits(outline, size)
    return outline


def _of_spheroid(kind: str, geometry: Spheroid, centre: Floats) -> Outline:
    """Outline of the widest section of a spheroid in the block."""
    radius, half, middle = float(geometry.radius), float(geometry.half_height), float(centre[2])
    if middle <= -half + THINNEST_GAP:
        raise MeshError(f"inclusion: the {kind} lies below the block's base (centre z {middle} m)")
    widest = float(np.sqrt(radius**2 - (radius / half * min(0.0, middle)) ** 2))
    height = max(0.0, middle)
    return Outline(
        centre=centre[:2],
        radius=widest,
        reach=widest,
        corners=np.zeros((0, 2)),
        low=height,
        high=height,
        dome=Dome(radius=radius, half_height=half, middle=middle),
    )


def _fits(outline: Outline, size: tuple[float, float, float]) -> None:
    if outline.apex > size[2] - THINNEST_COVER:
        raise MeshError(
            f"inclusion: its top, z = {1e3 * outline.apex:.1f} mm, leaves less than "
            f"{1e3 * THINNEST_COVER:.0f} mm of soft material below the block's top ({1e3 * size[2]:.0f} mm)"
        )
    ends = (
        outline.corners
        if len(outline.corners)
        else outline.centre + outline.radius * np.array([[1, 1], [-1, -1]])
    )
    if not np.all(np.abs(ends) + THINNEST_GAP <= 0.5 * np.array(size[:2])):
        raise MeshError(
            "inclusion: its outline comes within 1 mm of the block's side, or leaves the block (centre"
            f" x {1e3 * outline.centre[0]:.4g}, y {1e3 * outline.centre[1]:.4g} mm,"
            f" block {1e3 * size[0]:.0f} x {1e3 * size[1]:.0f} mm)"
        )
