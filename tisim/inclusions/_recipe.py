"""Fields that describe an inclusion shape in the recipe of a dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tisim.inclusions._shape import Inclusion, Prism


@dataclass(frozen=True)
class RecipeParameter:
    """One length of a shape in a recipe.

    Attributes
    ----------
    name : str
        Name of the parameter; the key in a recipe includes the unit (`radius_mm` for `radius`).
    default : float or None
        Value if the recipe has none; None if the recipe must have one.
    positive : bool
        True if the length must be above 0, False if 0 is allowed.
    """

    name: str
    default: float | None = field(default=None, kw_only=True)
    positive: bool = field(default=True, kw_only=True)


@dataclass(frozen=True, kw_only=True)
class RecipeShape:
    """Fields that describe a shape on the base of the block in the recipe of a dataset.

    All functions take the parameters by name in any one unit of length and return lengths in that unit.

    Attributes
    ----------
    name : str
        The shape's `kind` in a recipe ("cube").
    parameters : tuple of RecipeParameter
        Lengths that a recipe states.
    standing : callable (parameters, x, y, angle) -> Inclusion
        The shape on the base at (x, y), rotated by `angle` [rad] about the vertical; its lengths have the
        unit of the parameters and still have to be `scaled`.
    reach : callable (parameters) -> float, optional
        Largest distance of its points from the vertical axis through its centre.
    top : callable (parameters) -> float, optional
        Height of its highest point above the base.
    turned : bool
        True if the shape depends on the angle.
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
