"""Static beams, ideal and imperfect, solved in sequence."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from tisim.nonlinear.newton import Outcome
from tisim.parallel.threads import one_thread
from tisim.problems.beam.course import Path, follow
from tisim.problems.beam.equilibrium import Neighbour, equilibrium
from tisim.problems.beam.imperfect import imperfect_equilibrium
from tisim.problems.beam.rest_shape import is_ideal
from tisim.problems.beam.system import BeamSystem, beam_discretisation, beam_system
from tisim.result import Cost, Result, Status
from tisim.scene import Beam


def solve_beam(scene: Beam) -> Result:
    """Equilibrium of a beam: one frame at load 1, or the frames of its course."""
    return next(solve_beams([scene]))


def solve_beams(scenes: Sequence[Beam]) -> Iterator[Result]:
    """Equilibria of beams in sequence, each started from the previous one if that has the same mesh."""
    neighbour: Neighbour | None = None
    for scene in scenes:
        with one_thread():
            result, neighbour = _solve(scene, neighbour)
        yield result


def _solve(scene: Beam, neighbour: Neighbour | None) -> tuple[Result, Neighbour | None]:
    """Result of one beam, and start values of the next beam on its mesh."""
    mesh_start = time.process_time()
    discretisation = beam_discretisation(scene)
    mesh_seconds = time.process_time() - mesh_start
    start = time.process_time()
    if scene.course is not None:
        path, status, neighbour = follow(scene, discretisation, neighbour)
        spent = time.process_time() - start
        return _along_course(scene, path, status, mesh_seconds, spent), neighbour
    if is_ideal(scene):
        system = beam_system(scene, discretisation)
        outcome, counts, neighbour = equilibrium(scene, system, neighbour)
        reached = f"{system.factor:.3g} of the load"
    else:
        found = imperfect_equilibrium(scene, discretisation, neighbour)
        system, outcome, counts, neighbour = found.system, found.outcome, found.counts, found.neighbour
        reached = f"{found.part:.3g} of the imperfections"
    spent = time.process_time() - start
    return _result(scene, system, outcome, counts, reached, mesh_seconds, spent), neighbour


def _along_course(scene: Beam, path: Path, status: Status, mesh_s: float, core_s: float) -> Result:
    """Result of a beam with a course, with the frames up to the end of the solution."""
    frames, mesh = path.frames, path.system.body.discretisation.mesh
    n, done = len(frames), status is Status.CONVERGED
    return Result(
        scene=scene,
        status=status,
        message="" if done else f"no equilibrium found beyond {path.time:.4g} s ({status.value})",
        mesh=mesh,
        load=np.array([f.value for f in frames]),
        positions=np.array([f.x for f in frames]).reshape(n, mesh.n_nodes, 3),
        support_force=np.array([f.support for f in frames]).reshape(n, 3),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.residual for f in frames]),
        time=np.array([f.time for f in frames]),
        dissipated=np.array([f.dissipated for f in frames]) if scene.material.remembers else None,
        cost=Cost(
            core_seconds=core_s,
            mesh_seconds=mesh_s,
            steps=path.steps,
            newton_iterations=path.system.counts["newton"],
            factorisations=path.system.counts["factorisations"],
            step_cuts=path.cuts,
        ),
    )


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
    support = body.discretisation.support_force(force - body.dead_load)
    done = outcome.status is Status.CONVERGED
    load = system.body.load_norm()
    residual = system.residual_norm(outcome.x) / load if load > 0.0 else outcome.residual
    return Result(
        scene=scene,
        status=outcome.status,
        message="" if done else f"no equilibrium found beyond {reached} ({outcome.status.value})",
        mesh=body.discretisation.mesh,
        load=np.array([1.0]) if done else np.zeros(0),
        positions=outcome.x[None] if done else np.zeros((0, *outcome.x.shape)),
        support_force=support[None] if done else np.zeros((0, 3)),
        min_jacobian=np.full(int(done), min_jacobian),
        residual=np.full(int(done), residual),
        cost=Cost(
            core_seconds=core_s,
            mesh_seconds=mesh_s,
            steps=counts["steps"],
            newton_iterations=system.counts["newton"],
            factorisations=system.counts["factorisations"],
            step_cuts=counts["cuts"],
        ),
    )
