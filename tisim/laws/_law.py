"""The constitutive law: parameters, small-strain moduli, and derivatives of its energy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:  # a command's help lists the laws: NumPy is imported when one is used
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

Parameters = Mapping[str, "float | tuple[float, ...]"]


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """Small-strain moduli.

    Attributes
    ----------
    shear_modulus, bulk_modulus : float
        Shear and bulk modulus [Pa].
    """

    shear_modulus: float
    bulk_modulus: float

    @property
    def young_modulus(self) -> float:
        """Young's modulus [Pa]."""
        g, k = self.shear_modulus, self.bulk_modulus
        return 9.0 * k * g / (3.0 * k + g)

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio [-]."""
        g, k = self.shear_modulus, self.bulk_modulus
        return (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g))

    def with_poisson_ratio(self, nu: float) -> Moduli:
        """The same shear modulus with Poisson's ratio `nu` [-]; ValueError outside -1 to 0.5."""
        if not -1.0 < nu < 0.5:
            raise ValueError(f"expected a Poisson ratio between -1 and 0.5, got {nu:.3g}")
        g = self.shear_modulus
        return Moduli(shear_modulus=g, bulk_modulus=2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Law:
    """A hyperelastic law in the form that the kernels need.

    The energy per rest volume is split into W(C) and a volumetric part U = kappa/2 theta^2 with theta one of
    ln J, J - 1 or tr E. The split is exact (W + U is the law's energy); it allows an element with a constant
    pressure to replace theta, and only theta, by its mean.

    W comes in one of two families:

    - "invariant": W(I1, I2, J), I1 = tr C, I2 = (I1^2 - tr C^2)/2, J = det F, returned with its derivatives
      as the 10-vector (W, W1, W2, WJ, W11, W22, WJJ, W12, W1J, W2J);
    - "principal": W(l1, l2, l3) of the principal stretches, as
      (W, W_1, W_2, W_3, W_11, W_22, W_33, W_12, W_13, W_23).

    Attributes
    ----------
    name : str
        Name in scenes and material cards: lower case, digits and hyphens.
    title : str
        Name for display.
    parameters : mapping of str to (str, "scalar" or "series")
        Unit and shape of each parameter.
    family : "invariant" or "principal"
        Arguments of `energy`.
    theta : "log", "linear" or "trace"
        ln J, J - 1 or tr E.
    energy : Taichi function
        (I1, I2, J, prm) or (l1, l2, l3, prm) -> the 10-vector; prm is the packed array. Decorated by
        `tisim.laws.ti.func` (Taichi is then imported when the law is first evaluated) or by Taichi's own.
    pack : callable (parameters) -> array_like of float, shape (n,)
        The numbers that `energy` reads.
    kappa : callable (parameters) -> float
        Factor of theta^2 / 2 [Pa].
    moduli : callable (parameters) -> Moduli
        Small-strain moduli.
    from_moduli : callable (shear modulus, bulk modulus) -> dict
        Parameters with these moduli [Pa]; other constants have a default.
    fault : callable (parameters) -> str
        Fault of the parameters that is not one of numbers or moduli; "" if there is none.
    examples : sequence of mappings
        Further parameters for `check_law`, for laws with constants whose default in `from_moduli` is zero.
    """

    name: str
    title: str
    parameters: Mapping[str, tuple[str, Literal["scalar", "series"]]]
    family: Literal["invariant", "principal"]
    theta: Literal["log", "linear", "trace"]
    energy: Any
    pack: Callable[[Parameters], ArrayLike]
    kappa: Callable[[Parameters], float]
    moduli: Callable[[Parameters], Moduli]
    from_moduli: Callable[[float, float], dict[str, float | tuple[float, ...]]]
    fault: Callable[[Parameters], str] = lambda _: ""
    examples: Sequence[Parameters] = ()

    def check(self, parameters: Parameters) -> None:
        """Raise ValueError, in one sentence, unless names, shapes, values and moduli are valid.

        The parameters of the last check that passed are known to be valid: an iteration evaluates the same
        ones again and again, and the check takes half as long as the law at a hundred points.
        """
        key = _plain(parameters)
        law, known = _passed.get(self.name, (None, None))
        if law is self and key is not None and key == known:
            return
        self._check(parameters)
        _passed[self.name] = (self, key)

    def _check(self, parameters: Parameters) -> None:
        import numpy as np

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
                given = np.asarray(parameters[name])
                # text that looks like a number (15e3 in YAML) would fail later, and True is no modulus
                values = given.astype(float) if given.dtype.kind in "iuf" else np.array(np.nan)
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
        if not (moduli.shear_modulus > 0 and moduli.bulk_modulus > 0):
            raise ValueError(
                f"{self.name}: small-strain shear and bulk modulus must be positive,"
                f" got {moduli.shear_modulus:.4g} and {moduli.bulk_modulus:.4g} Pa"
            )


_passed: dict[str, tuple[Law, tuple[tuple[str, object], ...] | None]] = {}


def _plain(parameters: Parameters) -> tuple[tuple[str, object], ...] | None:
    """Names and values, if all are floats or tuples of floats; None for others: equal ones may differ."""
    for value in parameters.values():
        if type(value) is not float and not (
            type(value) is tuple and all(type(part) is float for part in value)
        ):
            return None
    return tuple(parameters.items())


def scalar(parameters: Parameters, name: str) -> float:
    """A scalar parameter by name."""
    import numpy as np

    return float(np.asarray(parameters[name], dtype=float))


def series(parameters: Parameters, name: str) -> NDArray[np.float64]:
    """A series parameter by name, shape (N,)."""
    import numpy as np

    return np.atleast_1d(np.asarray(parameters[name], dtype=float))
