"""A cylinder between platens at one stretch: held nodes, and the side that comes down on the platen."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tisim._beam_system import BeamSystem
from tisim._body import Body, Layout
from tisim._newton import Outcome, newton
from tisim.mesh import ElementKind
from tisim.mesh.press import press_mesh
from tisim.result import Status
from tisim.scene import Press

Array = NDArray[np.float64]

MOST_LANDINGS = 12  # rounds of nodes coming down within one step
MOST_ITERATIONS = 15  # with free pressures Newton is quick or gets nowhere
# Overlap of side and platen that counts as none, in parts of the height: rounding.
TOUCH = 1e-9


class SideLandedError(Exception):
    """The side came down on the platen, and the scene says to stop there."""


@dataclass(frozen=True, eq=False)
class State:
    """An equilibrium: stretch, positions (n, 3) [m], nodes that move with the platen (n,), residual."""

    stretch: float
    x: Array
    carried: NDArray[np.bool_]
    residual: float = 0.0


@lru_cache(maxsize=8)
def _layout(radius: float, height: float, kind: ElementKind, refinement: float, bonded: bool) -> Layout:
    mesh = press_mesh(radius=radius, height=height, kind=kind, refinement=refinement)
    held = np.zeros((mesh.n_nodes, 3), dtype=bool)
    held[mesh.node_sets["top"]] = True if bonded else (False, False, True)
    return Layout.build(mesh, np.zeros(0, dtype=np.int32), held)


class PressSystem(BeamSystem):
    """The upper quarter of the cylinder, its held components standing in x already (`tisim._newton.System`).

    What a bonded cylinder's side does on the platen: a node that would pass through it is held where its
    path met it, all components, from then on (the side rolls onto the platen and sticks).
    """

    def __init__(self, scene: Press) -> None:
        kind: ElementKind = "tet10" if scene.element == "default" else scene.element
        self.bonded = scene.platens == "bonded"
        shared = _layout(scene.radius, scene.height, kind, scene.refinement, self.bonded)
        # nodes that land are held in this scene only; no node is fixed, so held is by node
        layout = replace(shared, held=shared.held.copy())
        super().__init__(Body(layout, scene.material), tolerance=scene.solver.tolerance)
        self.scene = scene
        self._at_rest = 1e-6 * self.body.moduli.shear * scene.radius**2
        self._faces = shared.held
        self._side = layout.mesh.node_sets["side"]
        self._iterations = min(MOST_ITERATIONS, scene.solver.max_iterations)

    def rest(self) -> State:
        carried = np.zeros(self.body.layout.mesh.n_nodes, dtype=bool)
        carried[self.body.layout.mesh.node_sets["top"]] = True
        return State(1.0, self.body.layout.mesh.nodes.copy(), carried)

    def linearise(self, x: Array) -> tuple[Array, float]:
        residual, _ = super().linearise(x)
        force, _ = self.body.internal_forces(x)
        # at rest there is no reaction to compare with
        return residual, float(np.linalg.norm(force[self.body.layout.held])) + self._at_rest

    def plane(self, stretch: float) -> float:
        """Height of the upper platen over the middle [m]."""
        return 0.5 * self.scene.height * stretch

    def overlap(self, x: Array, stretch: float) -> float:
        """How far the side reaches beyond the platen [m], 0 where it does not."""
        return max(0.0, float((x[self._side, 2]).max()) - self.plane(stretch))

    def equilibrium(self, state: State, before: State | None, stretch: float) -> tuple[State | None, Status]:
        """The state at `stretch`, one step on from `state`; None and the reason where there is none.

        before: the state before that, for a secant guess. SideLandedError where the scene stops at it.
        """
        status = Status.NOT_CONVERGED
        for guess in self._guesses(state, before, stretch):
            carried = state.carried
            outcome = self._solve(guess, carried, self.body.pressures(state.x))
            for _ in range(MOST_LANDINGS):
                if outcome.status is not Status.CONVERGED:
                    break
                landed = self._landed(outcome.x, carried, stretch)
                if not len(landed):
                    return State(stretch, outcome.x, carried, outcome.residual), Status.CONVERGED
                if self.scene.side == "stop":
                    raise SideLandedError
                x = self._put_down(state, outcome.x, landed, stretch)
                carried = carried.copy()
                carried[landed] = True
                outcome = self._solve(x, carried, self.body.pressures(outcome.x))
            status = Status.NOT_CONVERGED if outcome.status is Status.CONVERGED else outcome.status
        return None, status

    def _guesses(self, state: State, before: State | None, stretch: float) -> list[Array]:
        """Where the last two states point to, then the last one scaled; held nodes in their places."""
        ratio = stretch / state.stretch
        scaled = state.x.copy()
        scaled[:, 2] *= ratio
        if not self.bonded:
            scaled[:, :2] *= ratio**-0.5
        guesses = [scaled]
        if before is not None:
            part = (stretch - state.stretch) / (state.stretch - before.stretch)
            guesses.insert(0, state.x + part * (state.x - before.x))
        for guess in guesses:
            if self.bonded:
                guess[state.carried, :2] = state.x[state.carried, :2]
            guess[state.carried, 2] = self.plane(stretch)
        return guesses

    def _solve(self, x: Array, carried: NDArray[np.bool_], pressure: Array) -> Outcome:
        """Newton with the element pressures as unknowns, the carried nodes held."""
        held = self.body.layout.held
        held[:] = self._faces
        if self.bonded:
            held[carried] = True
        if self.potential(x)[1] <= 0.0:
            return Outcome(x, Status.INVERTED, np.inf, 0)
        self.free_pressures(pressure)
        try:
            return newton(self, x, tolerance=self.tolerance, max_iterations=self._iterations)
        finally:
            self.free_pressures(None)

    def _landed(self, x: Array, carried: NDArray[np.bool_], stretch: float) -> NDArray[np.int32]:
        beyond = x[self._side, 2] - self.plane(stretch) > TOUCH * self.scene.height
        return self._side[beyond & ~carried[self._side]] if self.bonded else self._side[:0]

    def _put_down(self, state: State, x: Array, landed: NDArray[np.int32], stretch: float) -> Array:
        """x with the landed nodes where their straight paths from `state` met the moving platen."""
        gap = self.plane(state.stretch) - state.x[landed, 2]
        now = self.plane(stretch) - x[landed, 2]
        part = np.clip(gap / (gap - now), 0.0, 1.0)[:, None]
        x = x.copy()
        x[landed, :2] = state.x[landed, :2] + part * (x[landed, :2] - state.x[landed, :2])
        x[landed, 2] = self.plane(stretch)
        return x
