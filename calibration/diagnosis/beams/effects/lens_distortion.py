"""The lens distorts: points move away from the picture's middle by k r^2 of their distance r from it."""

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation


def _image(points: NDArray[np.float64], amplitude: float, situation: Situation) -> NDArray[np.float64]:
    # the middle of the picture is not in the file: the middle of the unbent beam stands for it
    away = points - np.array([0.5 * situation.trial.free_length, 0.0])
    return points + away * amplitude * (away**2).sum(axis=1, keepdims=True)


EFFECT = BeamEffect(
    name="lens-distortion",
    parameter="per_m2",
    per_unit=1.0,
    belongs_to="camera",
    step=1.0,
    bounds=(-20.0, 20.0),
    plausible=8.0,
    sentence="the lens distorts the photographs",
    remedy="calibrate the lens with a board in several poses",
    image=_image,
)
