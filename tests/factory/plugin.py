"""A user's own inclusion shape and law: one class and one registration each (docs of `tisim`)."""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy`; its annotations are meaningful to Taichi only)

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim import inclusions, laws
from tisim.laws import Law, Moduli, by_invariants, first_isochoric, ti


@dataclass(frozen=True, kw_only=True)
class SpheroidInclusion(inclusions.Inclusion):
    """Rigid spheroid: equatorial radius, half of its height, centre [m]."""

    kind: ClassVar[str] = "spheroid"
    radius: float
    half_height: float
    centre: inclusions.Vector

    def mesh_geometry(self) -> inclusions.Spheroid:
        return inclusions.Spheroid(radius=self.radius, half_height=self.half_height)

    def signed_distance(self, points: ArrayLike) -> NDArray[np.float64]:
        axes = (self.radius, self.radius, self.half_height)
        size = np.linalg.norm((np.asarray(points) - np.asarray(self.centre)) / axes, axis=-1)
        return np.asarray((size - 1.0) * min(axes))

    @property
    def extent(self) -> inclusions.Vector:
        return self.radius, self.radius, self.half_height

    @property
    def volume(self) -> float:
        return 4.0 / 3.0 * math.pi * self.radius**2 * self.half_height


def _standing(p: Mapping[str, float], x: float, y: float, _angle: float) -> inclusions.Inclusion:
    height = p["half_height"] - p["sunk"]
    return SpheroidInclusion(radius=p["radius"], half_height=p["half_height"], centre=(x, y, height))


inclusions.register(
    SpheroidInclusion,
    recipe=inclusions.RecipeShape(
        name="spheroid",
        parameters=(
            inclusions.RecipeParameter("radius"),
            inclusions.RecipeParameter("half_height"),
            inclusions.RecipeParameter("sunk", default=0.0, positive=False),
        ),
        standing=_standing,
    ),
)


@ti.func
def energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    i1, slope = first_isochoric(I1, J)
    return by_invariants(0.5 * prm[0] * (i1 - 3.0), 0.5 * prm[0], 0.0, i1, slope, J)


laws.register(
    Law(
        name="my-law",
        title="Neo-Hookean, isochoric",
        parameters={"mu": ("Pa", "scalar"), "bulk": ("Pa", "scalar")},
        family="invariant",
        theta="log",
        energy=energy,
        pack=lambda p: np.array([p["mu"]]),
        kappa=lambda p: float(p["bulk"]),  # type: ignore[arg-type]
        moduli=lambda p: Moduli(shear_modulus=float(p["mu"]), bulk_modulus=float(p["bulk"])),  # type: ignore[arg-type]
        from_moduli=lambda shear_modulus, bulk_modulus: {"mu": shear_modulus, "bulk": bulk_modulus},
    )
)
