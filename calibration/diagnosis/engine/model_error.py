"""What the misfit that remains says of a card's error bars.

Standard deviations of a fit hold for the noise alone. Where a law misfits, its modulus depends on what was
measured: the spread over specimens, tests or stretches of records shows by how much, and is never taken less
than the formal one times the root of the reduced chi-square (Birge, Phys. Rev. 40, 1932).
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
    """The remainder of a fit as an error of its model.

    Attributes
    ----------
    rms : of what the model leaves beside noise [SI].
    of_full_scale : the same as a part of each record's largest value; None where records have none.
    shear_modulus_relative_sd : by material, with the model's error.
    """

    rms: float
    of_full_scale: float | None
    shear_modulus_relative_sd: Mapping[str, float]

    def to_json(self, unit: tuple[str, float]) -> dict[str, Any]:
        """unit : of rms residuals in files, and how many of them one SI unit is."""
        return {
            f"rms_{unit[0]}": unit[1] * self.rms,
            "of_full_scale": self.of_full_scale,
            "shear_modulus_relative_sd": dict(self.shear_modulus_relative_sd),
        }


def model_error_of(
    model: MeasurementModel, fit: Fit, left: Remainder, shares: Shares, reduced_chi2: float
) -> ModelError:
    """Of a fit that leaves `left`, with its chi-square over the degrees of freedom."""
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
