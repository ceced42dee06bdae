"""The paper's stopping rule, to reproduce where its simulations ended. It finds slowness, not equilibrium.

Paper, Data Generation: "run until equilibrium, defined as the root-mean-square nodal displacement, measured
as the change in node position over consecutive 50-step windows, remaining below 1 mm, averaged across three
consecutive windows (150 steps total)". At its 1 ms steps a motion of 20 mm/s passes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.result import Result

Array = NDArray[np.float64]

PAPER_STEP = 1e-3  # [s]


@dataclass(frozen=True)
class PaperStop:
    """Where the rule stops a run.

    time [s]; motion: the mean of the windows' RMS displacements there [m]; rms_distance and
    largest_distance: of the nodes from the equilibrium given [m]; residual: static out-of-balance force
    there against the load.
    """

    time: float
    motion: float
    rms_distance: float
    largest_distance: float
    residual: float


def paper_stop(
    run: Result,
    equilibrium: Array,
    *,
    window_steps: int = 50,
    windows: int = 3,
    threshold: float = 1e-3,
    step: float = PAPER_STEP,
) -> PaperStop | None:
    """The first moment at which the rule is met by a dynamic run; None where it never is.

    run: of method "implicit" (or "explicit"), its frames no further apart than `step` [s] or a whole
    part of the window; equilibrium: node positions (n, 3) [m] from the static method on the same mesh.
    threshold [m]. The RMS is over all nodes of the mesh, in space.
    """
    if equilibrium.shape != run.mesh.nodes.shape:
        raise ValueError(f"equilibrium: expected shape {run.mesh.nodes.shape}, got {equilibrium.shape}")
    window = window_steps * step
    if len(run.load) == 0:
        return None
    spacing = float(run.load[0])
    apart = round(window / spacing)
    last = len(run.load) if np.isclose(run.load[-1], len(run.load) * spacing) else len(run.load) - 1
    even = np.allclose(run.load[:last], spacing * np.arange(1, last + 1), rtol=1e-9)
    if apart < 1 or not np.isclose(apart * spacing, window) or not even:
        raise ValueError(f"frames {spacing:g} s apart do not divide the rule's window of {window:g} s")
    states = np.concatenate([run.mesh.nodes[None], run.positions[:last]])
    moved = states[apart:] - states[:-apart]
    rms = np.sqrt((moved**2).sum(axis=2).mean(axis=1))  # rms[k]: between the states k and k + apart
    for k in range(windows * apart, len(states)):
        motion = float(np.mean([rms[k - (w + 1) * apart] for w in range(windows)]))
        if motion < threshold:
            distance = np.linalg.norm(states[k] - equilibrium, axis=1)
            return PaperStop(
                time=k * spacing,
                motion=motion,
                rms_distance=float(np.sqrt((distance**2).mean())),
                largest_distance=float(distance.max()),
                residual=float(run.residual[k - 1]),
            )
    return None
