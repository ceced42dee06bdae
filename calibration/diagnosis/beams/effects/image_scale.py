"""The scale of all photographs is off by this part: things look larger where positive."""

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation


def _image(points: NDArray[np.float64], amplitude: float, _: Situation) -> NDArray[np.float64]:
    return points * (1.0 + amplitude)


EFFECT = BeamEffect(
    name="image-scale",
    parameter="excess",
    per_unit=1.0,
    belongs_to="camera",
    step=3e-3,
    bounds=(-0.1, 0.1),
    plausible=0.03,
    sentence="the photographs' scale is off",
    remedy="put a second board, or a gauge of known length, into the beam's plane",
    image=_image,
)
