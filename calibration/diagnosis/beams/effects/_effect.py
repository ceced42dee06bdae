"""An effect on photographed beams: how its amplitude enters the scene, or the picture of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams.simulators import Simulator
from calibration.diagnosis.effect import Effect
from calibration.experiment.model import BeamTrial
from tisim import Beam, Material, laws

Array = NDArray[np.float64]

Reach = Literal["group", "trial"]


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What an effect may look at besides the scene: the trial, when the photograph was taken [s], and where
    in the specimen it sits (part of the free length)."""

    trial: BeamTrial
    time: float
    place: float | None = None


def untouched(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    del amplitude, situation
    return beam


def every(trial: BeamTrial) -> bool:
    del trial
    return True


def any_simulator(simulator: Simulator) -> bool:
    del simulator
    return True


@dataclass(frozen=True, kw_only=True)
class BeamEffect(Effect):
    """An effect on beams.

    bend: the scene with the effect in it. image: where the photograph shows points (k, 2) [m] of it.
    touches: whether a trial can have it. timed: whether photographs of one trial differ by it.
    reach: "group" where all trials or all of a material may share it, "trial" where it sits in one trial.
    places: where in the specimen it may sit (parts of the free length).
    instead: for a fault of the simulator, the scene without it: the amplitude is the part of the way there.
    faulty: which simulators may have it.
    """

    bend: Callable[[Beam, float, Situation], Beam] = untouched
    image: Callable[[Array, float, Situation], Array] | None = None
    touches: Callable[[BeamTrial], bool] = every
    timed: bool = False
    reach: Reach = "group"
    places: tuple[float | None, ...] = (None,)
    instead: Callable[[Beam], Beam] | None = None
    faulty: Callable[[Simulator], bool] = any_simulator

    @property
    def bends(self) -> bool:
        """Whether it changes the scene, and not only its picture."""
        return self.bend is not untouched


def with_moduli(material: Material, *, shear: float, bulk: float) -> Material:
    """The material with other moduli [Pa]; what it has without a unit (a stiffening) stays."""
    law = laws.get(material.law)
    plain = {n: material.parameters[n] for n, (unit, _) in law.parameters.items() if unit != "Pa"}
    return replace(material, parameters={**law.from_moduli(shear, bulk), **plain})


def cantilever(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-free"


def bridge(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-clamped"
