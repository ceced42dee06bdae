"""What a simulation returns: frames, a status that never hides a failure, and what it cost."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from tisim.mesh import Mesh
from tisim.scene import Scene


class Status(StrEnum):
    """How a simulation ended. Every frame kept is good whatever the status."""

    CONVERGED = "converged"  # the whole load, depth or duration was reached
    NOT_CONVERGED = "not-converged"  # Newton failed after all step cuts
    INVERTED = "inverted-element"  # the next step would turn an element over
    PENETRATION = "penetration"  # the surface would pass the rod's edge beyond the tolerance
    SINGULAR = "singular"  # the linear solver failed
    DIVERGED = "diverged"  # a dynamic run lost its energy balance or became non-finite
    UNFINISHED = "unfinished"  # the duration ended before rest, where rest was asked for


@dataclass(frozen=True, kw_only=True)
class Cost:
    """core_seconds: CPU time of the solve; mesh_seconds: of making the mesh; counts of the work done.

    Counts of a poke: iterations are of the tissue near the rod, factorisations of that and of the far tissue.
    """

    core_seconds: float = 0.0
    mesh_seconds: float = 0.0
    steps: int = 0
    newton_iterations: int = 0
    factorisations: int = 0
    linear_iterations: int = 0
    step_cuts: int = 0


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """The answer to one scene.

    mesh: rest mesh the answer lives on; of a beam with an imperfect specimen, the ideal prism's (see
        `tisim.rest_positions`).
    load: what the frames are counted by, shape (f,): beam = part of the load (1.0 = all), poke = depth
        [m], coupon = stretch, dynamics = time [s].
    positions: node positions [m], shape (f, n, 3).
    support_force: force of the supports on the body [N], shape (f, 3), of the whole body.
    rod_force: force of the body on the rod [N], shape (f, 3) (zeros without a rod).
    rod_tip: centre of the rod's tip [m], shape (f, 3).
    penetration: deepest overlap of body and rod [m], shape (f,).
    min_jacobian: smallest det F at the integration points, shape (f,).
    residual: free nodes' residual relative to the applied load at each frame, shape (f,).
    nominal_stress: coupons' nominal stress in the pulled direction [Pa], shape (f,).
    message: one sentence for people where the status is not CONVERGED.
    """

    scene: Scene
    status: Status
    message: str
    mesh: Mesh
    load: NDArray[np.float64]
    positions: NDArray[np.float64]
    support_force: NDArray[np.float64]
    rod_force: NDArray[np.float64]
    rod_tip: NDArray[np.float64]
    penetration: NDArray[np.float64]
    min_jacobian: NDArray[np.float64]
    residual: NDArray[np.float64]
    nominal_stress: NDArray[np.float64]
    cost: Cost

    @property
    def ok(self) -> bool:
        return self.status is Status.CONVERGED
