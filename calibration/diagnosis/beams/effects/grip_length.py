"""The grips hold deeper (positive) or shallower than their faces: the material is free that much inside."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    ends = 2.0 if situation.trial.supports == "clamped-clamped" else 1.0
    return replace(beam, length=beam.length + ends * amplitude)


def _image(points: NDArray[np.float64], amplitude: float, _: Situation) -> NDArray[np.float64]:
    # the scene's x = 0 is where the material gets free, behind the face that the picture's x = 0 is
    return points - np.array([amplitude, 0.0])


EFFECT = BeamEffect(
    name="grip-length",
    parameter="depth_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-4,  # the corner of a clamp moves along: half a millimetre would be far from linear
    bounds=(-5e-3, 8e-3),
    plausible=3e-3,
    sentence="the grips hold deeper inside than at their faces",
    remedy="clamp a metal bar and measure where the grip holds it",
    bend=_bend,
    image=_image,
)
