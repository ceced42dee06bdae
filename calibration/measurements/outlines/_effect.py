"""Effects in photographed beams: they change the simulated scene, or its image."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial, specimen_of
from calibration.measurements._effect import EffectModel
from calibration.measurements.outlines.simulators import Simulator
from tisim import Beam

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Situation:
    """Arguments of an effect besides the scene.

    Attributes
    ----------
    trial : the trial.
    time : time of the photograph since release [s].
    position : position in the specimen, as a fraction of the free length; None for an effect without one.
    """

    trial: BeamTrial
    time: float
    position: float | None = None


def untouched(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    del amplitude, situation
    return beam


def any_simulator(simulator: Simulator) -> bool:
    del simulator
    return True


@dataclass(frozen=True, kw_only=True)
class OutlineEffect(EffectModel):
    """An effect in photographed beams; `applies_to` takes the trial of a photograph.

    Attributes
    ----------
    bend : function of (scene, amplitude, situation) to the scene with the effect.
    image : function of (points (k, 2) [m], amplitude, situation) to their positions in the photograph; None
        if it does not change the image.
    timed : True if photographs of one trial at different times differ by it.
    instead : for an error of the simulator, function to the scene without it; the amplitude is the fraction
        of the change to that scene.
    faulty : function that is True for simulators that can have it.
    """

    bend: Callable[[Beam, float, Situation], Beam] = untouched
    image: Callable[[Array, float, Situation], Array] | None = None
    timed: bool = False
    instead: Callable[[Beam], Beam] | None = None
    faulty: Callable[[Simulator], bool] = any_simulator

    @property
    def bends(self) -> bool:
        """True if it changes the scene, not only its image."""
        return self.bend is not untouched

    def acts_on(self, record: Any) -> bool:
        """True if a trial, or the trial of a photograph, can have the effect."""
        return self.applies_to(getattr(record, "trial", record))

    def labels(self, record: Any) -> tuple[str, ...]:
        """Trial, material and specimen: any of these can be named, also by a rig file."""
        trial: BeamTrial = getattr(record, "trial", record)
        return (trial.id, trial.material, specimen_of(trial))


def cantilever(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-free"


def bridge(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-clamped"
