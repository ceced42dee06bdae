"""The paper's stopping rule, to reproduce the end of its simulations. It detects slowness, not equilibrium.

Paper, Data Generation: "run until equilibrium, defined as the root-mean-square nodal displacement, measured
as the change in node position over consecutive 50-step windows, remaining below 1 mm, averaged across three
consecutive windows (150 steps total)". At its steps of 1 ms a motion of 20 mm/s meets the rule.
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
    """State at which the rule stops a run.

    Attributes
    ----------
    time : time [s].
    motion : mean of the windows' RMS displacements [m].
    rms_distance, largest_distance : distance of the nodes from the given equilibrium [m].
    residual : static out-of-balance force relative to the load.
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
    """First state at which a dynamic run meets the rule; None if it never does or has no frames.

    Parameters
    ----------
    run : Result
        A run of the method "implicit" or "explicit". Its frames are evenly spaced, except the last, and
        divide the window.
    equilibrium : ndarray of float, shape (n, 3)
        Node positions [m] by the static method on the same mesh.
    window_steps, windows : int
        Steps per window, and number of consecutive windows.
    threshold : float
        RMS displacement over all nodes of the mesh [m].
    step : float
        Length of one of the paper's steps [s].

    Raises
    ------
    ValueError
        If the shape of `equilibrium` is wrong or the frames do not divide the window.
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
