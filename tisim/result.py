"""Results of simulations: frames, status and cost."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim.mesh import Mesh


class Status(StrEnum):
    """Outcome of a simulation. All frames of a static solution are equilibria, whatever the status."""

    CONVERGED = "converged"  # the whole load, depth or duration was reached
    NOT_CONVERGED = "not-converged"  # Newton's method failed after all step cuts
    INVERTED = "inverted-element"  # the next step would invert an element
    PENETRATION = "penetration"  # the rod would penetrate too far, or a cylinder's side touched a platen
    SINGULAR = "singular"  # the linear solver failed
    DIVERGED = "diverged"  # a dynamic run lost its energy balance or became non-finite
    UNFINISHED = "unfinished"  # a run with until_rest reached its duration before rest
    NOT_MESHED = "not-meshed"  # no mesh fits the body: the result has an empty mesh and no frames


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Cost of a simulation.

    Attributes
    ----------
    core_seconds, mesh_seconds : float
        CPU time of the solution and of the mesh generation [s].
    steps, newton_iterations, factorisations, linear_iterations, step_cuts : int
        Counts. For a poke, iterations are those of the tissue near the rod, factorisations those of the near
        and the far tissue.
    """

    core_seconds: float = 0.0
    mesh_seconds: float = 0.0
    steps: int = 0
    newton_iterations: int = 0
    factorisations: int = 0
    linear_iterations: int = 0
    step_cuts: int = 0


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Result:
    """Solution of one scene: f frames on a mesh of n nodes. Quantities that do not apply are None.

    Attributes
    ----------
    scene : Scene
    status : Status
    message : str
        One sentence if the status is not CONVERGED, else empty.
    mesh : Mesh
        Rest mesh of the solution; for a beam with imperfections that of the ideal prism (see
        `tisim.rest_positions`).
    load : ndarray, shape (f,)
        Load parameter of the frames: fraction of the load of a static beam (1.0 = all), time of a dynamic
        beam [s], depth of a poke [m], stretch of a homogeneous or a compression test.
    time : ndarray, shape (f,), or None
        Time of the frames [s]; scenes with a course and dynamic scenes.
    dissipated : ndarray, shape (f,), or None
        Energy dissipated so far by the material of the whole body, without the solver's damping [J];
        materials with viscosity or softening.
    positions : ndarray, shape (f, n, 3)
        Node positions [m].
    support_force : ndarray, shape (f, 3)
        Force of the supports on the whole body [N].
    rod_force : ndarray, shape (f, 3), or None
        Force of the body on the rod [N]; pokes.
    rod_tip : ndarray, shape (f, 3), or None
        Centre of the rod's tip [m]; pokes.
    penetration : ndarray, shape (f,), or None
        Largest overlap of body and rod, or of side and platen [m]; pokes and compression.
    min_jacobian : ndarray, shape (f,)
        Smallest det F at the quadrature points.
    residual : ndarray, shape (f,)
        Residual of the free nodes relative to the applied load; static residual of dynamic scenes.
    nominal_stress : ndarray, shape (f,), or None
        Force over rest area in the loaded direction [Pa]; homogeneous tests and compression.
    cost : Cost
    """

    scene: Any
    status: Status
    message: str = ""
    mesh: Mesh
    load: NDArray[np.float64]
    positions: NDArray[np.float64]
    support_force: NDArray[np.float64]
    rod_force: NDArray[np.float64] | None = None
    rod_tip: NDArray[np.float64] | None = None
    penetration: NDArray[np.float64] | None = None
    min_jacobian: NDArray[np.float64]
    residual: NDArray[np.float64]
    nominal_stress: NDArray[np.float64] | None = None
    time: NDArray[np.float64] | None = None
    dissipated: NDArray[np.float64] | None = None
    cost: Cost = field(default_factory=Cost)

    @property
    def ok(self) -> bool:
        """True if the whole load, depth or duration was reached."""
        return self.status is Status.CONVERGED

    @property
    def rest_positions(self) -> NDArray[np.float64]:
        """Stress-free node positions [m], shape (n, 3).

        They are the mesh's nodes, except for a beam with imperfections: its mesh is that of the ideal prism.
        """
        if self.scene is None:
            return self.mesh.nodes
        from tisim.problems._registry import kind_of

        return kind_of(self.scene).rest(self)

    def __repr__(self) -> str:
        rows = ", ".join(f"{name} {value}" for name, value in self._summary())
        return f"<Result of a {type(self.scene).__name__}: {rows}>"

    def _repr_html_(self) -> str:
        """Summary table for notebooks."""
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(value)}</td></tr>"
            for name, value in self._summary()
        )
        return f"<table><caption>Result of a {type(self.scene).__name__}</caption>{rows}</table>"

    def _summary(self) -> list[tuple[str, str]]:
        frames = len(self.load)
        rows = [("status", str(self.status))]
        if self.message:
            rows.append(("message", self.message))
        rows.append(("mesh", f"{self.mesh.n_nodes} nodes, {self.mesh.n_elements} {self.mesh.kind}"))
        rows.append(("frames", f"{frames}, load to {self.load[-1]:.4g}" if frames else "none"))
        if frames:
            moved = np.linalg.norm(self.positions[-1] - self.rest_positions, axis=1).max()
            if self.time is not None:
                rows.append(("time", f"to {self.time[-1]:.4g} s"))
            rows.append(("largest displacement", f"{moved * 1e3:.4g} mm"))
            if self.rod_force is not None:
                rows.append(("force on the rod", f"{np.linalg.norm(self.rod_force[-1]):.4g} N"))
            else:
                rows.append(("support force", f"{np.linalg.norm(self.support_force[-1]):.4g} N"))
            if self.nominal_stress is not None:
                rows.append(("nominal stress", f"{self.nominal_stress[-1]:.4g} Pa"))
            if self.dissipated is not None:
                rows.append(("dissipated", f"{self.dissipated[-1]:.4g} J"))
        rows.append(("core seconds", f"{self.cost.core_seconds:.3g}"))
        return rows


def frame_index(result: Result, frame: int) -> int:
    """Index of a frame counted from the start; ValueError if the result does not have the frame."""
    count = len(result.positions)
    if not count:
        why = f": {result.message}" if result.message else ""
        raise ValueError(f"the result has no frame{why}")
    if not -count <= frame < count:
        raise ValueError(f"frame {frame}: expected one from {-count} to {count - 1}")
    return frame % count
