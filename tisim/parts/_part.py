"""Interface of the parts of a material: viscosity, softening, fibres."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Part(ABC):
    """A part of a material.

    A frozen dataclass whose fields are its parameters, SI units.

    Attributes
    ----------
    name : str
        Class attribute: name in material cards; lower case, digits and hyphens.
    title : str
        Class attribute: name for display.
    units : mapping of str to str, optional
        Class attribute: unit behind the key of a parameter in material cards, by parameter ({"times": "s"}
        for the key `times_s`); parameters without one are written under their names.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    units: ClassVar[Mapping[str, str]] = {}

    @abstractmethod
    def check(self) -> None:
        """Raise ValueError for invalid parameters, in one sentence that begins with the field."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum:
    """Relaxation spectrum of the isochoric energy, as fractions of the energy with the law's parameters.

    Attributes
    ----------
    equilibrium : float
        Fraction in the long-time limit.
    strengths : ndarray of float, shape (n,)
        Fraction that relaxes, by term.
    times : ndarray of float, shape (n,)
        Relaxation time of each term [s].
    """

    equilibrium: float
    strengths: Array
    times: Array

    @property
    def instantaneous(self) -> float:
        """Instantaneous modulus, in units of the law's modulus."""
        return self.equilibrium + float(self.strengths.sum())

    def modulus(self, time: float) -> float:
        """Relaxation function: fraction of the law's modulus at a time after a step of strain [s]."""
        return self.equilibrium + float(self.strengths @ np.exp(-time / self.times))


def ramp_weight(h: Array) -> Array:
    """Weight (1 - exp(-h))/h of a linear change over h relaxation times in its overstress; 1 at h = 0."""
    safe = np.where(h > 0.0, h, 1.0)
    return np.where(h > 0.0, -np.expm1(-safe) / safe, 1.0)


@dataclass(frozen=True, kw_only=True)
class Viscosity(Part):
    """A part that relaxes isochoric stresses (finite linear viscoelasticity)."""

    @abstractmethod
    def spectrum(self) -> Spectrum:
        """The relaxation spectrum."""


@dataclass(frozen=True, kw_only=True)
class Softening(Part):
    """A part that softens the response while the isochoric energy W is below its largest value so far, W_m.

    Attributes
    ----------
    energy : Taichi function
        Class attribute: (W, W_m, prm) -> (f, df/dW, d2f/dW2), where f is the energy that replaces W and prm
        the numbers of `pack`; df/dW is 1 for W >= W_m. Decorated by `tisim.laws.ti.func`.
    """

    energy: ClassVar[Any]

    @abstractmethod
    def pack(self) -> Array:
        """The numbers that `energy` reads, shape (n,), with n the same for all parts of the class."""

    @abstractmethod
    def dissipated(self, largest: Array) -> Array:
        """Energy dissipated at largest energies W_m [J/m3]: W_m minus the energy recovered in unloading."""


@dataclass(frozen=True, kw_only=True)
class Fibres(Part):
    """One family of fibres, an energy of their squared isochoric stretch I4bar = J^(-2/3) a.Ca.

    Attributes
    ----------
    direction : (float, float, float)
        Direction of the fibres in the rest shape, of any length above 0.
    energy : Taichi function
        Class attribute: (I4bar, prm) -> (W, dW/dI4bar, d2W/dI4bar2), where prm are the numbers of `pack`; W
        and dW/dI4bar are 0 at I4bar = 1. Decorated by `tisim.laws.ti.func`.
    """

    energy: ClassVar[Any]
    direction: Vector

    @abstractmethod
    def pack(self) -> Array:
        """The numbers that `energy` reads, shape (n,), with n the same for all parts of the class."""

    def axis(self) -> Array:
        """The direction as a unit vector, shape (3,)."""
        a = np.asarray(self.direction, dtype=float)
        return np.asarray(a / np.linalg.norm(a))


# What `tisim.Material` has in addition to its law: kind of part by field, which is also the key in a card.
FIELDS: dict[str, type[Any]] = {"viscosity": Viscosity, "softening": Softening, "fibres": Fibres}


def of(material: Any) -> dict[str, Part]:
    """Parts of a `tisim.Material`, or of what has its fields of parts, by field; empty for a law alone."""
    return {field: part for field in FIELDS if (part := getattr(material, field)) is not None}
