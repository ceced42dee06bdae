"""What a constitutive law is: parameters, small-strain moduli, and derivatives of its energy.

A law's energy is split into W(C) and a volumetric part U = kappa/2 theta^2 with theta one of
ln J, J - 1 or tr E. The split is exact (W + U is the law's energy); it lets an element with a constant
pressure take theta by its mean, and only theta.

W comes in one of two families:
  invariant: W(I1, I2, J), returned with its derivatives as a 10-vector
      (W, W1, W2, WJ, W11, W22, WJJ, W12, W1J, W2J);
  principal: W(l1, l2, l3) of the principal stretches, as
      (W, W_1, W_2, W_3, W_11, W_22, W_33, W_12, W_13, W_23).
I1 = tr C, I2 = (I1^2 - tr C^2)/2, J = det F.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Parameters = Mapping[str, "float | tuple[float, ...]"]


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """Small-strain moduli [Pa]."""

    shear: float
    bulk: float


@dataclass(frozen=True, kw_only=True)
class Law:
    """A constitutive law, as the kernels need it.

    name: what scenes and cards call it. title: what people read.
    parameters: name -> (unit, "scalar" | "series").
    family, theta: see the module's text.
    energy: Taichi function (I1, I2, J, prm) or (l1, l2, l3, prm) -> 10-vector; prm is the packed array.
    pack: parameters -> the numbers `energy` reads, shape (n,).
    kappa: parameters -> the factor of theta^2 / 2 [Pa].
    moduli: parameters -> small-strain moduli.
    from_moduli: (shear, bulk) [Pa] -> parameters with these moduli (other constants at a plain default).
    fault: parameters -> what is wrong with them beyond numbers and moduli, or "".
    """

    name: str
    title: str
    parameters: Mapping[str, tuple[str, Literal["scalar", "series"]]]
    family: Literal["invariant", "principal"]
    theta: Literal["log", "linear", "trace"]
    energy: Any
    pack: Callable[[Parameters], NDArray[np.float64]]
    kappa: Callable[[Parameters], float]
    moduli: Callable[[Parameters], Moduli]
    from_moduli: Callable[[float, float], dict[str, float | tuple[float, ...]]]
    fault: Callable[[Parameters], str] = lambda _: ""

    def check(self, parameters: Parameters) -> None:
        """Raise ValueError, in one sentence, unless names, shapes and small-strain moduli are sound."""
        unknown = sorted(set(parameters) - set(self.parameters))
        missing = sorted(set(self.parameters) - set(parameters))
        if unknown or missing:
            raise ValueError(
                f"{self.name}: expected parameters {', '.join(self.parameters)};"
                + (f" unknown: {', '.join(unknown)};" if unknown else "")
                + (f" missing: {', '.join(missing)};" if missing else "")
            )
        for name, (unit, shape) in self.parameters.items():
            try:
                values = np.asarray(parameters[name], dtype=float)
            except (TypeError, ValueError):
                values = np.array(np.nan)
            if not np.isfinite(values).all() or values.size == 0:
                raise ValueError(f"{self.name}: parameter {name} [{unit}]: expected finite numbers")
            if values.ndim > (shape == "series"):
                wanted = "a plain series of numbers" if shape == "series" else "one number"
                raise ValueError(f"{self.name}: parameter {name} [{unit}]: expected {wanted}")
        series = {name: np.size(parameters[name]) for name, p in self.parameters.items() if p[1] == "series"}
        if len(set(series.values())) > 1:
            raise ValueError(f"{self.name}: {', '.join(series)} must have the same number of terms")
        if fault := self.fault(parameters):
            raise ValueError(f"{self.name}: {fault}")
        moduli = self.moduli(parameters)
        if not (moduli.shear > 0 and moduli.bulk > 0):
            raise ValueError(
                f"{self.name}: small-strain shear and bulk modulus must be positive,"
                f" got {moduli.shear:.4g} and {moduli.bulk:.4g} Pa"
            )


def scalar(parameters: Parameters, name: str) -> float:
    """One number out of the parameters."""
    return float(np.asarray(parameters[name], dtype=float))


def series(parameters: Parameters, name: str) -> NDArray[np.float64]:
    """A series out of the parameters, shape (N,)."""
    return np.atleast_1d(np.asarray(parameters[name], dtype=float))
