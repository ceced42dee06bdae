"""Interface of the parts of a material beside its law: viscosity, softening, fibres."""

from __future__ import annotations

from abc import ABC, abstractmethod
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
        Class attribute: what cards call it; lower case, digits and hyphens.
    title : str
        Class attribute: what people read.
    """

    name: ClassVar[str]
    title: ClassVar[str]

    @abstractmethod
    def check(self) -> None:
        """Raise ValueError, in one sentence that begins with the field, for parameters that cannot be."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum:
    """Relaxation of the isochoric energy, in parts of the energy that the law's own parameters give.

    Attributes
    ----------
    equilibrium : float
        What is left in the long run.
    strengths : ndarray of float, shape (n,)
        What relaxes, by term.
    times : ndarray of float, shape (n,)
        Relaxation times [s].
    """

    equilibrium: float
    strengths: Array
    times: Array

    @property
    def instantaneous(self) -> float:
        """Instantaneous modulus, in units of the law's."""
        return self.equilibrium + float(self.strengths.sum())

    def modulus(self, time: float) -> float:
        """Relaxation function: what is left at a time after a step [s]."""
        return self.equilibrium + float(self.strengths @ np.exp(-time / self.times))


@dataclass(frozen=True, kw_only=True)
class Viscosity(Part):
    """A part by which isochoric stresses relax (finite linear viscoelasticity)."""

    @abstractmethod
    def spectrum(self) -> Spectrum:
        """The relaxation spectrum."""


@dataclass(frozen=True, kw_only=True)
class Softening(Part):
    """A part that makes the isochoric energy W softer than it was before its largest value so far, W_m.

    Attributes
    ----------
    energy : Taichi function
        Class attribute: (W, W_m, prm) to (f, df/dW, d2f/dW2), f the energy that takes the place of W and prm
        the numbers of `pack`; df/dW is 1 from W = W_m on. Decorated by `tisim.laws.ti.func`.
    """

    energy: ClassVar[Any]

    @abstractmethod
    def pack(self) -> Array:
        """The numbers that `energy` reads, shape (n,); n belongs to the class."""

    @abstractmethod
    def dissipated(self, largest: Array) -> Array:
        """Energy lost on the way to the largest energies W_m [J/m3]: W_m less what unloading gives back."""


@dataclass(frozen=True, kw_only=True)
class Fibres(Part):
    """One family of fibres, an energy of their squared isochoric stretch I4bar = J^(-2/3) a.Ca.

    Attributes
    ----------
    direction : (float, float, float)
        Of the fibres in the body's rest frame, of any length above 0.
    energy : Taichi function
        Class attribute: (I4bar, prm) to (W, dW/dI4bar, d2W/dI4bar2), zero and free of slope at I4bar = 1; prm
        the numbers of `pack`. Decorated by `tisim.laws.ti.func`.
    """

    energy: ClassVar[Any]
    direction: Vector

    @abstractmethod
    def pack(self) -> Array:
        """The numbers that `energy` reads, shape (n,); n belongs to the class."""

    def axis(self) -> Array:
        """The direction as a unit vector, shape (3,)."""
        a = np.asarray(self.direction, dtype=float)
        return np.asarray(a / np.linalg.norm(a))
