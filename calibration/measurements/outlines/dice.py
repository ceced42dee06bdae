"""The paper's objective: the overlap (Dice) of simulated beams with bodies swept along measured mid lines.

It is not a likelihood: it has no model of tracing error, registration or nuisances, so it gives no
uncertainty, and its cost cannot be added to a chi-square. It is for comparison with published results.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calibration import metrics
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment, MaterialBelief
from calibration.inference import OfMaterial
from calibration.measurements._contribution import Contribution, FitContext
from calibration.measurements.outlines._photographs import names_of
from calibration.measurements.outlines.fidelity import Fidelity, beam_scene
from calibration.shape import body_mesh, centreline, sweep
from tisim import Beam, Material, Result, simulate

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

# The unit of the cost is a loss of Dice of SCALE^2 = 1e-4, as by a sideways shift of 1.6 micrometres of a
# 20 mm beam. A search that stops when costs agree to 0.5 has the sum over all photographs to 5e-5.
SCALE = 1e-2

# Two radial elements: with the search's single one the section has only 6 parabolas around, a visibly
# different shape.
DICE_FIDELITY = Fidelity()
# Flat triangles along each side of a curved facet: 12 sides of 4 lose 0.29 % of the area, nearly independent
# of the material: they lower a Dice by up to 0.0014 and do not move its optimum.
_SUBDIVIDE = 4


@dataclass(frozen=True, eq=False)
class MeasuredBody:
    """Body of a traced photograph: the rest section swept along its mid line [m].

    Attributes
    ----------
    name : trial and time of the photograph.
    trial : index of the trial.
    body : surface of the body.
    """

    name: str
    trial: int
    body: trimesh.Trimesh


class DiceObjective:
    """Overlap of bodies for the traced outlines of one material; a `calibration.inference.Objective`.

    The residual of a photograph is sqrt(1 - Dice) / SCALE, so that the sum of squares is that of
    (1 - Dice) / SCALE^2. It is not smooth in the parameters where a body fits exactly: use a search, not
    Gauss-Newton. Specimens are as the lab states them, including density; photographs are not registered.

    Parameters
    ----------
    trials : trials of the material; those without an outline are ignored.
    belief : the material's entry in the experiment, with its density.
    fidelity : discretisation of the simulated beams.
    workers : number of processes, as in `tisim.simulate`.

    Raises
    ------
    InputError
        If the density is not stated, no trial has an outline, or an outline gives no body.
    """

    def __init__(
        self,
        trials: Sequence[BeamTrial],
        belief: MaterialBelief,
        *,
        fidelity: Fidelity = DICE_FIDELITY,
        workers: int | None = None,
    ) -> None:
        if belief.density is None:
            raise InputError(
                f"experiment.yaml: materials.{belief.name}.density_kg_m3: expected, since a beam's shape"
                " determines only the ratio of weight to stiffness"
            )
        self.trials = [t for t in trials if t.traced]
        if not self.trials:
            raise InputError(f"material {belief.name}: expected at least one beam with a traced outline")
        self.name = f"Dice of {belief.name}"
        self.density = belief.density
        self.fidelity = fidelity
        self.workers = workers
        self.measured = [body for i, t in enumerate(self.trials) for body in measured_bodies(t, index=i)]

    @property
    def points(self) -> int:
        """Number of photographs."""
        return len(self.measured)

    def size(self) -> int:
        return len(self.measured)

    def residuals(self, materials: Sequence[Material]) -> Array:
        """sqrt(1 - Dice) / SCALE, shape (batch, photographs); NaN as in `overlaps`."""
        return np.asarray(np.sqrt(1.0 - self.overlaps(materials)) / SCALE)

    def overlaps(self, materials: Sequence[Material]) -> Array:
        """Dice of each photograph, shape (batch, photographs).

        A row is NaN if a beam of that material has no equilibrium, or a surface that intersects itself.
        """
        found = np.full((len(materials), len(self.measured)), np.nan)
        for k, results in enumerate(self._simulate(materials)):
            if not all(r.ok for r in results):
                continue
            try:
                bodies = [body_mesh(r, subdivide=_SUBDIVIDE) for r in results]
                found[k] = [metrics.dice(bodies[m.trial], m.body) for m in self.measured]
            except InputError:
                found[k] = np.nan
        return found

    def _simulate(self, materials: Sequence[Material]) -> list[list[Result]]:
        # one trial after the other, so that neighbours in a batch share a mesh
        scenes = [self._beam(t, m) for t in self.trials for m in materials]
        results = simulate(scenes, workers=self.workers)
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]

    def _beam(self, trial: BeamTrial, material: Material) -> Beam:
        return beam_scene(trial, material, density=self.density, fidelity=self.fidelity)


def overlap(own: Experiment, context: FitContext) -> Contribution:
    """Objective of traced beams of one material. InputError if the setup is known, which only a likelihood
    can use."""
    if context.setup is not None:
        raise InputError("a known rig corrects outlines: expected the objective likelihood, not dice")
    beams = [t for t in own.trials if isinstance(t, BeamTrial)]
    dice = DiceObjective(beams, own.materials[beams[0].material], workers=context.workers)
    return Contribution(objectives=(OfMaterial(context.law, dice),))


def measured_bodies(trial: BeamTrial, *, index: int = 0) -> list[MeasuredBody]:
    """Bodies of a trial's traced photographs, without the parts in the grips (as tisim's beams).

    InputError, with the trial's name, if an outline has no mid line.
    """
    found = []
    outlines = [c.outline for c in trial.captures if c.outline is not None]
    for name, outline in zip(names_of(trial), outlines, strict=True):
        try:
            line = centreline(outline, supports=trial.supports, free_length=trial.free_length)
            found.append(MeasuredBody(name, index, sweep(line, trial.section)))
        except InputError as error:
            raise InputError(f"trial {name}: {error}") from error
    return found
