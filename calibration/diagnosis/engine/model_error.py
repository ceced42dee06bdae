"""Model error of a card: error bars that include the remaining misfit.

Standard deviations of a fit hold for noise alone. If a law misfits, its modulus depends on the choice of the
measurements. The spread over specimens, tests or parts of records shows this dependence; it is at least the
formal standard deviation times the root of the reduced chi-square (Birge, Phys. Rev. 40, 1932).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.remainder import Remainder
from calibration.diagnosis.engine.shares import Shares
from calibration.measurements._model import MeasurementModel


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """The remaining misfit of a fit as an error of its model.

    Attributes
    ----------
    rms : rms of the misfit beyond noise [SI].
    of_full_scale : the same, relative to the largest value of each record; None if records have none.
    shear_modulus_relative_sd : relative standard deviation by material, including the model error.
    """

    rms: float
    of_full_scale: float | None
    shear_modulus_relative_sd: Mapping[str, float]

    def to_json(self, unit: tuple[str, float]) -> dict[str, Any]:
        """Entry of a JSON file; `unit` is the name of the rms unit in files, and its number per SI unit."""
        return {
            f"rms_{unit[0]}": unit[1] * self.rms,
            "of_full_scale": self.of_full_scale,
            "shear_modulus_relative_sd": dict(self.shear_modulus_relative_sd),
        }


def model_error_of(
    model: MeasurementModel, fit: Fit, left: Remainder, shares: Shares, reduced_chi2: float
) -> ModelError:
    """Model error of a fit with the remaining misfit `left` and its reduced chi-square."""
    n = len(fit.state.u)
    covariance = fit.covariance()[:n, :n]
    moves = shares.moves(fit)[:, :n]
    sds = {}
    for material in model.shear_moduli(fit.state.u):
        weights = model.baseline.modulus_weights(material, fit.state.u)
        formal = float(np.sqrt(max(float(weights @ covariance @ weights), 0.0)))
        seen = moves @ weights
        low, high = np.quantile(seen, (0.159, 0.841)) if len(seen) > 1 else (0.0, 0.0)
        spread = 0.5 * float(high - low)
        sds[material] = max(spread, formal * float(np.sqrt(max(reduced_chi2, 1.0))))
    return ModelError(rms=left.rms, of_full_scale=left.of_full_scale, shear_modulus_relative_sd=sds)
