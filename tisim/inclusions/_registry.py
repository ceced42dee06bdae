"""Registry of the inclusion shapes by kind, and decoding of shapes from plain numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from tisim.inclusions._recipe import RecipeShape
from tisim.inclusions._shape import Inclusion

_SHAPES: dict[str, type[Inclusion]] = {}
_RECIPES: dict[str, RecipeShape] = {}
_RECIPE_OF: dict[str, str] = {}  # the recipe's name by the shape's kind
_Shape = TypeVar("_Shape", bound=type[Inclusion])


def register(shape: _Shape, *, recipe: RecipeShape | None = None) -> _Shape:
    """Add an inclusion shape; also usable as a decorator.

    Parameters
    ----------
    shape : type
        A frozen dataclass that derives from `Inclusion`.
    recipe : RecipeShape, optional
        Description of the shape in recipes of datasets; without it recipes cannot use the shape.

    Returns
    -------
    type
        The shape.

    Raises
    ------
    TypeError
        If it is not a frozen dataclass that derives from `Inclusion`, has no `kind`, or one of its `angles`
        is not a field.
    ValueError
        If another shape has its `kind`, or another recipe its name. The same class registered again (from a
        module that is reloaded) replaces itself.
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
    """The class of a kind; ValueError, which lists the known kinds, for an unknown one."""
    try:
        return _SHAPES[kind]
    except (KeyError, TypeError):
        raise ValueError(f"inclusion: expected one of {', '.join(_SHAPES)}, got {kind!r}") from None


def recipe_shapes() -> dict[str, RecipeShape]:
    """Shapes for recipes of datasets by their name there: "cube", "sphere", "cylinder", then others."""
    return dict(_RECIPES)


def decode(plain: Mapping[str, Any]) -> Inclusion:
    """The inclusion that `Inclusion.encode` encoded.

    Raises
    ------
    ValueError
        For an unknown kind, missing or unknown fields, or invalid values.
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
    """The inclusion with the given `dimensions` (surplus ones are ignored), centre [m] and angle [rad]."""
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
