"""Error bars of a material card that account for the unexplained misfit.

Formal standard deviations of a fit account for noise alone. If a law misfits, its modulus depends on the data
it is fitted to. The relative standard deviation is therefore taken from the bootstrap over specimens, tests
or segments of records, with a lower bound: the formal value times the square root of the reduced chi-square
(Birge ratio; Phys. Rev. 40, 1932).
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
    """Model error estimated from the unexplained misfit of a fit.

    Attributes
    ----------
    rms : root mean square misfit in excess of noise [SI].
    of_full_scale : the same relative to each record's largest value; None if records have no full scale.
    shear_modulus_relative_sd : relative standard deviation by material, model error included.
    """

    rms: float
    of_full_scale: float | None
    shear_modulus_relative_sd: Mapping[str, float]

    def to_json(self, unit: tuple[str, float]) -> dict[str, Any]:
        """Content for diagnosis.json. unit : of rms residuals in files, and its number per SI unit."""
        return {
            f"rms_{unit[0]}": unit[1] * self.rms,
            "of_full_scale": self.of_full_scale,
            "shear_modulus_relative_sd": dict(self.shear_modulus_relative_sd),
        }


def model_error_of(
    model: MeasurementModel, fit: Fit, left: Remainder, shares: Shares, reduced_chi2: float
) -> ModelError:
    """Model error of a fit with unexplained misfit `left` and this chi-square per degree of freedom.

    The bootstrap spread is half the distance between the quantiles 0.159 and 0.841 of ln G.
    """
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
