"""Search coordinates of a law: what the optimiser moves, with bounds, a start and, where honest, a prior."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim import Material, laws

Array = NDArray[np.float64]
Parameters = dict[str, "float | tuple[float, ...]"]

# Search range of the shear modulus [Pa]: gels to stiff rubbers.
SHEAR_LOW, SHEAR_HIGH = 50.0, 5e7
# K/G of a silicone, if nobody measured it: nu between 0.495 and 0.4994 at one sd. Beams, pokes and coupons
# hardly see it, and the shear modulus depends on it little (4 % from K/G 20 to 1000 on a beam).
BULK_RATIO, BULK_RATIO_LOG_SD = 300.0, 1.1


@dataclass(frozen=True, kw_only=True)
class Coordinate:
    """One direction of the search.

    name: what cards and reports call it; unit: of its value, not of its logarithm.
    log: the optimiser moves the natural logarithm of the value.
    low, high: bounds of the value; start: where a search begins (None: from the data).
    spread: a plain step in the coordinate itself: initial sd of a search, ten times a finite difference.
    prior: (centre, sd) of a normal prior on the coordinate itself (so on the logarithm, where log is set);
        None where the data alone decide.
    """

    name: str
    unit: str
    log: bool
    low: float
    high: float
    spread: float
    start: float | None = None
    prior: tuple[float, float] | None = None

    def inside(self, value: float) -> float:
        """The value as a coordinate."""
        return float(np.log(value)) if self.log else float(value)

    def value(self, u: float) -> float:
        """The coordinate as a value."""
        return float(np.exp(u)) if self.log else float(u)


@dataclass(frozen=True, kw_only=True)
class Parametrisation:
    """A law in search coordinates u, shape (n,).

    law: name in `tisim.laws`. label: what tables print ("ogden-2" for two terms).
    assemble: values by coordinate name -> the law's parameters.
    """

    law: str
    label: str
    coordinates: tuple[Coordinate, ...]
    assemble: Callable[[dict[str, float]], Parameters]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(c.name for c in self.coordinates)

    @property
    def bounds(self) -> Array:
        """Bounds of u, shape (n, 2)."""
        return np.array([[c.inside(c.low), c.inside(c.high)] for c in self.coordinates])

    def values(self, u: ArrayLike) -> dict[str, float]:
        """Values by name, SI."""
        return {c.name: c.value(x) for c, x in zip(self.coordinates, np.asarray(u, float), strict=True)}

    def parameters(self, u: ArrayLike) -> Parameters:
        """The law's parameters at u; ValueError where the law refuses them."""
        found = self.assemble(self.values(u))
        laws.get(self.law).check(found)
        return found

    def material(self, u: ArrayLike, *, density: float = 1000.0) -> Material:
        """Material at u; density [kg/m3]."""
        return Material(law=self.law, parameters=self.parameters(u), density=density)

    def moduli(self, u: ArrayLike) -> laws.Moduli:
        """Small-strain moduli at u [Pa]."""
        return laws.get(self.law).moduli(self.parameters(u))

    def start(self, *, shear: float) -> Array:
        """Start of a search at a guessed small-strain shear modulus [Pa], shape (n,)."""
        shears = [c for c in self.coordinates if c.start is None]
        return np.array(
            [c.inside(shear / len(shears) if c.start is None else c.start) for c in self.coordinates]
        )

    @property
    def spread(self) -> Array:
        """Plain steps in u, (n,)."""
        return np.array([c.spread for c in self.coordinates])

    def holding(self, name: str) -> Parametrisation:
        """The same, with one coordinate held at its prior's centre (to within 1 %): where the data cannot
        see it, a law that misfits would use it to repair its curve."""
        held = tuple(
            replace(c, prior=(c.prior[0], 0.01), spread=0.01) if c.name == name and c.prior else c
            for c in self.coordinates
        )
        return replace(self, coordinates=held)

    def prior(self) -> tuple[Array, Array]:
        """Centre and sd of the normal prior on u, each (n,); sd is inf where there is none."""
        pairs = [c.prior or (0.0, np.inf) for c in self.coordinates]
        return np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])


def shear_modulus(name: str = "shear_modulus") -> Coordinate:
    """Small-strain shear modulus [Pa] (of one term, where a law has several)."""
    return Coordinate(name=name, unit="Pa", log=True, low=SHEAR_LOW, high=SHEAR_HIGH, spread=0.3)


def bulk_ratio() -> Coordinate:
    """K/G, with the prior of a nearly incompressible rubber."""
    return Coordinate(
        name="bulk_ratio",
        unit="-",
        log=True,
        low=3.0,
        high=5000.0,
        spread=1.0,
        start=BULK_RATIO,
        prior=(float(np.log(BULK_RATIO)), BULK_RATIO_LOG_SD),
    )


def two_moduli(law: str, extra: Sequence[Coordinate] = ()) -> Parametrisation:
    """Shear modulus and K/G, for a law that its small-strain moduli settle."""

    def assemble(v: dict[str, float]) -> Parameters:
        return laws.get(law).from_moduli(v["shear_modulus"], v["shear_modulus"] * v["bulk_ratio"])

    return Parametrisation(
        law=law, label=law, coordinates=(shear_modulus(), bulk_ratio(), *extra), assemble=assemble
    )
