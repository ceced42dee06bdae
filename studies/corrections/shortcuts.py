"""Simulations with one shortcut each: a section with corners, and runs that the paper's rule stops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

import tisim
from calibration.experiment import BeamTrial
from calibration.measurements.outlines import Fidelity
from studies.corrections.bench import Beams
from tisim import paper_stop

# Rayleigh coefficients [1/s] and [s]; SOFA's customary ones are 0.1 and 0.1
DAMPINGS = ((0.1, 0.01), (0.1, 0.1), (0.1, 0.3))
STOP_STEP = 5e-3  # [s] of the dynamic runs; the rule's window is 50 ms
LONGEST = 4.0  # [s] that a run may take to be stopped


class Faceted(Beams):
    """Quadratic elements with straight sides in a polygon inscribed in the section's circle."""

    def simulate(self, materials: Sequence[tisim.Material]) -> list[list[tisim.Result]]:
        meshes = [inscribed(t, self.fidelity) for t in self.trials]
        results = tisim.simulate(
            [
                replace(self.beam(t, m), mesh=mesh)
                for t, mesh in zip(self.trials, meshes, strict=True)
                for m in materials
            ],
            workers=1,
        )
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]


@cache
def _inscribed(length: float, radius: float, supports: str, layer: float, rings: int) -> tisim.Mesh:
    plain = tisim.mesh.beam_mesh(
        length=length,
        section=tisim.Circle(radius=radius),
        supports=supports,  # type: ignore[arg-type]
        kind="tet4",
        axial_element_size=layer,
        radial_elements=rings,
        mirror=True,
    )
    nodes = plain.nodes.copy()
    nodes[:, 1:] *= radius / np.hypot(nodes[:, 1], nodes[:, 2]).max()
    return tisim.mesh.to_quadratic(replace(plain, nodes=nodes))


def inscribed(trial: BeamTrial, fidelity: Fidelity) -> tisim.Mesh:
    assert isinstance(trial.section, tisim.Circle)
    return _inscribed(
        trial.free_length,
        trial.section.radius,
        trial.supports,
        fidelity.axial_element_size,
        fidelity.radial_elements,
    )


class Stopped(Beams):
    """Beams released from the straight shape, seen where the paper's rule stops the run."""

    damping = DAMPINGS[0]

    def simulate(self, materials: Sequence[tisim.Material]) -> list[list[tisim.Result]]:
        return [[self._stopped(self.beam(t, m)) for t in self.trials] for m in materials]

    def _stopped(self, beam: tisim.Beam) -> tisim.Result:
        duration = 0.5
        while True:
            mass, stiffness = self.damping
            solver = tisim.Solver(
                method="implicit",
                tolerance=1e-4,
                duration=duration,
                time_step=STOP_STEP,
                mass_damping=mass,
                stiffness_damping=stiffness,
            )
            (run,) = tisim.simulate([replace(beam, solver=solver)], workers=1)
            # the rule itself does not look at the equilibrium; the distance from it is not asked for
            stop = paper_stop(run, run.mesh.nodes) if len(run.load) else None
            if stop is not None:
                at = int(np.argmin(np.abs(run.load - stop.time)))
                return replace(run, status=tisim.Status.CONVERGED, positions=run.positions[at][None])
            if not run.ok or duration >= LONGEST:
                return replace(run, status=tisim.Status.UNFINISHED)
            duration *= 2
