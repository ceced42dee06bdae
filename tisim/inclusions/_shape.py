"""Interface of an inclusion shape: surface, bounding box, and geometry for the mesh generator."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any, ClassVar, Self, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim._checks import check_length, check_number, check_vector

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Prism:
    """Mesh geometry of a shape with vertical sides and flat ends.

    Attributes
    ----------
    low, high : float
        Heights of the lower and upper face [m].
    inscribed, circumscribed : float
        Radii of the inscribed and circumscribed circle of the plan view about the centre's (x, y) [m]; equal
        for a circle.
    corners : ndarray of float, shape (c, 2)
        Corners of the plan view [m], convex, counter-clockwise; shape (0, 2) for a circle.
    """

    low: float
    high: float
    inscribed: float
    circumscribed: float
    corners: Array

    @staticmethod
    def round(*, radius: float, low: float, high: float) -> Prism:
        """An upright cylinder."""
        return Prism(low=low, high=high, inscribed=radius, circumscribed=radius, corners=np.zeros((0, 2)))

    @staticmethod
    def polygon(corners: ArrayLike, *, centre: ArrayLike, low: float, high: float) -> Prism:
        """A prism over a convex, counter-clockwise polygon that contains `centre` (x, y)."""
        corner = np.asarray(corners, dtype=float)
        away = corner - np.asarray(centre, dtype=float)[:2]
        along = np.roll(corner, -1, axis=0) - corner
        to_side = (along[:, 0] * -away[:, 1] + along[:, 1] * away[:, 0]) / np.hypot(*along.T)
        return Prism(
            low=low,
            high=high,
            inscribed=float(to_side.min()),
            circumscribed=float(np.hypot(*away.T).max()),
            corners=corner,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Spheroid:
    """Mesh geometry of an ellipsoid of revolution with a vertical axis.

    Attributes
    ----------
    radius, half_height : float
        Half axes, horizontal and vertical [m]; equal for a sphere.
    """

    radius: float
    half_height: float


MeshGeometry = Prism | Spheroid


@dataclass(frozen=True, kw_only=True)
class Inclusion(ABC):
    """A rigid body bonded into a block, in the block's coordinates (x, y centred, z = 0 the fixed base).

    A subclass is a frozen, keyword-only dataclass. Each of its fields is a length or a triple of lengths
    [m], or an angle [rad] if `angles` names it. Parts below the base are ignored.

    Attributes
    ----------
    kind : str
        Name in files and stores ("sphere"): lower case, unique.
    angles : tuple of str
        Names of the fields that are angles.
    centre : (float, float, float)
        Centre of the shape [m].
    """

    kind: ClassVar[str]
    angles: ClassVar[tuple[str, ...]] = ()
    centre: Vector

    @abstractmethod
    def mesh_geometry(self) -> MeshGeometry:
        """Geometry for the mesh generator: a `Prism` or a `Spheroid` about `centre`."""

    @abstractmethod
    def signed_distance(self, points: ArrayLike) -> Array:
        """Signed distance of points (..., 3) from the surface [m], negative inside, shape (...)."""

    @property
    @abstractmethod
    def extent(self) -> Vector:
        """Half sizes of the axis-parallel bounding box about `centre` [m]."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume of the whole shape [m3]."""

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """True for points (..., 3) [m] inside or on the surface, shape (...)."""
        return np.asarray(self.signed_distance(points) <= 0.0)

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates of the shape [m]."""
        (x, y, z), (a, b, c) = self.centre, self.extent
        return (x - a, y - b, z - c), (x + a, y + b, z + c)

    def plan(self, points: int = 64) -> Array:
        """The plan view as a counter-clockwise polygon [m], shape (k, 2), for drawings.

        A circle is approximated by `points` corners.
        """
        geometry = self.mesh_geometry()
        if isinstance(geometry, Prism) and len(geometry.corners):
            return geometry.corners
        radius = geometry.inscribed if isinstance(geometry, Prism) else geometry.radius
        turn = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
        return np.asarray(self.centre[:2] + radius * np.column_stack([np.cos(turn), np.sin(turn)]))

    def check(self) -> None:
        """Raise a ValueError that names the field unless lengths are above 0 and all numbers are finite.

        Shapes with further conditions extend this method.
        """
        for name, value in _values(self).items():
            if name == "centre":
                check_vector(name, value)
            elif name in self.angles:
                check_number(name, value, "an angle in radians", lambda _: True)
            elif _is_triple(type(self), name):
                check_vector(name, value)
                for length in value:
                    check_length(name, length)
            else:
                check_length(name, value)

    def scaled(self, factor: float) -> Self:
        """The shape with all lengths multiplied by `factor`, for example 1e-3 from mm to m."""
        changed: dict[str, Any] = {}
        for name, value in _values(self).items():
            if name not in self.angles:
                changed[name] = tuple(v * factor for v in value) if np.ndim(value) else value * factor
        return replace(self, **changed)

    @property
    def dimensions(self) -> tuple[float, ...]:
        """The lengths other than the centre, in the order of the fields [m]."""
        found: list[float] = []
        for name, value in _values(self).items():
            if name != "centre" and name not in self.angles:
                found += [float(v) for v in np.ravel(value)]
        return tuple(found)

    def encode(self) -> dict[str, Any]:
        """The shape as a dict of numbers and lists by field, with its `kind`; inverse of `decode`."""
        plain: dict[str, Any] = {"kind": self.kind}
        for name, value in _values(self).items():
            plain[name] = [float(v) for v in value] if np.ndim(value) else float(value)
        return plain


@cache  # resolving annotations took half of the time of a plan, of which each poke is checked
def _is_triple(shape: type[Inclusion], name: str) -> bool:
    """True if a field is a triple of lengths, by its annotation."""
    return get_origin(get_type_hints(shape)[name]) is tuple


def _values(shape: Inclusion) -> dict[str, Any]:
    return {f.name: getattr(shape, f.name) for f in fields(shape)}
