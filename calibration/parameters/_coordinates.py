"""Search coordinates of a law and its parts: variables with bounds, a start and, where known, a prior."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim import Material, laws
from tisim.parts import Part

Array = NDArray[np.float64]
Parameters = dict[str, "float | tuple[float, ...]"]
Values = dict[str, float]

# Search range of the shear modulus [Pa]: gels to stiff rubbers.
SHEAR_LOW, SHEAR_HIGH = 50.0, 5e7
# K/G of a silicone that was not measured: nu between 0.495 and 0.4994 at one sd. No measurement here
# determines it well, and the shear modulus depends on it little (4 % from K/G 20 to 1000 on a beam).
BULK_RATIO, BULK_RATIO_LOG_SD = 300.0, 1.1


@dataclass(frozen=True, kw_only=True)
class Coordinate:
    """One coordinate of the search.

    Attributes
    ----------
    name, unit : str
        Name in cards and reports, and unit of the value, not of its logarithm.
    log : bool
        The optimiser moves the natural logarithm of the value.
    low, high : float
        Bounds of the value.
    spread : float
        Step in the coordinate itself: initial sd of a search, ten times a finite difference.
    start : float, optional
        Value where a search begins; from the data where left out.
    prior : tuple, optional
        Centre and sd of a normal prior on the coordinate itself (on the logarithm, where `log`); the data
        alone decide where left out.
    limit_low, limit_high : str
        The simpler law that a bound stands for ("neo-Hookean"): a fit that ends there is no lack of fit.
        Empty where the bound is one of the search only.
    held : bool
        Kept at its prior's centre (`Parametrisation.holding`).
    unheld_sd : float, optional
        Standard deviation of the prior that a held coordinate had.
    start_per_shear : float, optional
        Value where a search begins, over the guessed shear modulus, in place of `start`.
    """

    name: str
    unit: str
    log: bool
    low: float
    high: float
    spread: float
    start: float | None = None
    prior: tuple[float, float] | None = None
    limit_low: str = ""
    limit_high: str = ""
    held: bool = False
    unheld_sd: float | None = None
    start_per_shear: float | None = None

    def inside(self, value: float) -> float:
        """The value as a coordinate."""
        return float(np.log(value)) if self.log else float(value)

    def value(self, u: float) -> float:
        """The coordinate as a value."""
        return float(np.exp(u)) if self.log else float(u)


@dataclass(frozen=True, kw_only=True)
class ProtocolWindow:
    """Times and peak strains of a material's tests, which limit what they show of its parts.

    Attributes
    ----------
    first, last : float
        Shortest ramp and longest hold (longest test, where none has a hold) [s]: relaxation times between
        them are seen. Both 0 where no test has a clock.
    peaks : int
        Different largest strains that were unloaded from.
    """

    first: float
    last: float
    peaks: int


@dataclass(frozen=True, kw_only=True)
class PartCoordinates:
    """A part of a material in search coordinates.

    Attributes
    ----------
    spec : str
        As it is asked for ("prony:2"); empty where it is held.
    label : str
        Name in tables and file names ("prony-2").
    field : str
        Field of `tisim.Material` ("viscosity", "softening").
    window : ProtocolWindow
        Times and peak strains of the tests that it was made for.
    coordinates : tuple of Coordinate
    assemble : callable
        Values by coordinate name -> the part; ValueError where it refuses them.
    describe : callable
        Values, and the law's small-strain moduli -> sentences for `Parametrisation.remarks`.
    take_apart : callable, optional
        The inverse of `assemble`: a part -> values; ValueError for one of another form.
    """

    spec: str
    label: str
    field: str
    window: ProtocolWindow
    coordinates: tuple[Coordinate, ...]
    assemble: Callable[[Values], Part]
    describe: Callable[[Values, laws.Moduli], list[str]]
    take_apart: Callable[[Part], Values] | None = None

    def starting_at(self, part: Part) -> PartCoordinates:
        """The same, searched from a part on; ValueError for one that these coordinates do not describe."""
        if self.take_apart is None:
            raise ValueError(f"{self.spec} does not begin at a {part.name}")
        values = self.take_apart(part)
        begun = tuple(
            replace(c, start=min(max(values[c.name], c.low), c.high), start_per_shear=None)
            for c in self.coordinates
        )
        return replace(self, coordinates=begun)

    def assembled(self, values: Values) -> Part:
        """The part at these values; ValueError where they make none."""
        found = self.assemble(values)
        found.check()
        return found

    def remarks(self, values: Values, moduli: laws.Moduli) -> list[str]:
        """Notes for the reader on the part at these values."""
        return self.describe(values, moduli)


@dataclass(frozen=True, kw_only=True)
class Parametrisation:
    """A law in search coordinates u, shape (n,).

    Attributes
    ----------
    law : str
        Name in `tisim.laws`.
    label : str
        Name in tables ("ogden-2" for two terms).
    coordinates : tuple of Coordinate
    assemble : callable
        Values by coordinate name -> the law's parameters.
    parts : tuple of PartCoordinates
        Parts of the material beside the law; their coordinates are the last ones.
    """

    law: str
    label: str
    coordinates: tuple[Coordinate, ...]
    assemble: Callable[[dict[str, float]], Parameters]
    parts: tuple[PartCoordinates, ...] = ()

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
        """Material at u with its parts; density [kg/m3]. ValueError where law or parts refuse it."""
        found = Material(law=self.law, parameters=self.parameters(u), density=density)
        if not self.parts:
            return found
        values = self.values(u)
        parts: dict[str, Any] = {p.field: p.assembled(values) for p in self.parts}
        return replace(found, **parts)

    def moduli(self, u: ArrayLike) -> laws.Moduli:
        """Small-strain moduli at u [Pa]."""
        return laws.get(self.law).moduli(self.parameters(u))

    def start(self, *, shear: float) -> Array:
        """Start of a search at a guessed small-strain shear modulus [Pa], shape (n,)."""
        shears = [c for c in self.coordinates if c.start is None]
        own = {c.name: c.start_per_shear * shear for c in self.coordinates if c.start_per_shear is not None}
        return np.array(
            [
                c.inside(shear / len(shears) if c.start is None else own.get(c.name, c.start))
                for c in self.coordinates
            ]
        )

    def with_parts(self, parts: Sequence[PartCoordinates]) -> Parametrisation:
        """The same material with these parts beside its law."""
        return replace(
            self,
            label="+".join([self.label, *(p.label for p in parts)]),
            coordinates=(*self.coordinates, *(c for p in parts for c in p.coordinates)),
            parts=(*self.parts, *parts),
        )

    def without_parts(self) -> Parametrisation:
        """The law alone; its coordinates are the first ones of these."""
        if not self.parts:
            return self
        beside = {c.name for p in self.parts for c in p.coordinates}
        return replace(self, parts=(), coordinates=tuple(c for c in self.coordinates if c.name not in beside))

    def remarks(self, u: ArrayLike) -> list[str]:
        """Sentences on the parts at u, and on what the tests cannot show of them."""
        values, moduli = self.values(u), self.moduli(u)
        return [sentence for p in self.parts for sentence in p.remarks(values, moduli)]

    @property
    def spread(self) -> Array:
        """Plain steps in u, (n,)."""
        return np.array([c.spread for c in self.coordinates])

    def holding(self, name: str) -> Parametrisation:
        """The same, with one coordinate held at its prior's centre (to within 1 %): where the data cannot
        see it, a law that misfits would use it to repair its curve."""
        held = tuple(
            replace(c, prior=(c.prior[0], 0.01), spread=0.01, held=True, unheld_sd=c.prior[1])
            if c.name == name and c.prior and not c.held
            else c
            for c in self.coordinates
        )
        return replace(self, coordinates=held)

    def believed(self) -> Parametrisation:
        """The same with the priors that held coordinates had: what is known of them, for error bars."""
        found = tuple(
            replace(c, prior=(c.prior[0], c.unheld_sd)) if c.held and c.prior and c.unheld_sd else c
            for c in self.coordinates
        )
        return replace(self, coordinates=found)

    def in_steps(self, factor: float) -> Parametrisation:
        """The same, moduli searched and differentiated in steps so many times as long: a vibration that is
        compared in its phase answers only near its best."""
        found = tuple(
            replace(c, spread=factor * c.spread) if c.start is None else c for c in self.coordinates
        )
        return replace(self, coordinates=found)

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
        limit_high="incompressible",
    )


def two_moduli(law: str, extra: Sequence[Coordinate] = ()) -> Parametrisation:
    """Shear modulus and K/G, for a law that its small-strain moduli settle."""

    def assemble(v: dict[str, float]) -> Parameters:
        return laws.get(law).from_moduli(v["shear_modulus"], v["shear_modulus"] * v["bulk_ratio"])

    return Parametrisation(
        law=law, label=law, coordinates=(shear_modulus(), bulk_ratio(), *extra), assemble=assemble
    )
