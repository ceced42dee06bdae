"""Fields by which the recipe of a dataset states an inclusion shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tisim.inclusions._shape import Inclusion, Prism


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
    """Fields by which the recipe of a dataset states a shape that stands on the base of the block.

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
