"""The outline of a rigid inclusion in the plane, and how high its surface stands over a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import BoxInclusion, Inclusion, SphereInclusion
from tisim.mesh._errors import MeshError

Floats = NDArray[np.float64]

# material thinner than this between an inclusion and the block's base is meshed as rigid [m]
THINNEST_GAP = 0.001
THINNEST_COVER = 0.001


@dataclass(frozen=True, kw_only=True)
class Outline:
    """The plan view of an inclusion: a circle, or a convex polygon, counter-clockwise.

    centre (2,), radius of the inscribed circle and reach of the circumscribed one [m]; corners: shape (c, 2),
    none for a circle. low, high: heights of the flat faces [m]; for a sphere both are the height of the
    outline. dome: radius of the sphere and height of its centre [m], None where the faces are flat.
    """

    centre: Floats
    radius: float
    reach: float
    corners: Floats
    low: float
    high: float
    dome: tuple[float, float] | None = None

    @property
    def area(self) -> float:
        if not len(self.corners):
            return float(np.pi * self.radius**2)
        x, y = self.corners.T
        return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

    @property
    def apex(self) -> float:
        """The highest point of the inclusion [m]."""
        return self.high if self.dome is None else self.dome[0] + self.dome[1]

    def signed(self, points: Floats) -> Floats:
        """Below 0 inside, 0 on the outline, above 0 outside; the distance [m] but near corners outside."""
        if not len(self.corners):
            away = points - self.centre
            return np.asarray(np.hypot(away[..., 0], away[..., 1]) - self.radius)
        return np.asarray(self._beyond(points).max(axis=-1))

    def face(self, points: Floats) -> NDArray[np.int64]:
        """Which side of the polygon points on the outline lie on; 0 for a circle."""
        if not len(self.corners):
            return np.zeros(len(points), dtype=np.int64)
        return np.asarray(self._beyond(points).argmax(axis=-1), dtype=np.int64)

    def _beyond(self, points: Floats) -> Floats:
        along = np.roll(self.corners, -1, axis=0) - self.corners
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
        return np.asarray(points @ normal.T - np.sum(normal * self.corners, axis=1))

    def crossing(self, inside: Floats, outside: Floats) -> Floats:
        """Where segments from inside points to outside points cross the outline; shapes (n, 2)."""
        low, high = np.zeros(len(inside)), np.ones(len(inside))
        for _ in range(54):
            middle = 0.5 * (low + high)
            within = self.signed(inside + middle[:, None] * (outside - inside)) < 0.0
            low, high = np.where(within, middle, low), np.where(within, high, middle)
        return inside + (0.5 * (low + high))[:, None] * (outside - inside)

    def cap(self, points: Floats) -> tuple[Floats, Floats]:
        """Heights of the lower and upper surface over points (n, 2); outside, those of the outline [m]."""
        low, high = np.full(len(points), self.low), np.full(len(points), self.high)
        if self.dome is not None:
            radius, height = self.dome
            away = points - self.centre
            rise = np.sqrt(np.maximum(radius**2 - np.sum(away**2, axis=1), 0.0))
            inside = self.signed(points) < -1e-9 * radius
            high = np.where(inside, height + rise, high)
            low = np.where(inside, height - rise, low)
        return low, high


def outline_of(inclusion: Inclusion, *, size: tuple[float, float, float]) -> Outline:
    """The outline of an inclusion in a block of that size, or a MeshError that says why it cannot be met."""
    centre = np.array(inclusion.centre, dtype=np.float64)
    if centre.shape != (3,) or not np.isfinite(centre).all():
        raise MeshError(f"inclusion centre: expected three finite coordinates [m], got {inclusion.centre}")
    corners = np.zeros((0, 2))
    dome = None
    if isinstance(inclusion, SphereInclusion):
        _positive("sphere radius", inclusion.radius)
        low = high = max(0.0, float(centre[2]))
        if centre[2] <= -inclusion.radius + THINNEST_GAP:
            raise MeshError(f"inclusion: the sphere lies below the block's base (centre z {centre[2]} m)")
        radius = float(np.sqrt(inclusion.radius**2 - min(0.0, float(centre[2])) ** 2))
        reach, dome = radius, (float(inclusion.radius), float(centre[2]))
    elif isinstance(inclusion, BoxInclusion):
        for name, length in zip("abc", inclusion.size, strict=True):
            _positive(f"box size {name}", length)
        a, b = 0.5 * inclusion.size[0], 0.5 * inclusion.size[1]
        c, s = np.cos(inclusion.angle), np.sin(inclusion.angle)
        corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]]) @ np.array([[c, s], [-s, c]]) + centre[:2]
        radius, reach = float(min(a, b)), float(np.hypot(a, b))
        low, high = centre[2] - 0.5 * inclusion.size[2], centre[2] + 0.5 * inclusion.size[2]
    else:
        _positive("cylinder radius", inclusion.radius)
        _positive("cylinder height", inclusion.height)
        radius = reach = float(inclusion.radius)
        low, high = centre[2] - 0.5 * inclusion.height, centre[2] + 0.5 * inclusion.height
    if dome is None:
        low = 0.0 if low < THINNEST_GAP else float(low)
        if high < THINNEST_GAP:
            raise MeshError(f"inclusion: its top, z = {1e3 * high:.1f} mm, is at or below the block's base")
    outline = Outline(
        centre=centre[:2], radius=radius, reach=reach, corners=corners, low=low, high=float(high), dome=dome
    )
    _fits(outline, size)
    return outline


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
            "inclusion: its outline comes within 1 mm of the block's side, or leaves the block "
            f"(centre {tuple(outline.centre)} m, block {1e3 * size[0]:.0f} x {1e3 * size[1]:.0f} mm)"
        )


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise MeshError(f"inclusion: {name} must be a length above 0 [m], got {value}")
