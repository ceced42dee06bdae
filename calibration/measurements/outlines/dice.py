"""The paper's objective: the overlap (Dice) of simulated beams with bodies swept along measured mid lines.

Not a likelihood: it knows no tracing error, no registration and no nuisance, so it has no error bars, and a
cost of it cannot be added to a chi-square. It is here to compare with what was published.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calibration import metrics
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief
from calibration.measurements.outlines.fidelity import Fidelity, beam_scene
from calibration.shape import body_mesh, centreline, sweep
from tisim import Beam, Material, Result, simulate

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

# The cost counts Dice lost in steps of SCALE^2 = 1e-4: what a 20 mm beam loses by 1.6 micrometres of sideways
# shift. A search that stops when costs agree to 0.5 has the sum over all photographs to 5e-5.
SCALE = 1e-2

# Two rings: with the search's single ring the section is a body of its own, 6 parabolas round.
DICE_FIDELITY = Fidelity()
# Flat triangles along each side of a curved facet: 12 sides of 4 lose 0.29 % of the area, nearly alike
# whatever the material, so that they lower a Dice by up to 0.0014 and leave its place alone.
_SUBDIVIDE = 4


@dataclass(frozen=True, eq=False)
class MeasuredBody:
    """One traced photograph of a trial as a body: the rest section swept along its mid line [m]."""

    name: str
    trial: int
    body: trimesh.Trimesh


class DiceObjective:
    """Traced outlines of one material's beams as overlaps of bodies; a `calibration.inference.Objective`.

    residual of a photograph: sqrt(1 - Dice) / SCALE, so that the squared sum is that of (1 - Dice) / SCALE^2.
    It is no smooth function of the parameters where a body fits exactly: search it, never polish it by
    Gauss-Newton. Specimens are taken as the lab states them, density included; photographs as they lie.
    fidelity: of the simulated beams. InputError where the density is not stated, no trial has an outline, or
    an outline gives no body.
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
                " tells only the ratio of weight to stiffness"
            )
        self.trials = [t for t in trials if any(c.outline for c in t.captures)]
        if not self.trials:
            raise InputError(f"material {belief.name}: expected at least one beam with a traced outline")
        self.name = f"Dice of {belief.name}"
        self.density = belief.density
        self.fidelity = fidelity
        self.workers = workers
        self.measured = [body for i, t in enumerate(self.trials) for body in measured_bodies(t, index=i)]

    @property
    def points(self) -> int:
        """Photographs."""
        return len(self.measured)

    def size(self) -> int:
        return len(self.measured)

    def residuals(self, materials: Sequence[Material]) -> Array:
        """(batch, photographs): sqrt(1 - Dice) / SCALE; NaN as `overlaps`."""
        return np.asarray(np.sqrt(1.0 - self.overlaps(materials)) / SCALE)

    def overlaps(self, materials: Sequence[Material]) -> Array:
        """Dice of each photograph (batch, photographs). A whole row is NaN where a beam of that material has
        no equilibrium, or hangs so far that its surface crosses itself and bounds no body."""
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


def measured_bodies(trial: BeamTrial, *, index: int = 0) -> list[MeasuredBody]:
    """A body for each traced photograph of a trial, without what the grips hold (as tisim's beams are).

    InputError, with the trial's name, where an outline has no mid line to sweep along.
    """
    found = []
    for c in trial.captures:
        if c.outline is None:
            continue
        name = f"{trial.id} at {c.time:g} s"
        try:
            line = centreline(c.outline, supports=trial.supports, free_length=trial.free_length)
            found.append(MeasuredBody(name, index, sweep(line, trial.section)))
        except InputError as error:
            raise InputError(f"trial {name}: {error}") from error
    return found
