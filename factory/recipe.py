"""Recipes: what a dataset contains, read from YAML (lengths in mm, angles in degrees).

Inclusion shapes are those of `tisim.inclusions.recipe_shapes()`: one that is registered there is known here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    ValidationError,
    create_model,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from factory._course import Piece, check_pieces
from factory._input import InputError, Strict, nested_problems, read_yaml, shipped_folder
from tisim import inclusions
from tisim.inclusions import Inclusion, RecipeShape

Positive = Annotated[float, Field(gt=0, le=1e6)]
Natural = Annotated[float, Field(ge=0, le=1e6)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=60)]

_MM = 1e-3
_THINNEST_MM = 1.0  # what tisim's meshes need above and beside an inclusion, and of it above the base


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
        """A turn about the vertical changes it."""
        return self._shape.turned

    def standing(self, x_mm: float, y_mm: float, angle: float) -> Inclusion:
        """The inclusion [m] at a place of the base [mm], turned by an angle [rad]."""
        return self._shape.standing(self.lengths_mm, x_mm, y_mm, angle).scaled(_MM)

    @property
    def _shape(self) -> RecipeShape:
        return inclusions.recipe_shapes()[self.kind]


@lru_cache(maxsize=64)
def _shape_model(shape: RecipeShape) -> type[Shape]:
    """The model of one kind of inclusion, with its lengths as keys."""
    keys: dict[str, Any] = {"kind": (Literal[shape.name], ...)}
    keys |= {
        f"{p.name}_mm": (Positive if p.positive else Natural, ... if p.default is None else p.default)
        for p in shape.parameters
    }
    model: type[Shape] = create_model(shape.name, __base__=Shape, **keys)
    return model


def _of_its_kind(value: object) -> object:
    """A recipe's entry as the model of its kind."""
    if not isinstance(value, Mapping) or "kind" not in value:
        return value  # the base model says what is missing
    known, kind = inclusions.recipe_shapes(), value["kind"]
    if not isinstance(kind, str) or kind not in known:
        names = ", ".join(repr(name) for name in known)
        raise PydanticCustomError("kind", f"expected as kind one of {names}, got {str(kind)[:40]!r}")
    try:
        return _shape_model(known[kind]).model_validate(value)
    except ValidationError as error:
        raise nested_problems(error) from None


class RodRecipe(Strict):
    """The indenter: a rigid round rod.

    Attributes
    ----------
    radius_mm, length_mm : float
    tip : {"flat", "hemisphere"}
    edge_radius_mm : float
        Radius of the rounded edge of a flat tip.
    """

    radius_mm: Positive
    length_mm: Positive
    tip: Literal["flat", "hemisphere"] = "flat"
    edge_radius_mm: Positive = 1.0

    @model_validator(mode="after")
    def _rounded(self) -> Self:
        if self.tip == "flat" and self.edge_radius_mm > self.radius_mm:
            raise ValueError(
                f"edge_radius_mm: expected at most the rod's radius of {self.radius_mm:g}, "
                f"got {self.edge_radius_mm:g}"
            )
        return self


class Protocol(Strict):
    """Where and how each shape is poked.

    Attributes
    ----------
    shared_sites : int
        Contact points (with their directions) common to all material levels of a shape.
    own_sites : int
        Contact points drawn for each material level.
    margin_mm : float
        Least distance of a contact point from the edges of the top face.
    max_angle_deg : float
        Largest angle between the push and the surface normal; drawn uniformly from 0.
    depth_mm : float
        Travel of the indenter from first touch.
    frame_spacing_mm : float
        Travel between two frames.
    course : tuple of RampRecipe and HoldRecipe
        The rod's ramps and holds one after the other, the first from first touch, the deepest to `depth_mm`.
        Empty: the rod is pushed to `depth_mm`, and there is no time.
    """

    shared_sites: Annotated[int, Field(ge=0, le=10_000)]
    own_sites: Annotated[int, Field(ge=0, le=10_000)]
    margin_mm: Natural
    max_angle_deg: Annotated[float, Field(ge=0, le=45)]
    depth_mm: Positive
    frame_spacing_mm: Positive
    course: tuple[Piece, ...] = ()

    @model_serializer(mode="wrap")
    def _without_an_empty_course(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Recipes without a course are written, and so named, as they were before there were courses."""
        written: dict[str, Any] = write(self)
        return written if self.course else {k: v for k, v in written.items() if k != "course"}

    @model_validator(mode="after")
    def _driven(self) -> Self:
        check_pieces(self.course, self.depth_mm)
        return self

    @model_validator(mode="after")
    def _some(self) -> Self:
        if self.shared_sites + self.own_sites == 0:
            raise ValueError("shared_sites and own_sites are both 0: expected at least one poke")
        return self


class Recipe(Strict):
    """One dataset: shapes x material levels x contact points.

    Attributes
    ----------
    name, description : str
    seed : int
        All places, directions and turns are drawn from it.
    block_mm : (float, float, float)
        Sides of the block.
    rod : RodRecipe
    friction : float
        Coulomb coefficient between indenter and block.
    protocol : Protocol
    levels : tuple of str
        Material levels: names of material cards (key `softness` in YAML and in stores).
    border_mm : float
        Least distance of an inclusion from the sides of the block.
    cover_mm : float
        Least silicone above an inclusion.
    refinement : float
        Elements get smaller by this factor.
    shapes : tuple of Shape
        Inclusions, one at a time.
    """

    name: Name
    description: str
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    block_mm: tuple[Positive, Positive, Positive]
    rod: RodRecipe
    friction: Annotated[float, Field(ge=0, le=10)]
    protocol: Protocol
    levels: Annotated[tuple[Name, ...], Field(min_length=1, alias="softness")]
    border_mm: Natural
    cover_mm: Natural
    refinement: Annotated[float, Field(ge=0.1, le=10)] = 1.0
    shapes: Annotated[
        tuple[Annotated[SerializeAsAny[Shape], BeforeValidator(_of_its_kind)], ...], Field(min_length=1)
    ]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for label, names in (("softness", self.levels), ("shapes", tuple(s.id for s in self.shapes))):
            if len(set(names)) < len(names):
                raise ValueError(f"{label}: expected different names")
        _check_protocol(self)
        for shape in self.shapes:
            _check_shape(self, shape)
        return self

    @property
    def pokes_each(self) -> int:
        """Pokes of one shape at one material level."""
        return self.protocol.shared_sites + self.protocol.own_sites

    def identity(self) -> dict[str, Any]:
        """The recipe as plain values under the keys of its YAML file."""
        return self.model_dump(mode="json", by_alias=True)

    def with_levels(self, levels: Sequence[str]) -> Recipe:
        """The same recipe at other material levels; InputError where they are no names, or not different."""
        try:
            return Recipe.model_validate({**self.model_dump(by_alias=True), "softness": tuple(levels)})
        except ValidationError:
            raise InputError(
                f"--levels {','.join(levels)}: expected different names of cards, with commas between"
            ) from None


def _check_protocol(recipe: Recipe) -> None:
    protocol, height = recipe.protocol, recipe.block_mm[2]
    if protocol.depth_mm >= height:
        raise ValueError(
            f"protocol.depth_mm: expected less than the block's height of {height:g} mm, "
            f"got {protocol.depth_mm:g}"
        )
    if 2 * protocol.margin_mm >= min(recipe.block_mm[:2]):
        raise ValueError("protocol.margin_mm: expected less than half of the block's sides")
    footprint = recipe.rod.radius_mm / math.cos(math.radians(protocol.max_angle_deg))
    if protocol.margin_mm < footprint:
        raise ValueError(
            f"protocol.margin_mm: expected at least {footprint:.3g} mm, so that the rod of radius "
            f"{recipe.rod.radius_mm:g} mm lands within the top at up to {protocol.max_angle_deg:g} degrees, "
            f"got {protocol.margin_mm:g}"
        )


def _check_shape(recipe: Recipe, shape: Shape) -> None:
    height, cover = recipe.block_mm[2], max(recipe.cover_mm, _THINNEST_MM)
    if shape.top_mm < _THINNEST_MM:
        raise ValueError(
            f"shapes.{shape.id}: its top is at {shape.top_mm:g} mm: expected at least {_THINNEST_MM:g} mm "
            "of it above the base"
        )
    if shape.top_mm + cover > height:
        raise ValueError(
            f"shapes.{shape.id}: its top at {shape.top_mm:g} mm leaves less than cover_mm = "
            f"{cover:g} of {height:g} mm above it"
        )
    if shape.reach_mm + max(recipe.border_mm, _THINNEST_MM) > min(recipe.block_mm[:2]) / 2:
        raise ValueError(f"shapes.{shape.id}: wider than the block less border_mm")


def recipe_names() -> list[str]:
    """Names of the recipes that come with the package."""
    return sorted(path.stem for path in shipped_folder("recipes").glob("*.yaml"))


def load_recipe(name_or_path: str | Path) -> Recipe:
    """Read a recipe.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a recipe that comes with the package ("quick"), or path of a YAML file.

    Raises
    ------
    InputError
        Where there is no such recipe, or the file does not hold one.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith((".yaml", ".yml")) or "/" in text:
        return read_yaml(Path(text), Recipe)
    path = shipped_folder("recipes") / f"{text}.yaml"
    if not path.is_file():
        known = ", ".join(recipe_names()) or "none"
        raise InputError(f"--recipe {text}: expected a path of a YAML file or one of: {known}")
    return read_yaml(path, Recipe)
