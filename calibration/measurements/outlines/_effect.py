"""How an effect enters photographed beams: the scene, or the picture of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial
from calibration.measurements._effect import EffectModel
from calibration.measurements.outlines.simulators import Simulator
from tisim import Beam, Material, laws

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What an effect may look at besides the scene: the trial, when the photograph was taken [s], and where
    in the specimen it sits (part of the free length)."""

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
    """`applies_to` is asked of a photograph's trial.

    Attributes
    ----------
    bend : the scene with the effect in it.
    image : where the photograph shows points (k, 2) [m] of the scene.
    timed : photographs of one trial differ by it.
    instead : for a fault of the simulator, the scene without it; the amplitude is the fraction of the way
        there.
    faulty : which simulators may have it.
    """

    bend: Callable[[Beam, float, Situation], Beam] = untouched
    image: Callable[[Array, float, Situation], Array] | None = None
    timed: bool = False
    instead: Callable[[Beam], Beam] | None = None
    faulty: Callable[[Simulator], bool] = any_simulator

    @property
    def bends(self) -> bool:
        """True if it changes the scene, and not only its picture."""
        return self.bend is not untouched

    def acts_on(self, record: Any) -> bool:
        """True if a trial, or the trial of a photograph, can have it."""
        return self.applies_to(getattr(record, "trial", record))

    def labels(self, record: Any) -> tuple[str, ...]:
        """Any group of a trial may be named, by a rig's file too."""
        trial: BeamTrial = getattr(record, "trial", record)
        return (trial.id, trial.material, trial.specimen or trial.material)


def with_moduli(material: Material, *, shear: float, bulk: float) -> Material:
    """The material with other moduli [Pa]; what it has without a unit (a stiffening) stays."""
    law = laws.get(material.law)
    plain = {n: material.parameters[n] for n, (unit, _) in law.parameters.items() if unit != "Pa"}
    return replace(material, parameters={**law.from_moduli(shear, bulk), **plain})


def cantilever(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-free"


def bridge(trial: BeamTrial) -> bool:
    return trial.supports == "clamped-clamped"
