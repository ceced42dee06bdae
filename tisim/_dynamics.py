"""Beams through time: released from the straight rest shape at time 0 under the full load."""

from __future__ import annotations

import time

import numpy as np

from tisim import _explicit, _implicit
from tisim._beam_system import beam_layout, beam_system
from tisim.result import Cost, Result
from tisim.scene import Beam


def solve_dynamic(scene: Beam) -> Result:
    """Motion of a beam by scene.solver.method, "implicit" or "explicit".

    The result's frames are counted by time [s], at most 500 of them and the end; `residual` is the static
    out-of-balance force against the load, which is what is left to rest.
    """
    march = {"implicit": _implicit.march, "explicit": _explicit.march}.get(scene.solver.method)
    if march is None:
        raise ValueError(f"solver: {scene.solver.method!r} is not a dynamic method ('implicit', 'explicit')")
    mesh_start = time.process_time()
    layout = beam_layout(scene)
    start = time.process_time()
    run = march(beam_system(scene, layout).body, scene.solver)
    core_seconds = time.process_time() - start
    frames = run.frames
    n = len(frames.time)
    return Result(
        scene=scene,
        status=run.status,
        message=run.message,
        mesh=layout.mesh,
        load=np.array(frames.time),
        positions=np.array(frames.positions).reshape(n, layout.mesh.n_nodes, 3),
        support_force=np.array(frames.support_force).reshape(n, 3),
        rod_force=np.zeros((n, 3)),
        rod_tip=np.zeros((n, 3)),
        penetration=np.zeros(n),
        min_jacobian=np.array(frames.min_jacobian),
        residual=np.array(frames.residual),
        nominal_stress=np.zeros(n),
        cost=Cost(
            core_seconds=core_seconds,
            mesh_seconds=start - mesh_start,
            steps=run.steps,
            newton_iterations=run.newton_iterations,
            factorisations=run.factorisations,
            step_cuts=run.step_cuts,
        ),
    )
