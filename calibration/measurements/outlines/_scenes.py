"""Scenes of a state: the beam of each trial, with the effects that apply to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial, Experiment, specimen_of
from calibration.measurements._baseline import Baseline
from calibration.measurements._effect import reaches
from calibration.measurements._state import State
from calibration.measurements.outlines._effect import OutlineEffect, Situation
from calibration.measurements.outlines._photographs import Image
from calibration.measurements.outlines.fidelity import Fidelity, beam_scene
from calibration.measurements.outlines.setup import Setup
from tisim import Beam, Course, Material, material_from_moduli

Array = NDArray[np.float64]
Form = tuple[str, float | None]  # an effect and its position

# Without stiffening this is the neo-Hookean law of a fit. A law with another volumetric term (Yeoh's) has, at
# strains of 0.7 and this K/G, a modulus that differs by an eighth of its sd.
LAW = "stiffening-neo-hookean"
BULK_RATIO = 300.0  # K/G, the centre of its prior in fits


@dataclass(frozen=True, eq=False, kw_only=True)
class Scenes:
    """Scenes of trials.

    Attributes
    ----------
    experiment : the experiment.
    trials : trials of beams.
    baseline : material of each trial's specimen.
    effects : effects by name.
    pose : function that is applied to each scene last, for hypothetical experiments; None for none.
    setup : known setup of rig and camera, applied to each scene and image before any effect; None for none.
    """

    experiment: Experiment
    trials: Sequence[BeamTrial]
    baseline: Baseline
    effects: Mapping[str, OutlineEffect]
    pose: Callable[[Beam, BeamTrial], Beam] | None = None
    setup: Setup | None = None

    def inside(self, trial: int, state: State) -> dict[Form, float]:
        """Amplitudes of the effects in a trial, by effect and position."""
        t = self.trials[trial]
        found: dict[Form, float] = {}
        for c, a in state.amplitudes.items():
            if reaches(c, t, self.effects[c.effect]):
                found[(c.effect, c.position)] = found.get((c.effect, c.position), 0.0) + a
        return {kind: a for kind, a in found.items() if a != 0.0}

    def beam(self, trial: int, state: State, *, time: float, fidelity: Fidelity) -> Beam:
        """Beam of a trial, `time` [s] after its release; with viscosity, a beam under load from time 0."""
        t = self.trials[trial]
        beam = self.plain(t, state.u, fidelity)
        inside = self.inside(trial, state)
        # the effect that changes the law precedes those that change its moduli; else the catalogue's order
        order = list(self.effects)
        for name, position in sorted(inside, key=lambda k: (k[0] != "strain-stiffening", order.index(k[0]))):
            situation = Situation(trial=t, time=time, position=position)
            beam = self.effects[name].bend(beam, inside[(name, position)], situation)
        beam = beam if self.pose is None else self.pose(beam, t)
        return beam if beam.material.viscosity is None else hanging(beam, (time,))

    def images(self, trial: int, state: State, *, time: float) -> list[Image]:
        """Maps from the scene of a trial to its image, in order."""
        t = self.trials[trial]
        found: list[Image] = [] if self.setup is None else [partial(self.setup.image, trial=t)]
        for (name, position), a in self.inside(trial, state).items():
            image = self.effects[name].image
            if image is not None:
                situation = Situation(trial=t, time=time, position=position)
                found.append(partial(_shown, image, a, situation))
        return found

    def key(self, trial: int, state: State, *, time: float) -> tuple[object, ...]:
        """Key of a photograph's scene: scenes of equal keys differ only in frame times of viscous beams."""
        bending = {k: a for k, a in self.inside(trial, state).items() if self.effects[k[0]].bends}
        timed = any(self.effects[name].timed for name, _ in bending)
        material = self.material(self.trials[trial], state.u)
        values = tuple(sorted(material.parameters.items(), key=str))
        inside = tuple(sorted(bending.items(), key=str))
        return (trial, material.law, values, material.viscosity, inside, time if timed else None)

    def plain(self, trial: BeamTrial, u: Array, fidelity: Fidelity) -> Beam:
        """Beam of a trial without effects, with the known setup of the rig."""
        return self._ideal(trial, self.material(trial, u), fidelity)

    def elastic(self, trial: int, material: Material, fidelity: Fidelity) -> Beam:
        """Beam of a trial (by index) without effects, with an elastic material."""
        beam = self._ideal(self.trials[trial], material, fidelity)
        return beam if self.pose is None else self.pose(beam, self.trials[trial])

    def _ideal(self, trial: BeamTrial, material: Material, fidelity: Fidelity) -> Beam:
        density = self.experiment.materials[trial.material].density
        assert density is not None, "checked when the model is made"
        beam = beam_scene(trial, material, density=density, fidelity=fidelity)
        return beam if self.setup is None else self.setup.bend(beam, trial)

    def material(self, trial: BeamTrial, u: Array) -> Material:
        """Material of a trial's beam."""
        specimen = specimen_of(trial)
        if self.baseline.whole:
            return self.baseline.material(specimen, u)
        shear = self.baseline.shear_modulus(specimen, u)
        return material_from_moduli(LAW, shear_modulus=shear, bulk_modulus=self.baseline.bulk_ratio * shear)


def hanging(beam: Beam, times: Sequence[float]) -> Beam:
    """Beam under its load from time 0, quasi-static, with a frame at each of these increasing times [s]."""
    return replace(beam, course=Course(frames=tuple(times)).jump(1.0).hold(times[-1]))


def _shown(
    image: Callable[[Array, float, Situation], Array], amplitude: float, situation: Situation, points: Array
) -> Array:
    return image(points, amplitude, situation)
