"""Dynamics of beams, released from the straight rest shape at time 0 under the full load."""

from __future__ import annotations

import time

import numpy as np

from tisim.parallel.threads import one_thread
from tisim.problems._registry import OnStep, skip
from tisim.problems.beam.system import beam_discretisation, beam_system
from tisim.problems.dynamics import explicit, implicit
from tisim.result import Cost, Result
from tisim.scene import Beam


@one_thread()
def solve_dynamic(scene: Beam, *, on_step: OnStep = skip) -> Result:
    """Motion of a beam by scene.solver.method, "implicit" or "explicit"; ValueError for another method.

    The result's `load` is the time [s]. It has at most 500 frames and one at the end. Its `residual` is the
    static out-of-balance force relative to the load, which measures the distance from equilibrium.
    """
    march = {"implicit": implicit.march, "explicit": explicit.march}.get(scene.solver.method)
    if march is None:
        raise ValueError(f"solver: {scene.solver.method!r} is not a dynamic method ('implicit', 'explicit')")
    mesh_start = time.process_time()
    discretisation = beam_discretisation(scene)
    start = time.process_time()
    run = march(beam_system(scene, discretisation).body, scene.solver, on_step=on_step)
    core_seconds = time.process_time() - start
    frames = run.frames
    n = len(frames.time)
    return Result(
        scene=scene,
        status=run.status,
        message=run.message,
        mesh=discretisation.mesh,
        load=np.array(frames.time),
        positions=np.array(frames.positions).reshape(n, discretisation.mesh.n_nodes, 3),
        support_force=np.array(frames.support_force).reshape(n, 3),
        min_jacobian=np.array(frames.min_jacobian),
        residual=np.array(frames.residual),
        time=np.array(frames.time),
        dissipated=np.array(frames.dissipated) if scene.material.remembers else None,
        cost=Cost(
            core_seconds=core_seconds,
            mesh_seconds=start - mesh_start,
            steps=run.steps,
            newton_iterations=run.newton_iterations,
            factorisations=run.factorisations,
            step_cuts=run.step_cuts,
        ),
    )
