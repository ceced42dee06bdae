"""What a dataset is made of: recipes, read from YAML (lengths in mm, angles in degrees)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from factory._yaml import Strict, read_yaml
from factory.errors import InputError

ROOT = Path(__file__).resolve().parent.parent / "datasets"

Positive = Annotated[float, Field(gt=0, le=1e6)]
Natural = Annotated[float, Field(ge=0, le=1e6)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$", max_length=60)]


class Cube(Strict):
    """A cube standing on the base, turned at random about the vertical."""

    kind: Literal["cube"]
    id: Name
    side_mm: Positive

    @property
    def reach_mm(self) -> float:
        """Largest distance from the vertical axis [mm]."""
        return self.side_mm / 2**0.5

    @property
    def top_mm(self) -> float:
        return self.side_mm


class Sphere(Strict):
    """A sphere on the base, sunk into it by `sunk_mm` so that it does not meet the base in a point."""

    kind: Literal["sphere"]
    id: Name
    radius_mm: Positive
    sunk_mm: Natural = 0.0

    @property
    def reach_mm(self) -> float:
        return self.radius_mm

    @property
    def top_mm(self) -> float:
        return 2 * self.radius_mm - self.sunk_mm


class Cylinder(Strict):
    """An upright cylinder standing on the base."""

    kind: Literal["cylinder"]
    id: Name
    radius_mm: Positive
    height_mm: Positive

    @property
    def reach_mm(self) -> float:
        return self.radius_mm

    @property
    def top_mm(self) -> float:
        return self.height_mm


Shape = Annotated[Cube | Sphere | Cylinder, Field(discriminator="kind")]


class RodRecipe(Strict):
    """The poking rod."""

    radius_mm: Positive
    length_mm: Positive
    tip: Literal["flat", "hemisphere"] = "flat"
    edge_radius_mm: Positive = 1.0


class Protocol(Strict):
    """Where and how each shape is poked.

    shared_sites: sites (with their directions) common to all softness levels of a shape.
    own_sites: sites drawn for each softness level.
    margin_mm: least distance of a site from the edges of the top face.
    max_angle_deg: largest angle between the push and the surface normal; drawn uniformly from 0.
    """

    shared_sites: Annotated[int, Field(ge=0, le=10_000)]
    own_sites: Annotated[int, Field(ge=0, le=10_000)]
    margin_mm: Natural
    max_angle_deg: Annotated[float, Field(ge=0, le=45)]
    depth_mm: Positive
    frame_spacing_mm: Positive

    @model_validator(mode="after")
    def _some(self) -> Self:
        if self.shared_sites + self.own_sites == 0:
            raise ValueError("shared_sites and own_sites are both 0: expected at least one poke")
        return self


class Recipe(Strict):
    """One dataset: shapes x softness levels x sites.

    softness: names of material cards. border_mm: least distance of an inclusion from the sides of the block.
    cover_mm: least silicone above an inclusion. refinement: elements get smaller by this factor.
    """

    name: Name
    description: str
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    block_mm: tuple[Positive, Positive, Positive]
    rod: RodRecipe
    friction: Annotated[float, Field(ge=0, le=10)]
    protocol: Protocol
    softness: Annotated[tuple[Name, ...], Field(min_length=1)]
    border_mm: Natural
    cover_mm: Natural
    refinement: Annotated[float, Field(ge=0.1, le=10)] = 1.0
    shapes: Annotated[tuple[Shape, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for label, names in (("softness", self.softness), ("shapes", tuple(s.id for s in self.shapes))):
            if len(set(names)) < len(names):
                raise ValueError(f"{label}: expected different names")
        if 2 * self.protocol.margin_mm >= min(self.block_mm[:2]):
            raise ValueError("protocol.margin_mm: expected less than half of the block's sides")
        for shape in self.shapes:
            if shape.top_mm + self.cover_mm > self.block_mm[2]:
                raise ValueError(
                    f"shapes.{shape.id}: its top at {shape.top_mm:g} mm leaves less than cover_mm = "
                    f"{self.cover_mm:g} of {self.block_mm[2]:g} mm above it"
                )
            if shape.reach_mm + self.border_mm > min(self.block_mm[:2]) / 2:
                raise ValueError(f"shapes.{shape.id}: wider than the block less border_mm")
        return self

    @property
    def pokes_each(self) -> int:
        """Pokes of one shape at one softness."""
        return self.protocol.shared_sites + self.protocol.own_sites


def recipe_names() -> list[str]:
    """Names of the recipes that come with the package."""
    return sorted(path.stem for path in (ROOT / "recipes").glob("*.yaml"))


def load_recipe(name_or_path: str) -> Recipe:
    """A recipe by name (datasets/recipes/NAME.yaml) or by path of a YAML file."""
    if name_or_path.endswith((".yaml", ".yml")) or "/" in name_or_path:
        return read_yaml(Path(name_or_path), Recipe)
    path = ROOT / "recipes" / f"{name_or_path}.yaml"
    if not path.is_file():
        known = ", ".join(recipe_names()) or "none"
        raise InputError(f"--recipe {name_or_path}: expected a path of a YAML file or one of: {known}")
    return read_yaml(path, Recipe)
