"""From a state to the beams that it stands for: each trial's scene with the effects that reach it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial, Experiment
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

# Without stiffening it is the neo-Hookean law, as a fit has it: at strains of 0.7 and this K/G one that takes
# volume in another way (Yeoh's) has another modulus, by an eighth of its sd.
LAW = "stiffening-neo-hookean"
BULK_RATIO = 300.0  # K/G, as fits expect it


@dataclass(frozen=True, eq=False, kw_only=True)
class Scenes:
    """Scenes of trials.

    Attributes
    ----------
    baseline : gives each trial's specimen its material.
    pose : what is done to every scene at last, for experiments that are only considered.
    setup : what is known of rig and camera, applied to every scene and picture before any effect.
    """

    experiment: Experiment
    trials: Sequence[BeamTrial]
    baseline: Baseline
    effects: Mapping[str, OutlineEffect]
    pose: Callable[[Beam, BeamTrial], Beam] | None = None
    setup: Setup | None = None

    def inside(self, trial: int, state: State) -> dict[Form, float]:
        """Amplitudes of the effects that are in a trial."""
        t = self.trials[trial]
        found: dict[Form, float] = {}
        for c, a in state.amplitudes.items():
            if reaches(c, t, self.effects[c.effect]):
                found[(c.effect, c.position)] = found.get((c.effect, c.position), 0.0) + a
        return {kind: a for kind, a in found.items() if a != 0.0}

    def beam(self, trial: int, state: State, *, time: float, fidelity: Fidelity) -> Beam:
        """A trial's beam, `time` [s] after its release; of a viscous material one that hangs from then on."""
        t = self.trials[trial]
        beam = self.plain(t, state.u, fidelity)
        inside = self.inside(trial, state)
        # what changes the law goes before what changes its moduli, everything else in the catalogue's order
        order = list(self.effects)
        for name, position in sorted(inside, key=lambda k: (k[0] != "strain-stiffening", order.index(k[0]))):
            situation = Situation(trial=t, time=time, position=position)
            beam = self.effects[name].bend(beam, inside[(name, position)], situation)
        beam = beam if self.pose is None else self.pose(beam, t)
        return beam if beam.material.viscosity is None else hanging(beam, (time,))

    def images(self, trial: int, state: State, *, time: float) -> list[Image]:
        """What the camera does to the picture of a trial."""
        t = self.trials[trial]
        found: list[Image] = [] if self.setup is None else [partial(self.setup.image, trial=t)]
        for (name, position), a in self.inside(trial, state).items():
            image = self.effects[name].image
            if image is not None:
                situation = Situation(trial=t, time=time, position=position)
                found.append(partial(_shown, image, a, situation))
        return found

    def key(self, trial: int, state: State, *, time: float) -> tuple[object, ...]:
        """What a photograph's scene depends on: equal keys, equal scenes, but for the times at which a
        viscous beam is photographed."""
        bending = {k: a for k, a in self.inside(trial, state).items() if self.effects[k[0]].bends}
        timed = any(self.effects[name].timed for name, _ in bending)
        material = self.material(self.trials[trial], state.u)
        values = tuple(sorted(material.parameters.items(), key=str))
        inside = tuple(sorted(bending.items(), key=str))
        return (trial, material.law, values, material.viscosity, inside, time if timed else None)

    def plain(self, trial: BeamTrial, u: Array, fidelity: Fidelity) -> Beam:
        """The beam of a trial without effects, ideal but for what is known of the rig."""
        return self._ideal(trial, self.material(trial, u), fidelity)

    def elastic(self, trial: int, material: Material, fidelity: Fidelity) -> Beam:
        """The beam of a trial, by its index, without effects, of a material that does not creep."""
        beam = self._ideal(self.trials[trial], material, fidelity)
        return beam if self.pose is None else self.pose(beam, self.trials[trial])

    def _ideal(self, trial: BeamTrial, material: Material, fidelity: Fidelity) -> Beam:
        density = self.experiment.materials[trial.material].density
        assert density is not None, "checked when the model is made"
        beam = beam_scene(trial, material, density=density, fidelity=fidelity)
        return beam if self.setup is None else self.setup.bend(beam, trial)

    def material(self, trial: BeamTrial, u: Array) -> Material:
        """What a trial's beam is made of."""
        specimen = trial.specimen or trial.material
        if self.baseline.whole:
            return self.baseline.material(specimen, u)
        shear = self.baseline.shear_modulus(specimen, u)
        return material_from_moduli(LAW, shear_modulus=shear, bulk_modulus=self.baseline.bulk_ratio * shear)


def hanging(beam: Beam, times: Sequence[float]) -> Beam:
    """A beam that hangs from time 0 on, without inertia, with a frame at each of these times [s], rising."""
    return replace(beam, course=Course(frames=tuple(times)).jump(1.0).hold(times[-1]))


def _shown(
    image: Callable[[Array, float, Situation], Array], amplitude: float, situation: Situation, points: Array
) -> Array:
    return image(points, amplitude, situation)
