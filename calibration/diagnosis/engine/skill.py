"""Held-out skill: which part of the error that is not noise an extension takes away.

    skill = (rms_before^2 - rms_after^2) / (rms_before^2 - rms_noise^2)

on measurements that no amplitude was fitted to: 0 where the extension predicts them no better than the
baseline does, 1 where it predicts them as well as noise allows, below 0 where it is worse than nothing. It is
the forecaster's skill score (Murphy, Mon. Weather Rev. 116, 1988) with the noise for a perfect forecast.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


def skill(before: float, after: float, noise: float) -> float:
    """Of root mean squares in one unit: by the baseline, by the extension, of noise alone. NaN where the
    baseline predicts as well as noise allows: there is nothing to gain."""
    explainable = before**2 - noise**2
    return (before**2 - after**2) / explainable if explainable > 0.0 else math.nan


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """One part of the measurements, predicted from others.

    Attributes
    ----------
    name : of the part that was left out.
    points : measured points in it.
    rms_before, rms_after, rms_noise : of measured less predicted, by the baseline, by the extension, and of
        noise alone [SI].
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
        """True if the extension predicts it better than the baseline, or as well as noise allows."""
        return self.rms_after < self.rms_before or self.rms_after <= self.rms_noise


def together(parts: Iterable[Prediction], name: str = "all") -> Prediction:
    """Predictions of several parts as one, weighted by their points. ValueError where there is none."""
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
