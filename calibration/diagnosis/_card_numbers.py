"""Numbers of an extended material card: moduli with uncertainty, covariances in file units, ranges."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.screening import basis_of
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._effect import Candidate

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Modulus:
    """Shear modulus of a material.

    Attributes
    ----------
    value : shear modulus G [Pa].
    relative_sd : formal standard deviation of ln G.
    weights : derivatives of ln G by the coordinates u of the fit, shape (n,).
    """

    value: float
    relative_sd: float
    weights: Array

    @property
    def direction(self) -> Array:
        """Smallest change of u that increases ln G by 1, shape (n,)."""
        return np.asarray(self.weights / (self.weights @ self.weights))


def moduli(diagnosis: Diagnosis) -> dict[str, Modulus]:
    """Shear modulus of each diagnosed material.

    ValueError if the coordinates of the fit do not give the moduli that the diagnosis reports.
    """
    u = diagnosis.fit.state.u
    n = len(u)
    covariance = diagnosis.fit.covariance()[:n, :n]
    found = {}
    for name, value in (diagnosis.extended or diagnosis.baseline).shear_modulus_Pa.items():
        weights = diagnosis.subject.modulus_weights.get(name)
        if weights is None:
            raise ValueError(f"material {name}: no coordinate of the diagnosis is its modulus")
        if not np.isclose(np.exp(weights @ u), value, rtol=1e-6):
            raise ValueError(f"material {name}: its modulus is not that of the diagnosis' coordinates")
        sd = float(np.sqrt(weights @ covariance @ weights))
        found[name] = Modulus(value=float(value), relative_sd=sd, weights=weights)
    return found


def file_covariance(diagnosis: Diagnosis) -> tuple[Array, list[str]]:
    """Covariance of the named effects' amplitudes in file units, shape (c, c), and their labels."""
    fit = diagnosis.fit
    units = np.array([diagnosis.effects[c.effect].per_unit for c in fit.candidates])
    n = len(fit.state.u)
    names = [f"{c.label}: {diagnosis.effects[c.effect].parameter}" for c in fit.candidates]
    return fit.covariance()[n:, n:] * np.outer(units, units), names


def correlations(index: int, modulus: Modulus, diagnosis: Diagnosis) -> dict[str, float]:
    """Correlations of an effect's amplitude with ln G of the material and with the other named effects."""
    fit = diagnosis.fit
    n = len(fit.state.u)
    row = fit.covariance()[n + index]
    sds = np.sqrt(np.diag(fit.covariance())[n:])
    found = {"shear_modulus": _part(row[:n] @ modulus.weights, sds[index] * modulus.relative_sd)}
    for k, name in enumerate(file_covariance(diagnosis)[1]):
        if k != index:
            found[name] = _part(row[n + k], sds[index] * sds[k])
    return found


def baseline_entry(name: str, modulus: Modulus, diagnosis: Diagnosis) -> dict[str, Any]:
    """Card entry of the material without the effects, as a reference for predictions."""
    numbers, fit = diagnosis.baseline, diagnosis.finding.baseline
    n = len(fit.state.u)
    covariance = fit.covariance()[:n, :n] * widened(fit, modulus.direction) ** 2
    return {
        "law": diagnosis.subject.law,
        "shear_modulus": rounded(numbers.shear_modulus_Pa[name]),
        "shear_modulus_sd": rounded(
            float(numbers.shear_modulus_Pa[name] * np.sqrt(modulus.weights @ covariance @ modulus.weights))
        ),
        "bulk_modulus": rounded(numbers.shear_modulus_Pa[name] * diagnosis.subject.bulk_ratio),
        "model_error": model_error(fit, modulus.direction),
    }


def own_misfit(fit: Fit, direction: Array) -> tuple[float, float]:
    """Sum of squares of the whitened residuals that a modulus affects, and their degrees of freedom.

    direction : change of u (n,) that increases ln G of a material by 1. The misfit of other materials is
        theirs.
    """
    change = np.abs(fit.linear.by_u @ direction)
    rows = change > 1e-9 * change.max(initial=0.0)
    leverage = (basis_of(fit.jacobian)[rows] ** 2).sum()
    return float(fit.z[rows] @ fit.z[rows]), float(np.count_nonzero(rows) - leverage)


def widened(fit: Fit, direction: Array) -> float:
    """Factor on a modulus' standard deviation: root of the reduced chi-square of its misfit, at least 1."""
    chi2, free = own_misfit(fit, direction)
    return sqrt(max(chi2 / free, 1.0)) if free > 0.0 else 1.0


def model_error(fit: Fit, direction: Array) -> float:
    """Relative error of the moduli with the same whitened sum of squares as the misfit in excess of noise.

    direction : as in `own_misfit`. Returns 0 if the residuals do not depend on it.
    """
    chi2, free = own_misfit(fit, direction)
    change = fit.linear.by_u @ direction
    size = float(change @ change)
    return rounded(sqrt(max(chi2 - free, 0.0) / size)) if size > 0.0 else 0.0


def valid_range(candidate: Candidate, diagnosis: Diagnosis) -> dict[str, list[float]]:
    """Measured ranges of an effect, by the quantity's name in files."""
    ranges = diagnosis.subject.ranges.get(candidate, {})
    return {name: [rounded(low), rounded(high)] for name, (low, high) in ranges.items()}


def gain(diagnosis: Diagnosis) -> dict[str, float | str | None] | None:
    """Held-out scores as in `diagnosis.json`, without the folds; None if there are none."""
    found = diagnosis.to_json()["gain"]
    if found is None:
        return None
    single = {k: v for k, v in found.items() if k != "folds"}
    return {k: v if v is None or isinstance(v, str) else rounded(v) for k, v in single.items()}


def rounded(x: float) -> float:
    """Round to six significant digits, as in cards."""
    return float(f"{x:.6g}")


def _part(covariance: float, sds: float) -> float:
    return rounded(covariance / sds) if sds > 0.0 else 0.0
