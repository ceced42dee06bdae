"""Static beams, ideal and imperfect ones, one after the other."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from tisim._beam_equilibrium import Neighbour, equilibrium
from tisim._beam_system import BeamSystem, beam_layout, beam_system
from tisim._imperfect import imperfect_equilibrium
from tisim._newton import Outcome
from tisim._specimen import is_ideal
from tisim.result import Cost, Result, Status
from tisim.scene import Beam


def solve_beam(scene: Beam) -> Result:
    """Equilibrium of a beam. The result has one frame, at load 1."""
    return next(solve_beams([scene]))


def solve_beams(scenes: Sequence[Beam]) -> Iterator[Result]:
    """Equilibria of beams one after the other, each started from the one before on the same mesh."""
    neighbour: Neighbour | None = None
    for scene in scenes:
        mesh_start = time.process_time()
        layout = beam_layout(scene)
        mesh_seconds = time.process_time() - mesh_start
        start = time.process_time()
        if is_ideal(scene):
            system = beam_system(scene, layout)
            outcome, counts, neighbour = equilibrium(scene, system, neighbour)
            reached = f"{system.factor:.3g} of the load"
        else:
            found = imperfect_equilibrium(scene, layout, neighbour)
            system, outcome, counts, neighbour = found.system, found.outcome, found.counts, found.neighbour
            reached = f"{found.part:.3g} of the imperfections"
        yield _result(scene, system, outcome, counts, reached, mesh_seconds, time.process_time() - start)


def _result(
    scene: Beam,
    system: BeamSystem,
    outcome: Outcome,
    counts: dict[str, int],
    reached: str,
    mesh_s: float,
    core_s: float,
) -> Result:
    body = system.body
    force, min_jacobian = body.internal_forces(outcome.x)
    support = force[body.layout.fixed].sum(axis=0) - body.dead_load[body.layout.fixed].sum(axis=0)
    support *= body.layout.multiplicity
    for axis in body.layout.mesh.symmetry:
        support["xyz".index(axis)] = 0.0
    done = outcome.status is Status.CONVERGED
    load = system.load_norm()
    residual = system.residual_norm(outcome.x) / load if load > 0.0 else outcome.residual
    return Result(
        scene=scene,
        status=outcome.status,
        message="" if done else f"no equilibrium found beyond {reached} ({outcome.status.value})",
        mesh=body.layout.mesh,
        load=np.array([1.0]) if done else np.zeros(0),
        positions=outcome.x[None] if done else np.zeros((0, *outcome.x.shape)),
        support_force=support[None] if done else np.zeros((0, 3)),
        rod_force=np.zeros((int(done), 3)),
        rod_tip=np.zeros((int(done), 3)),
        penetration=np.zeros(int(done)),
        min_jacobian=np.full(int(done), min_jacobian),
        residual=np.full(int(done), residual),
        nominal_stress=np.zeros(int(done)),
        cost=Cost(
            core_seconds=core_s,
            mesh_seconds=mesh_s,
            steps=counts["steps"],
            newton_iterations=system.counts["newton"],
            factorisations=system.counts["factorisations"],
            step_cuts=counts["cuts"],
        ),
    )
