"""The shapes of a recipe: inclusions stated one by one, or drawn from ranges of their lengths (mm).

Inclusion shapes are those of `tisim.inclusions.recipe_shapes()`: one that is registered there is known here.
An entry with the key `draw` gives that number of shapes, each length drawn uniformly from an interval:

    {kind: cube, id: cube, draw: 12, side_mm: [6, 26]}

They are drawn when the recipe is read, and are then shapes like any others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    create_model,
)
from pydantic_core import PydanticCustomError

from factory._input import Strict, nested_problems
from tisim import inclusions
from tisim.inclusions import Inclusion, RecipeShape

Positive = Annotated[float, Field(gt=0, le=1e6)]
Natural = Annotated[float, Field(ge=0, le=1e6)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=60)]

_MM = 1e-3
_THINNEST_MM = 1.0  # least that tisim's meshes need above and beside an inclusion, and of it above the base
_DIGITS = 2  # decimals of drawn lengths [mm]
_DRAWS = 1000  # attempts to draw one shape that fits


class Shape(Strict):
    """An inclusion standing on the base: a kind of `tisim.inclusions`, its id, and lengths as NAME_mm.

    Attributes
    ----------
    kind : str
        Name of a shape that recipes offer ("cube", "sphere", "cylinder", or one that was registered).
    id : str
        Name of this inclusion within the recipe.
    """

    kind: str
    id: Name

    @property
    def lengths_mm(self) -> dict[str, float]:
        """Its parameters by name, without the unit [mm]."""
        return {p.name: getattr(self, f"{p.name}_mm") for p in self._shape.parameters}

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
    keys |= {
        f"{p.name}_mm": (Positive if p.positive else Natural, ... if p.default is None else p.default)
        for p in shape.parameters
    }
    model: type[Shape] = create_model(shape.name, __base__=Shape, **keys)
    return model


def of_its_kind(value: object) -> object:
    """Validate a recipe's entry with the model of its kind."""
    return _as_model(value, _shape_model)


def _as_model(value: object, model: Callable[[RecipeShape], type[Strict]]) -> object:
    if not isinstance(value, Mapping) or "kind" not in value:
        return value  # the base model reports what is missing
    known, kind = inclusions.recipe_shapes(), value["kind"]
    if not isinstance(kind, str) or kind not in known:
        names = ", ".join(repr(name) for name in known)
        raise PydanticCustomError("kind", f"expected as kind one of {names}, got {str(kind)[:40]!r}")
    try:
        return model(known[kind]).model_validate(value)
    except ValidationError as error:
        raise nested_problems(error) from None


_SHAPE: TypeAdapter[Shape] = TypeAdapter(Annotated[Shape, BeforeValidator(of_its_kind)])


@dataclass(frozen=True, kw_only=True)
class Room:
    """Space for inclusions in a block [mm]; fields as in `factory.recipe.Recipe`."""

    block_mm: tuple[float, float, float]
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


class Drawn(Strict):
    """Shapes of one kind with random lengths.

    Attributes
    ----------
    kind : str
    id : str
        Prefix of their names: `ID-01`, `ID-02` and so on.
    draw : int
        Number of shapes.

    Each length is one number, or an interval from which it is drawn for each shape.
    """

    kind: str
    id: Annotated[Name, Field(max_length=50)]
    draw: Annotated[int, Field(ge=1, le=10_000)]

    def shapes(self, room: Room, random: np.random.Generator) -> list[dict[str, Any]]:
        """Draw the entries of the shapes; ValueError if none is found that fits."""
        digits = max(2, len(str(self.draw)))
        return [self._one(f"{self.id}-{k + 1:0{digits}}", room, random) for k in range(self.draw)]

    def _one(self, name: str, room: Room, random: np.random.Generator) -> dict[str, Any]:
        fault = None
        for _ in range(_DRAWS):
            entry: dict[str, Any] = {"kind": self.kind, "id": name}
            for p in inclusions.recipe_shapes()[self.kind].parameters:
                low, high = getattr(self, f"{p.name}_mm")
                drawn = low if low == high else round(float(random.uniform(low, high)), _DIGITS)
                entry[f"{p.name}_mm"] = drawn
            fault = room.fault(_SHAPE.validate_python(entry))
            if fault is None:
                return entry
        raise ValueError(f"shapes.{self.id}: none of {_DRAWS} drawn fits; of the last, {fault}")


def _as_range(value: object) -> object:
    return value if isinstance(value, tuple) else (value, value)


def _in_order(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"expected the smaller of two lengths first, got {value[0]:g} and {value[1]:g}")
    return value


@lru_cache(maxsize=64)
def _drawn_model(shape: RecipeShape) -> type[Drawn]:
    """Pydantic model of drawn shapes of one kind, with their lengths as keys."""
    keys: dict[str, Any] = {"kind": (Literal[shape.name], ...)}
    for p in shape.parameters:
        one: Any = Positive if p.positive else Natural
        both = Annotated[tuple[one, one], BeforeValidator(_as_range), AfterValidator(_in_order)]
        keys[f"{p.name}_mm"] = (both, ... if p.default is None else (p.default, p.default))
    model: type[Drawn] = create_model(shape.name, __base__=Drawn, **keys)
    return model


_DRAWN: TypeAdapter[Drawn] = TypeAdapter(
    Annotated[Drawn, BeforeValidator(lambda entry: _as_model(entry, _drawn_model))]
)


class _Ground(BaseModel):
    """Keys of `factory.recipe.Recipe` that drawn shapes depend on."""

    model_config = ConfigDict(extra="ignore", strict=True, allow_inf_nan=False)

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    block_mm: tuple[Positive, Positive, Positive]
    border_mm: Natural
    cover_mm: Natural


def with_drawn_shapes(recipe: object) -> object:
    """Replace each entry of a recipe's `shapes` that has a key `draw` by the shapes drawn.

    The random generator is seeded with the recipe's seed and the entry's index.
    """
    shapes = recipe.get("shapes") if isinstance(recipe, Mapping) else None
    if not isinstance(shapes, tuple) or not any(_is_drawn(entry) for entry in shapes):
        return recipe
    assert isinstance(recipe, Mapping)
    try:
        ground = _Ground.model_validate(recipe)
    except ValidationError as error:
        raise nested_problems(error) from None
    room = Room(**ground.model_dump(exclude={"seed"}))
    found: list[object] = []
    for number, entry in enumerate(shapes):
        if _is_drawn(entry):
            found += _drawn(entry, number).shapes(room, np.random.default_rng([ground.seed, number]))
        else:
            found.append(entry)
    return {**recipe, "shapes": tuple(found)}


def _is_drawn(entry: object) -> bool:
    return isinstance(entry, Mapping) and "draw" in entry


def _drawn(entry: Mapping[str, Any], number: int) -> Drawn:
    try:
        return _DRAWN.validate_python(entry)
    except ValidationError as error:
        raise nested_problems(error, under=("shapes", number)) from None
