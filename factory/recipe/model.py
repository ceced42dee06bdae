"""Recipes: what a dataset contains, read from YAML (lengths in mm, angles in degrees)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self, cast

from pydantic import (
    BeforeValidator,
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from factory.bundled import recipe_names, shipped_folder
from factory.errors import InputError
from factory.recipe.course import Piece, check_pieces, travel
from factory.recipe.drawn_shapes import Sides, with_drawn_shapes
from factory.recipe.shapes import Name, Natural, Positive, Room, Shape, Size, of_its_kind
from factory.strict_yaml import Strict, read_yaml, validation_sentence
from tisim import Rod
from tisim.mesh.indentation import CLEARANCE

# As experiments name materials, since `calibration.fit` names a card after its material.
Level = Annotated[str, Field(pattern=r"^\w[\w .,+()%-]*$", max_length=100)]

_MM = 1e-3
SHALLOW, FLAT = 0.01, 1e-3  # of the rod's radius, and the block's height: a depth below both is one in metres
MOST_FRAMES = 10_000  # of one poke in its ramps; a frame takes some 30 kB in memory

__all__ = ["Protocol", "Recipe", "RodRecipe", "Shape", "load_recipe", "recipe_names"]


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

    @property
    def rod(self) -> Rod:
        """The indenter [m]."""
        lengths = (self.radius_mm, self.length_mm, self.edge_radius_mm)
        radius, length, edge = (value * _MM for value in lengths)
        return Rod(radius=radius, length=length, tip=self.tip, edge_radius=edge)

    @model_validator(mode="after")
    def _rounded(self) -> Self:
        if self.tip == "flat" and self.edge_radius_mm > self.radius_mm:
            raise ValueError(
                f"edge_radius_mm: expected at most the rod's radius of {self.radius_mm:g}, "
                f"got {self.edge_radius_mm:g}"
            )
        return self


class Protocol(Strict):
    """Contact points and motion of the indenter, for each shape.

    Attributes
    ----------
    shared_sites : int
        Contact points (with their directions) common to all material levels of a shape.
    own_sites : int
        Contact points drawn for each material level.
    over_inclusion : float
        Fraction of the contact points, in each of the two sets, that are drawn right above the inclusion.
    margin_mm : float
        Least distance of a contact point from the edges of the top face.
    max_angle_deg : float
        Largest angle between the push and the surface normal; drawn uniformly from 0.
    depth_mm : float
        Travel of the indenter from first touch.
    frame_spacing_mm : float
        Travel between two frames.
    course : tuple of RampRecipe and HoldRecipe
        Ramps and holds of the rod in sequence from first touch; the largest depth is `depth_mm`. If empty,
        the rod is pushed to `depth_mm` without time.
    """

    shared_sites: Annotated[int, Field(ge=0, le=10_000)]
    own_sites: Annotated[int, Field(ge=0, le=10_000)]
    over_inclusion: Annotated[float, Field(ge=0, le=1)] = 0.0
    margin_mm: Natural
    max_angle_deg: Annotated[float, Field(ge=0, le=45)]
    depth_mm: Positive
    frame_spacing_mm: Positive
    course: tuple[Piece, ...] = ()

    @model_serializer(mode="wrap")
    def _without_what_is_not_asked_for(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit later keys that are not used, so that the identity of recipes without them stays as it was."""
        written: dict[str, Any] = write(self)
        later = ("course", "over_inclusion")
        return {k: v for k, v in written.items() if k not in later or getattr(self, k)}

    def is_over_inclusion(self, number: int) -> bool:
        """True if the contact point of this number in its set is drawn above the inclusion."""
        # spread evenly over the set, so that a part of a dataset has as many
        first, last = (math.floor(k * self.over_inclusion + 1e-9) for k in (number, number + 1))
        return last > first

    @model_validator(mode="after")
    def _driven(self) -> Self:
        check_pieces(self.course, self.depth_mm)
        least = travel(self.course, self.depth_mm) / MOST_FRAMES
        if self.frame_spacing_mm < least:
            raise ValueError(
                f"frame_spacing_mm: expected at least {least:.3g}, which is {MOST_FRAMES} frames a poke, "
                f"got {self.frame_spacing_mm:g}"
            )
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
        Seed of all positions, directions and rotations.
    block_mm : tuple of float or (float, float), length 3
        Sides of the block. Of a side that is an interval, each shape has one of its own (`block_of`).
    rod : RodRecipe
    friction : float
        Coulomb coefficient between indenter and block.
    protocol : Protocol
    levels : tuple of str
        Material levels: names of material cards (key `softness` in YAML and in stores).
    border_mm : float
        Least distance of an inclusion from the sides of the block.
    cover_mm : float
        Least thickness of silicone above an inclusion.
    refinement : float
        Factor by which elements are smaller.
    shapes : tuple of Shape
        Inclusions, one per poke.
    """

    name: Name
    description: str
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    block_mm: Sides
    rod: RodRecipe
    friction: Annotated[float, Field(ge=0, le=10)]
    protocol: Protocol
    levels: Annotated[tuple[Level, ...], Field(min_length=1, alias="softness")]
    border_mm: Natural
    cover_mm: Natural
    refinement: Annotated[float, Field(ge=0.5, le=6)] = 1.0
    shapes: Annotated[
        tuple[Annotated[SerializeAsAny[Shape], BeforeValidator(of_its_kind)], ...], Field(min_length=1)
    ]

    @model_validator(mode="before")
    @classmethod
    def _with_shapes_drawn(cls, recipe: object) -> object:
        return with_drawn_shapes(recipe)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for label, names in (("softness", self.levels), ("shapes", tuple(s.id for s in self.shapes))):
            if len(set(names)) < len(names):
                raise ValueError(f"{label}: expected different names")
        for shape in self.shapes:
            _check_protocol(self, shape)
        for shape in self.shapes:
            room = Room(block_mm=self.block_of(shape), border_mm=self.border_mm, cover_mm=self.cover_mm)
            fault = room.fault(shape)
            if fault is not None:
                raise ValueError(f"shapes.{shape.id}: {fault}")
        return self

    def block_of(self, shape: Shape) -> Size:
        """Sides of the block in which a shape stands [mm]: its own, or the recipe's."""
        if shape.block_mm is not None:
            return shape.block_mm
        return cast(Size, self.block_mm)  # of an interval, every shape has its own (`with_drawn_shapes`)

    @property
    def pokes_each(self) -> int:
        """Pokes of one shape at one material level."""
        return self.protocol.shared_sites + self.protocol.own_sites

    def identity(self) -> dict[str, Any]:
        """The recipe as plain values under the keys of its YAML file."""
        return self.model_dump(mode="json", by_alias=True)

    def with_levels(self, levels: Sequence[str]) -> Recipe:
        """Copy of the recipe at other material levels; InputError if these are not valid, distinct names."""
        try:
            return Recipe.model_validate({**self.model_dump(by_alias=True), "softness": tuple(levels)})
        except ValidationError as error:
            raise InputError(
                f"material levels {', '.join(map(repr, levels))}: {validation_sentence(error)}"
            ) from None


def _check_protocol(recipe: Recipe, shape: Shape) -> None:
    protocol, (*sides, height) = recipe.protocol, recipe.block_of(shape)
    whose = "" if shape.block_mm is None else f"shapes.{shape.id}: "
    if protocol.depth_mm >= height:
        raise ValueError(
            f"{whose}protocol.depth_mm: expected less than the block's height of {height:g} mm, "
            f"got {protocol.depth_mm:g}"
        )
    if protocol.depth_mm < min(SHALLOW * recipe.rod.radius_mm, FLAT * height):
        raise ValueError(
            f"{whose}protocol.depth_mm: expected a depth in mm that an indenter of radius"
            f" {recipe.rod.radius_mm:g} mm makes, got {protocol.depth_mm:g}; is it in metres?"
        )
    if 2 * protocol.margin_mm >= min(sides):
        raise ValueError(f"{whose}protocol.margin_mm: expected less than half of the block's sides")
    clear = CLEARANCE * recipe.rod.radius_mm / math.cos(math.radians(protocol.max_angle_deg))
    if protocol.margin_mm < clear:
        raise ValueError(
            f"protocol.margin_mm: expected at least {clear:.3g} mm, so that the rod of radius "
            f"{recipe.rod.radius_mm:g} mm and the fine mesh around it lie within the top at up to "
            f"{protocol.max_angle_deg:g} degrees, got {protocol.margin_mm:g}"
        )


def load_recipe(name_or_path: str | Path) -> Recipe:
    """Read a recipe.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a recipe that comes with the package ("quick"), or path of a YAML file.

    Raises
    ------
    InputError
        If there is no such recipe, or the file is not a valid one.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith((".yaml", ".yml")) or "/" in text:
        return read_yaml(Path(text), Recipe)
    path = shipped_folder("recipes") / f"{text}.yaml"
    if not path.is_file():
        known = ", ".join(recipe_names()) or "none"
        raise InputError(f"--recipe {text}: expected a path of a YAML file or one of: {known}")
    return read_yaml(path, Recipe)
