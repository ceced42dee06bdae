"""The shapes of a recipe as it states them, with lengths in mm, and the room for them in a block.

Inclusion shapes are those of `tisim.inclusions.recipe_shapes()`: one that is registered there is known here.
`drawn_shapes` draws those that a recipe leaves open.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    create_model,
    model_serializer,
)
from pydantic_core import PydanticCustomError

from factory.strict_yaml import Strict, nested_problems
from tisim import inclusions
from tisim.inclusions import Inclusion, RecipeShape

Positive = Annotated[float, Field(gt=0, le=1e6)]
Natural = Annotated[float, Field(ge=0, le=1e6)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=60)]

Size = tuple[Positive, Positive, Positive]  # sides along x, y, z

_MM = 1e-3
_THINNEST_MM = 1.0  # least that tisim's meshes need above and beside an inclusion, and of it above the base
_USES = {"block_mm": "the block around it", "cover_mm": "the tissue above it"}  # keys that no parameter has


class Shape(Strict):
    """An inclusion standing on the base: a kind of `tisim.inclusions`, its id, and lengths as NAME_mm.

    Attributes
    ----------
    kind : str
        Name of a shape that recipes offer ("cube", "sphere", "cylinder", or one that was registered).
    id : str
        Name of this inclusion within the recipe.
    block_mm : (float, float, float) or None
        Sides of its own block; None if all shapes have the recipe's.
    """

    kind: str
    id: Name
    block_mm: Size | None = None

    @model_serializer(mode="wrap")
    def _without_the_recipes_block(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit a block that is the recipe's, so that the identity of recipes with one stays as it was."""
        written: dict[str, Any] = write(self)
        return {k: v for k, v in written.items() if k != "block_mm" or self.block_mm is not None}

    @property
    def lengths_mm(self) -> dict[str, float]:
        """Its parameters by name, without the unit [mm]."""
        return {p.name: getattr(self, f"length_{k}") for k, p in enumerate(self._shape.parameters)}

    @property
    def reach_mm(self) -> float:
        """Largest distance of its points from its vertical axis [mm]."""
        return self._shape.reach_of(self.lengths_mm)

    @property
    def top_mm(self) -> float:
        """Height of its highest point above the base [mm]."""
        return self._shape.top_of(self.lengths_mm)

    @property
    def turned(self) -> bool:
        """True if a rotation about the vertical changes it."""
        return self._shape.turned

    def standing(self, x_mm: float, y_mm: float, angle: float) -> Inclusion:
        """The inclusion [m] at a position on the base [mm], rotated about the vertical by an angle [rad]."""
        return self._shape.standing(self.lengths_mm, x_mm, y_mm, angle).scaled(_MM)

    @property
    def _shape(self) -> RecipeShape:
        return inclusions.recipe_shapes()[self.kind]


@lru_cache(maxsize=64)
def _shape_model(shape: RecipeShape) -> type[Shape]:
    """Pydantic model of one kind of inclusion, with its lengths as keys."""
    keys: dict[str, Any] = {"kind": (Literal[shape.name], ...)}
    for k, p in enumerate(shape.parameters):
        default: Any = ... if p.default is None else p.default
        # numbered, since a parameter may be called as an attribute here is ("top")
        keys[f"length_{k}"] = (Positive if p.positive else Natural, Field(default, alias=f"{p.name}_mm"))
    model: type[Shape] = create_model(shape.name, __base__=Shape, **keys)
    return model


def check_names(shape: RecipeShape) -> None:
    """Refuse a shape with a parameter whose key has another meaning in recipes."""
    for key in (f"{p.name}_mm" for p in shape.parameters):
        if key in _USES:
            raise ValueError(
                f"kind {shape.name}: expected another name of its parameter, since recipes use {key} "
                f"for {_USES[key]}"
            )


def of_its_kind(value: object) -> object:
    """Validate a recipe's entry with the model of its kind."""
    return as_model(value, _shape_model)


def as_model(value: object, model: Callable[[RecipeShape], type[Strict]]) -> object:
    if not isinstance(value, Mapping) or "kind" not in value:
        return value  # the base model reports what is missing
    known, kind = inclusions.recipe_shapes(), value["kind"]
    if not isinstance(kind, str) or kind not in known:
        names = ", ".join(repr(name) for name in known)
        raise PydanticCustomError("kind", f"expected as kind one of {names}, got {str(kind)[:40]!r}")
    check_names(known[kind])
    try:
        return model(known[kind]).model_validate(value)
    except ValidationError as error:
        raise nested_problems(error) from None


@dataclass(frozen=True, kw_only=True)
class Room:
    """Space for inclusions in a block [mm]; fields as in `factory.recipe.Recipe`."""

    block_mm: Size
    border_mm: float
    cover_mm: float

    def fault(self, shape: Shape) -> str | None:
        """Reason why a shape does not fit; None if it does."""
        height, cover, top = self.block_mm[2], max(self.cover_mm, _THINNEST_MM), shape.top_mm
        if top < _THINNEST_MM:
            least = f"expected at least {_THINNEST_MM:g} mm of it above the base"
            return f"its top is at {top:g} mm: {least}"
        if top + cover > height:
            return f"its top at {top:g} mm leaves less than cover_mm = {cover:g} of {height:g} mm above it"
        if shape.reach_mm + max(self.border_mm, _THINNEST_MM) > min(self.block_mm[:2]) / 2:
            return "wider than the block less border_mm"
        return None
