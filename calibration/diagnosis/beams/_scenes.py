"""From a state to the beams that it stands for: each trial's scene with the effects that reach it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.beams._candidates import reaches
from calibration.diagnosis.beams._pictures import Image
from calibration.diagnosis.beams.effects import BeamEffect, Situation
from calibration.diagnosis.nested import State
from calibration.experiment.model import BeamTrial, Experiment
from calibration.outlines import Fidelity, beam_scene
from tisim import Beam, Material, material_from_moduli

Array = NDArray[np.float64]
Kind = tuple[str, float | None]  # an effect and its place

# Without stiffening it is the neo-Hookean law of isochoric strain; the baseline and its extension must not
# differ in how they take volume.
LAW = "yeoh"
BULK = 300.0  # over the shear modulus, as calibrations expect it


@dataclass(frozen=True, kw_only=True)
class Nudge:
    """One step of an effect in every trial that it can touch, on top of what a state has there."""

    kind: Kind
    step: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Scenes:
    """Trials with the specimen (by index) that each one's modulus belongs to. pose: what is done to every
    scene at last, for experiments that are thought of only."""

    experiment: Experiment
    trials: Sequence[BeamTrial]
    specimen: Sequence[int]
    effects: Mapping[str, BeamEffect]
    pose: Callable[[Beam, BeamTrial], Beam] | None = None

    def inside(self, trial: int, state: State, nudge: Nudge | None = None) -> dict[Kind, float]:
        """Amplitudes of the effects that are in a trial."""
        t = self.trials[trial]
        found: dict[Kind, float] = {}
        for c, a in state.amplitudes.items():
            if reaches(c, t, self.effects[c.effect]):
                found[(c.effect, c.place)] = found.get((c.effect, c.place), 0.0) + a
        if nudge is not None and self.effects[nudge.kind[0]].touches(t):
            found[nudge.kind] = found.get(nudge.kind, 0.0) + nudge.step
        return {kind: a for kind, a in found.items() if a != 0.0}

    def beam(
        self, trial: int, state: State, *, time: float, fidelity: Fidelity, nudge: Nudge | None = None
    ) -> Beam:
        """A trial's beam, `time` [s] after its release."""
        t = self.trials[trial]
        beam = self.baseline(t, float(state.u[self.specimen[trial]]), fidelity)
        inside = self.inside(trial, state, nudge)
        # what changes the law goes before what changes its moduli, everything else in the catalogue's order
        order = list(self.effects)
        for name, place in sorted(inside, key=lambda k: (k[0] != "strain-stiffening", order.index(k[0]))):
            situation = Situation(trial=t, time=time, place=place)
            beam = self.effects[name].bend(beam, inside[(name, place)], situation)
        return beam if self.pose is None else self.pose(beam, t)

    def images(self, trial: int, state: State, *, time: float, nudge: Nudge | None = None) -> list[Image]:
        """What the camera does to the picture of a trial."""
        found: list[Image] = []
        for (name, place), a in self.inside(trial, state, nudge).items():
            image = self.effects[name].image
            if image is not None:
                situation = Situation(trial=self.trials[trial], time=time, place=place)
                found.append(partial(_shown, image, a, situation))
        return found

    def key(self, trial: int, state: State, *, time: float, nudge: Nudge | None = None) -> tuple[object, ...]:
        """What a photograph's scene depends on: equal keys, equal scenes."""
        bending = {k: a for k, a in self.inside(trial, state, nudge).items() if self.effects[k[0]].bends}
        timed = any(self.effects[name].timed for name, _ in bending)
        modulus = float(state.u[self.specimen[trial]])
        return (trial, modulus, tuple(sorted(bending.items(), key=str)), time if timed else None)

    def baseline(self, trial: BeamTrial, log_shear: float, fidelity: Fidelity) -> Beam:
        """The ideal beam of a trial."""
        shear = float(np.exp(log_shear))
        density = self.experiment.materials[trial.material].density
        assert density is not None, "checked when the model is made"
        return beam_scene(trial, self.material(shear), density=density, fidelity=fidelity)

    @staticmethod
    def material(shear: float) -> Material:
        return material_from_moduli(LAW, shear=shear, bulk=BULK * shear)


def _shown(
    image: Callable[[Array, float, Situation], Array], amplitude: float, situation: Situation, points: Array
) -> Array:
    return image(points, amplitude, situation)
