"""A coupon as an objective: whitened residuals of its stress, for the search and for `fit_coupons`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.coupons._noise import relative_sd, scatter_scale, slope
from calibration.coupons.homogeneous import nominal_stresses
from calibration.experiment.model import CouponTrial
from tisim import Material

Array = NDArray[np.float64]


@dataclass(eq=False, kw_only=True)
class CouponObjective:
    """One curve. sd [Pa], (k,): of each point's stress, made from the trial where not given.

    Where the lab gives stress_sd: sqrt(stress_sd^2 + (slope stretch_sd)^2), with the slope of the measured
    curve, so that the weights do not move with the law. Where it does not (sd_estimated): a relative error,
    estimated from the curve's scatter (`relative_sd`), of |stress| or of 5 % of the largest, in place of
    stress_sd. Points are taken as independent; an error that they share is no noise but an effect.
    """

    trial: CouponTrial
    sd: Array = field(default_factory=lambda: np.zeros(0))
    name: str = field(init=False)

    def __post_init__(self) -> None:
        trial = self.trial
        self.name = f"coupon {trial.id}"
        if not self.sd.size:
            self.sd = _standard_deviations(trial)
        if self.sd.shape != trial.stress.shape or not (np.isfinite(self.sd) & (self.sd > 0.0)).all():
            raise ValueError(f"coupon {trial.id}: expected a positive standard deviation for each point")

    @property
    def sd_estimated(self) -> bool:
        """The lab gave no stress_sd."""
        return self.trial.stress_sd is None

    @property
    def points(self) -> int:
        return self.trial.stress.size

    def size(self) -> int:
        return self.points

    def residuals(self, materials: Sequence[Material]) -> Array:
        """(data - model) / sd, (batch, size); a row of NaN where the material has no answer at some point."""
        return Coupons(parts=(self,)).residuals(materials)


@dataclass(eq=False, kw_only=True)
class Coupons:
    """Several curves of one material as one objective: solved together, which costs little more than one."""

    parts: tuple[CouponObjective, ...]
    name: str = field(init=False)

    def __post_init__(self) -> None:
        self.name = "coupons " + ", ".join(part.trial.id for part in self.parts)

    @property
    def points(self) -> int:
        return sum(part.points for part in self.parts)

    def size(self) -> int:
        return self.points

    def residuals(self, materials: Sequence[Material]) -> Array:
        """As those of the parts, one after the other."""
        curves = [(part.trial.mode, part.trial.stretch) for part in self.parts]
        stress = np.concatenate([part.trial.stress for part in self.parts])
        sd = np.concatenate([part.sd for part in self.parts])
        found = np.empty((len(materials), stress.size))
        for row, material in zip(found, materials, strict=True):
            row[:] = (stress - np.concatenate(nominal_stresses(material, curves))) / sd
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found


def _standard_deviations(trial: CouponTrial) -> Array:
    if trial.stress_sd is None:
        stress_sd = relative_sd(trial.stretch, trial.stress) * scatter_scale(trial.stress)
    else:
        stress_sd = np.full(trial.stress.shape, trial.stress_sd)
    if trial.stretch_sd == 0.0:
        return stress_sd
    return np.hypot(stress_sd, slope(trial.stretch, trial.stress) * trial.stretch_sd)
