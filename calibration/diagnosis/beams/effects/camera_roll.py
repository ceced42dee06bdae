"""The camera is rolled against the rig's horizontal, in all photographs alike: positive lifts large x."""

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation


def _image(points: NDArray[np.float64], amplitude: float, _: Situation) -> NDArray[np.float64]:
    c, s = np.cos(amplitude), np.sin(amplitude)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


EFFECT = BeamEffect(
    name="camera-roll",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="camera",
    step=3e-3,
    bounds=(-0.1, 0.1),
    plausible=0.03,
    sentence="the camera is rolled against the rig",
    remedy="put a plumb line or a gauge into the picture",
    image=_image,
)
