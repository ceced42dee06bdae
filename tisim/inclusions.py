"""Rigid inclusions of a soft block: the shapes there are, and how to add one.

A shape is a frozen dataclass that derives from `Inclusion` and is registered:

>>> from dataclasses import dataclass
>>> import numpy as np
>>> from tisim import inclusions
>>>
>>> @dataclass(frozen=True, kw_only=True)
... class SpheroidInclusion(inclusions.Inclusion):
...     '''Rigid spheroid: equatorial radius, half its height, centre [m].'''
...
...     kind = "spheroid"
...     radius: float
...     half_height: float
...
...     def mesh_geometry(self):
...         return inclusions.Spheroid(radius=self.radius, half_height=self.half_height)
...
...     def signed_distance(self, points):  # to first order in the distance
...         p = (np.asarray(points) - self.centre) / (self.radius, self.radius, self.half_height)
...         size = np.linalg.norm(p, axis=-1)
...         return (size - 1.0) * min(self.radius, self.half_height)
...
...     @property
...     def extent(self):
...         return (self.radius, self.radius, self.half_height)
...
...     @property
...     def volume(self):
...         return 4.0 / 3.0 * np.pi * self.radius**2 * self.half_height
>>>
>>> _ = inclusions.register(
...     SpheroidInclusion,
...     recipe=inclusions.RecipeShape(
...         name="spheroid",
...         parameters=(inclusions.RecipeParameter("radius"), inclusions.RecipeParameter("half_height")),
...         standing=lambda p, x, y, angle: SpheroidInclusion(
...             radius=p["radius"], half_height=p["half_height"], centre=(x, y, p["half_height"])
...         ),
...     ),
... )

From then on blocks take it, the mesh of a poke meets it, and recipes of datasets name it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, ClassVar, Self, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim._checks import FieldError, check_length, check_number, check_vector

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
        Radii of the circles around the centre's (x, y) inside and outside the plan view [m]; equal for a
        round one.
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
        """A prism over a convex polygon, counter-clockwise, that holds `centre` (x, y)."""
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
    [m], or an angle [rad] if `angles` names it. What reaches below the base does not count.

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
        """The shape as the mesh generator needs it: a `Prism` or a `Spheroid` around `centre`."""

    @abstractmethod
    def signed_distance(self, points: ArrayLike) -> Array:
        """Distance of points from the surface [m], negative inside; shape (..., 3) to (...)."""

    @property
    @abstractmethod
    def extent(self) -> Vector:
        """Half sizes of the axis-parallel box around the shape, about `centre` [m]."""

    @property
    @abstractmethod
    def volume(self) -> float:
        """Volume of the whole shape [m3]."""

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which points lie inside or on the surface; shape (..., 3) [m] to (...)."""
        return np.asarray(self.signed_distance(points) <= 0.0)

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest coordinates of the shape [m]."""
        (x, y, z), (a, b, c) = self.centre, self.extent
        return (x - a, y - b, z - c), (x + a, y + b, z + c)

    def plan(self, points: int = 64) -> Array:
        """The plan view as a polygon, counter-clockwise, shape (k, 2) [m]: for drawings."""
        geometry = self.mesh_geometry()
        if isinstance(geometry, Prism) and len(geometry.corners):
            return geometry.corners
        radius = geometry.inscribed if isinstance(geometry, Prism) else geometry.radius
        turn = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
        return np.asarray(self.centre[:2] + radius * np.column_stack([np.cos(turn), np.sin(turn)]))

    def check(self) -> None:
        """Raise a ValueError that names the field unless lengths are above 0 and all numbers are finite.

        A shape with rules of its own extends this.
        """
        for name, value in _values(self).items():
            if name == "centre":
                check_vector(name, value)
            elif name in self.angles:
                check_number(name, value, "an angle in radians", lambda _: True)
            elif np.ndim(value):
                check_vector(name, value, np.size(value))
                for length in value:
                    check_length(name, length)
            else:
                check_length(name, value)

    def scaled(self, factor: float) -> Self:
        """The same shape with all lengths multiplied: from mm to m with 1e-3."""
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
        """The shape as plain numbers and lists under its fields' names, with its `kind`; see `decode`."""
        plain: dict[str, Any] = {"kind": self.kind}
        for name, value in _values(self).items():
            plain[name] = [float(v) for v in value] if np.ndim(value) else float(value)
        return plain


def _values(shape: Inclusion) -> dict[str, Any]:
    return {f.name: getattr(shape, f.name) for f in fields(shape)}


@dataclass(frozen=True, kw_only=True)
class BoxInclusion(Inclusion):
    """Rigid box: size (a, b, c) along its own axes, centre [m], turned by `angle` [rad] about z."""

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


@dataclass(frozen=True)
class RecipeParameter:
    """One length that a recipe gives for a shape.

    Attributes
    ----------
    name : str
        Its name; in a recipe it carries its unit (`radius` is the key `radius_mm`).
    default : float or None
        The value where the recipe gives none; None where it must give one.
    positive : bool
        Above 0; else 0 or above.
    """

    name: str
    default: float | None = field(default=None, kw_only=True)
    positive: bool = field(default=True, kw_only=True)


@dataclass(frozen=True, kw_only=True)
class RecipeShape:
    """How the recipe of a dataset gives a shape that stands on the base of the block.

    All functions take the parameters by name in one unit of length, whichever, and answer in that unit.

    Attributes
    ----------
    name : str
        The shape's `kind` in a recipe ("cube").
    parameters : tuple of RecipeParameter
    standing : callable (parameters, x, y, angle) -> Inclusion
        The shape standing at (x, y), turned by `angle` [rad] about the vertical; its lengths in the unit of
        the parameters, to be `scaled`.
    reach : callable (parameters) -> float, optional
        Largest distance of its points from the vertical axis through its centre.
    top : callable (parameters) -> float, optional
        Height of its highest point above the base.
    turned : bool
        Whether the angle changes it.
    """

    name: str
    parameters: tuple[RecipeParameter, ...]
    standing: Callable[[Mapping[str, float], float, float, float], Inclusion]
    reach: Callable[[Mapping[str, float]], float] | None = None
    top: Callable[[Mapping[str, float]], float] | None = None
    turned: bool = False

    def reach_of(self, parameters: Mapping[str, float]) -> float:
        """Largest distance of the shape's points from its vertical axis, in the parameters' unit."""
        if self.reach is not None:
            return self.reach(parameters)
        geometry = self.standing(parameters, 0.0, 0.0, 0.0).mesh_geometry()
        return geometry.circumscribed if isinstance(geometry, Prism) else geometry.radius

    def top_of(self, parameters: Mapping[str, float]) -> float:
        """Height of the shape's highest point above the base, in the parameters' unit."""
        if self.top is not None:
            return self.top(parameters)
        return float(self.standing(parameters, 0.0, 0.0, 0.0).bounds[1][2])


_SHAPES: dict[str, type[Inclusion]] = {}
_RECIPES: dict[str, RecipeShape] = {}
_RECIPE_OF: dict[str, str] = {}  # the recipe's name by the shape's kind
_Shape = TypeVar("_Shape", bound=type[Inclusion])


def register(shape: _Shape, *, recipe: RecipeShape | None = None) -> _Shape:
    """Add an inclusion shape; also as a decorator.

    Parameters
    ----------
    shape : type
        A frozen dataclass that derives from `Inclusion`.
    recipe : RecipeShape, optional
        How recipes of datasets give it; without one they do not offer it.

    Returns
    -------
    type
        The shape.

    Raises
    ------
    TypeError
        If it is no frozen dataclass that derives from `Inclusion`, or has no `kind`.
    ValueError
        If another shape has its `kind`, or another recipe its name. The same class registered anew (a
        module read again) takes its own place.
    """
    sound = isinstance(shape, type) and issubclass(shape, Inclusion) and is_dataclass(shape)
    if not sound or not shape.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        raise TypeError(f"inclusion: expected a frozen dataclass that derives from Inclusion, got {shape!r}")
    missing = set(shape.angles) - {f.name for f in fields(shape)}
    if not isinstance(getattr(shape, "kind", None), str) or missing:
        wanted = "a class attribute `kind`, and each of `angles` as a field"
        raise TypeError(f"inclusion {shape.__name__}: expected {wanted}")
    _refuse_other(shape.kind, shape)
    if recipe is not None:
        if recipe.name in _RECIPES and _RECIPE_OF.get(shape.kind) != recipe.name:
            raise ValueError(f"inclusion {shape.kind}: another shape's recipe is called {recipe.name!r}")
        _RECIPES[recipe.name] = recipe
        _RECIPE_OF[shape.kind] = recipe.name
    _SHAPES[shape.kind] = shape
    return shape


def _refuse_other(kind: str, shape: type[Inclusion]) -> None:
    known = _SHAPES.get(kind)
    if known is None or (known.__module__, known.__qualname__) == (shape.__module__, shape.__qualname__):
        return
    raise ValueError(f"inclusion: {known.__module__}.{known.__qualname__} is the shape {kind!r} already")


def kinds() -> tuple[str, ...]:
    """Kinds of all shapes, in the order of their registration: "box", "sphere", "cylinder", then others."""
    return tuple(_SHAPES)


def get(kind: str) -> type[Inclusion]:
    """The class of a kind; ValueError, which names the kinds there are, for another."""
    try:
        return _SHAPES[kind]
    except (KeyError, TypeError):
        raise ValueError(f"inclusion: expected one of {', '.join(_SHAPES)}, got {kind!r}") from None


def recipe_shapes() -> dict[str, RecipeShape]:
    """Shapes that the recipes of datasets may name, by that name: "cube", "sphere", "cylinder", others."""
    return dict(_RECIPES)


def decode(plain: Mapping[str, Any]) -> Inclusion:
    """The inclusion that `Inclusion.encode` made plain.

    Raises
    ------
    ValueError
        For an unknown kind, missing or unknown fields, or values that are not numbers.
    """
    values = dict(plain)
    shape = get(values.pop("kind", ""))
    names = {f.name for f in fields(shape)}
    if set(values) != names:
        raise ValueError(f"inclusion {shape.kind}: expected {', '.join(sorted(names))}, got {sorted(values)}")
    try:
        made: dict[str, Any] = {
            k: tuple(float(x) for x in v) if np.ndim(v) else float(v) for k, v in values.items()
        }
    except (TypeError, ValueError):
        raise ValueError(f"inclusion {shape.kind}: expected numbers, got {values}") from None
    found = shape(**made)
    found.check()
    return found


def from_dimensions(kind: str, dimensions: ArrayLike, centre: ArrayLike, angle: float = 0.0) -> Inclusion:
    """The inclusion with these `dimensions` (further ones are ignored), centre [m] and angle [rad]."""
    shape = get(kind)
    hints = get_type_hints(shape)
    left = [float(v) for v in np.ravel(np.asarray(dimensions, dtype=float))]
    made: dict[str, Any] = {"centre": tuple(float(v) for v in np.ravel(np.asarray(centre, dtype=float)))}
    for f in fields(shape):
        if f.name in shape.angles:
            made[f.name] = float(angle)
        elif f.name != "centre":
            count = len(get_args(hints[f.name])) or 1
            values, left = left[:count], left[count:]
            if len(values) < count:
                raise ValueError(f"inclusion {kind}: too few dimensions, got {np.ravel(dimensions).tolist()}")
            made[f.name] = tuple(values) if count > 1 else values[0]
    found = shape(**made)
    found.check()
    return found


def _box_standing(p: Mapping[str, float], x: float, y: float, angle: float) -> Inclusion:
    side = p["side"]
    return BoxInclusion(size=(side, side, side), centre=(x, y, side / 2), angle=angle)


register(
    BoxInclusion,
    recipe=RecipeShape(
        name="cube",
        parameters=(RecipeParameter("side"),),
        standing=_box_standing,
        reach=lambda p: p["side"] / 2**0.5,
        top=lambda p: p["side"],
        turned=True,
    ),
)
register(
    SphereInclusion,
    recipe=RecipeShape(
        name="sphere",
        parameters=(RecipeParameter("radius"), RecipeParameter("sunk", default=0.0, positive=False)),
        standing=lambda p, x, y, _: SphereInclusion(
            radius=p["radius"], centre=(x, y, p["radius"] - p["sunk"])
        ),
        reach=lambda p: p["radius"],
        top=lambda p: 2 * p["radius"] - p["sunk"],
    ),
)
register(
    CylinderInclusion,
    recipe=RecipeShape(
        name="cylinder",
        parameters=(RecipeParameter("radius"), RecipeParameter("height")),
        standing=lambda p, x, y, _: CylinderInclusion(
            radius=p["radius"], height=p["height"], centre=(x, y, p["height"] / 2)
        ),
        reach=lambda p: p["radius"],
        top=lambda p: p["height"],
    ),
)

__all__ = [
    "BoxInclusion",
    "CylinderInclusion",
    "FieldError",
    "Inclusion",
    "MeshGeometry",
    "Prism",
    "RecipeParameter",
    "RecipeShape",
    "SphereInclusion",
    "Spheroid",
    "Vector",
    "decode",
    "from_dimensions",
    "get",
    "kinds",
    "recipe_shapes",
    "register",
]
