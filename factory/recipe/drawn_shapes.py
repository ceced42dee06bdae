"""Shapes of a recipe that are drawn from ranges of their lengths (mm), and blocks that are drawn with them.

An entry with the key `draw` gives that number of shapes, each length drawn uniformly from an interval:

    {kind: cube, id: cube, draw: 12, side_mm: [6, 26]}

They are drawn when the recipe is read, and are then shapes like any others. With `cover_mm` in such an entry,
the thicknesses of the tissue above them are spread evenly in their logarithm over that interval:

    {kind: cylinder, id: disc, draw: 12, radius_mm: [6, 14], height_mm: [8, 29], cover_mm: [3, 24]}

If a side of the recipe's `block_mm` is an interval, or an entry states a `block_mm` in place of the recipe's,
each shape has a block of its own. Its sides are drawn together with the shape's lengths, so that it fits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
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

from factory.recipe.shapes import Name, Natural, Positive, Room, Shape, as_model, check_names, of_its_kind
from factory.strict_yaml import Strict, nested_problems
from tisim import inclusions
from tisim.inclusions import RecipeShape

_DIGITS = 2  # decimals of drawn lengths [mm]
_DRAWS = 1000  # attempts to draw one shape, or its block, that fits


def _in_order(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"expected the smaller of two lengths first, got {value[0]:g} and {value[1]:g}")
    return value


_STRICT = ConfigDict(strict=True, allow_inf_nan=False)
_ONE: TypeAdapter[float] = TypeAdapter(Positive, config=_STRICT)
_BETWEEN: TypeAdapter[tuple[float, float]] = TypeAdapter(
    Annotated[tuple[Positive, Positive], AfterValidator(_in_order)], config=_STRICT
)


def _side(value: object) -> object:
    """Validate a side as the one or the other, so that a fault has no key of both."""
    try:
        return (_BETWEEN if isinstance(value, tuple) else _ONE).validate_python(value)
    except ValidationError as error:
        raise nested_problems(error) from None


Side = Annotated[float | tuple[float, float], BeforeValidator(_side)]
Sides = tuple[Side, Side, Side]


class Drawn(Strict):
    """Shapes of one kind with random lengths.

    Attributes
    ----------
    kind : str
    id : str
        Prefix of their names: `ID-01`, `ID-02` and so on.
    draw : int
        Number of shapes.
    cover_mm : (float, float) or None
        Interval of the thickness of the tissue above them. Of the shapes within it, one under a thickness c
        is kept with the probability min(cover_mm) / c: thicknesses that were spread evenly, as those over
        cylinders of drawn heights, are then so in their logarithm.

    Each length is one number, or an interval from which it is drawn for each shape.
    """

    kind: str
    id: Annotated[Name, Field(max_length=50)]
    draw: Annotated[int, Field(ge=1, le=10_000)]
    cover_mm: Annotated[tuple[Positive, Positive], AfterValidator(_in_order)] | None = None

    def names(self) -> list[str]:
        """Names of the shapes."""
        digits = max(2, len(str(self.draw)))
        return [f"{self.id}-{k + 1:0{digits}}" for k in range(self.draw)]

    def one(self, name: str, random: np.random.Generator) -> dict[str, Any]:
        """Draw the entry of one shape, which need not fit."""
        drawn = {
            f"{p.name}_mm": _between(getattr(self, f"length_{k}"), random)
            for k, p in enumerate(inclusions.recipe_shapes()[self.kind].parameters)
        }
        return {"kind": self.kind, "id": name, **drawn}

    def fault_of_cover(self, cover: float, random: np.random.Generator) -> str | None:
        """Reason why a shape under this thickness [mm] is not taken; None if it is."""
        if self.cover_mm is None:
            return None
        thin, thick = self.cover_mm
        if not thin <= cover <= thick:
            return f"the {cover:g} mm above it are not within cover_mm = {thin:g} to {thick:g}"
        return None if random.uniform() * cover < thin else "it was not among those that are kept"


def _between(length: float | tuple[float, float], random: np.random.Generator) -> float:
    """A length that is stated, or drawn from an interval."""
    low, high = length if isinstance(length, tuple) else (length, length)
    return low if low == high else round(float(random.uniform(low, high)), _DIGITS)


def _as_range(value: object) -> object:
    return value if isinstance(value, tuple) else (value, value)


@lru_cache(maxsize=64)
def _drawn_model(shape: RecipeShape) -> type[Drawn]:
    """Pydantic model of drawn shapes of one kind, with their lengths as keys."""
    keys: dict[str, Any] = {"kind": (Literal[shape.name], ...)}
    for k, p in enumerate(shape.parameters):
        one: Any = Positive if p.positive else Natural
        both = Annotated[tuple[one, one], BeforeValidator(_as_range), AfterValidator(_in_order)]
        default: Any = ... if p.default is None else (p.default, p.default)
        keys[f"length_{k}"] = (both, Field(default, alias=f"{p.name}_mm"))
    model: type[Drawn] = create_model(shape.name, __base__=Drawn, **keys)
    return model


_SHAPE: TypeAdapter[Shape] = TypeAdapter(Annotated[Shape, BeforeValidator(of_its_kind)])
_SIDES: TypeAdapter[Sides] = TypeAdapter(Sides, config=_STRICT)
_DRAWN: TypeAdapter[Drawn] = TypeAdapter(
    Annotated[Drawn, BeforeValidator(lambda entry: as_model(entry, _drawn_model))]
)


class _Ground(BaseModel):
    """Keys of `factory.recipe.Recipe` that drawn shapes and blocks depend on."""

    model_config = ConfigDict(extra="ignore", strict=True, allow_inf_nan=False)

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    block_mm: Sides
    border_mm: Natural
    cover_mm: Natural

    def fitting(
        self,
        draw: Callable[[], dict[str, Any]],
        sides: Sides | None,
        random: np.random.Generator,
        what: str,
        fault_of_cover: Callable[[float, np.random.Generator], str | None] = lambda *_: None,
    ) -> dict[str, Any]:
        """Draw a shape's entry and its block until the one fits in the other.

        Parameters
        ----------
        draw : callable
            Draws the entry of a shape; it need not fit.
        sides : tuple or None
            Sides of the block that the shape gets for its own; None if it stands in the recipe's.
        random : numpy.random.Generator
        what : str
            Name of what is drawn, for the ValueError if nothing is found that fits.
        fault_of_cover : callable
            Reason why a shape under some thickness of tissue [mm] is not taken, or None.
        """
        fault = None
        for _ in range(_DRAWS):
            entry = draw()
            x, y, z = (_between(side, random) for side in sides or self.block_mm)
            room = Room(block_mm=(x, y, z), border_mm=self.border_mm, cover_mm=self.cover_mm)
            shape = _SHAPE.validate_python(entry)
            fault = room.fault(shape) or fault_of_cover(z - shape.top_mm, random)
            if fault is None:
                return entry if sides is None else {**entry, "block_mm": room.block_mm}
        raise ValueError(f"{what}: none of {_DRAWS} drawn fits; of the last, {fault}")


def with_drawn_shapes(recipe: object) -> object:
    """Draw what a recipe leaves open: shapes of entries with the key `draw`, and blocks of their own.

    If a side of the recipe's block is an interval, or an entry states a block, every shape has its own
    afterwards. The random generator is seeded with the recipe's seed and the entry's index.
    """
    shapes = recipe.get("shapes") if isinstance(recipe, Mapping) else None
    if not isinstance(shapes, tuple):
        return recipe
    assert isinstance(recipe, Mapping)
    own_blocks = _is_open(recipe.get("block_mm")) or any(_states(entry, "block_mm") for entry in shapes)
    if not own_blocks and not any(_states(entry, "draw") for entry in shapes):
        return recipe
    try:
        ground = _Ground.model_validate(recipe)
    except ValidationError as error:
        raise nested_problems(error) from None
    found: list[object] = []
    for number, entry in enumerate(shapes):
        if not isinstance(entry, Mapping):
            found.append(entry)  # the model reports it
            continue
        if (shape := inclusions.recipe_shapes().get(str(entry.get("kind")))) is not None:
            check_names(shape)
        random = np.random.default_rng([ground.seed, number])
        sides = (_own(entry, number) or ground.block_mm) if own_blocks else None
        if _states(entry, "draw"):
            found += _drawn_shapes(entry, number, ground, sides, random)
        else:
            found.append(_stated_shape(entry, number, ground, sides, random))
    return {**recipe, "shapes": tuple(found)}


def _is_open(sides: object) -> bool:
    return isinstance(sides, tuple) and any(isinstance(side, tuple) for side in sides)


def _states(entry: object, key: str) -> bool:
    return isinstance(entry, Mapping) and key in entry


def _own(entry: Mapping[str, Any], number: int) -> Sides | None:
    """Sides of the block that an entry states."""
    if "block_mm" not in entry:
        return None
    try:
        return _SIDES.validate_python(entry["block_mm"])
    except ValidationError as error:
        raise nested_problems(error, under=("shapes", number, "block_mm")) from None


def _drawn_shapes(
    entry: Mapping[str, Any], number: int, ground: _Ground, sides: Sides | None, random: np.random.Generator
) -> list[dict[str, Any]]:
    """The entries of drawn shapes."""
    try:
        drawn = _DRAWN.validate_python(_without_block(entry))
    except ValidationError as error:
        raise nested_problems(error, under=("shapes", number)) from None
    if drawn.cover_mm is not None and drawn.cover_mm[0] < ground.cover_mm:
        raise ValueError(
            f"shapes.{drawn.id}: cover_mm: expected at least the recipe's cover_mm = {ground.cover_mm:g}, "
            f"got {drawn.cover_mm[0]:g}"
        )
    what = f"shapes.{drawn.id}"
    return [
        ground.fitting(partial(drawn.one, name, random), sides, random, what, drawn.fault_of_cover)
        for name in drawn.names()
    ]


def _stated_shape(
    entry: Mapping[str, Any], number: int, ground: _Ground, sides: Sides | None, random: np.random.Generator
) -> Mapping[str, Any]:
    """The entry of a stated shape; with a block that it fits, if shapes have their own."""
    if not _is_open(sides):
        return entry if sides is None else {**entry, "block_mm": sides}
    lengths = _without_block(entry)
    try:
        shape = _SHAPE.validate_python(lengths)
    except ValidationError as error:
        raise nested_problems(error, under=("shapes", number)) from None
    return ground.fitting(lambda: lengths, sides, random, f"shapes.{shape.id}: block_mm")


def _without_block(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entry.items() if key != "block_mm"}
