"""Held-out skill: fraction of the baseline's prediction error beyond noise that an extension removes.

    skill = (rms_before^2 - rms_after^2) / (rms_before^2 - rms_noise^2)

on measurements that no amplitude was fitted to. It is 0 if the extension predicts them no better than the
baseline, 1 if it predicts them to within noise, and negative if it predicts them worse than the baseline. It
is the skill score of forecast verification (Murphy, Mon. Weather Rev. 116, 1988) with the noise as the error
of a perfect forecast.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


def skill(before: float, after: float, noise: float) -> float:
    """Skill from the rms errors of the baseline and the extension and the rms of noise, in one unit.

    NaN if the baseline predicts to within noise.
    """
    explainable = before**2 - noise**2
    return (before**2 - after**2) / explainable if explainable > 0.0 else math.nan


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Prediction errors of one held-out fold.

    Attributes
    ----------
    name : name of the fold.
    points : number of measured points in it.
    rms_before, rms_after : rms of measured minus predicted by the baseline and by the extension [SI].
    rms_noise : rms of noise alone [SI].
    """

    name: str
    points: int
    rms_before: float
    rms_after: float
    rms_noise: float

    @property
    def skill(self) -> float:
        return skill(self.rms_before, self.rms_after, self.rms_noise)

    @property
    def helps(self) -> bool:
        """True if the extension predicts the fold better than the baseline does, or to within noise."""
        return self.rms_after < self.rms_before or self.rms_after <= self.rms_noise


def together(parts: Iterable[Prediction], name: str = "all") -> Prediction:
    """Combine the predictions of several folds, weighted by points. ValueError if there are no points."""
    whole = list(parts)
    points = sum(p.points for p in whole)
    if points == 0:
        raise ValueError("expected a prediction of some points")

    def mean(values: Iterable[float]) -> float:
        return math.sqrt(sum(p.points * v**2 for p, v in zip(whole, values, strict=True)) / points)

    return Prediction(
        name=name,
        points=points,
        rms_before=mean(p.rms_before for p in whole),
        rms_after=mean(p.rms_after for p in whole),
        rms_noise=mean(p.rms_noise for p in whole),
    )
