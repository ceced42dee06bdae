"""Uniaxial compression of a cylinder between two platens, for a sequence of stretches, on one eighth of it.

The end faces of a bonded cylinder move with the platens. Nodes of its side that would pass through a platen
stick to it from then on. Free platens that compress do not pull: a viscous cylinder that recovers more slowly
than they open loses contact.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tisim.course import Stop
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.mesh import ElementKind, Mesh
from tisim.mesh.compression import press_mesh
from tisim.nonlinear.newton import Outcome, newton
from tisim.parallel.threads import one_thread
from tisim.problems._registry import OnStep, skip
from tisim.problems._stops import stops_of
from tisim.problems.beam.system import BeamSystem
from tisim.result import Cost, Result, Status
from tisim.scene import Press

Array = NDArray[np.float64]

MOST_LANDINGS = 12  # rounds of nodes that come into contact within one step
MOST_ITERATIONS = 15  # with free pressures Newton's method converges quickly or not at all
# Overlap of side and platen that counts as rounding, relative to the height.
TOUCH = 1e-9
# Pull of a free platen that counts as rounding, in units of the shear modulus times the end's area.
PULL = 1e-5
# Step of the logarithm of the stretch. Half of it changes the force by at most 0.03 %, down to a third of the
# height.
LARGEST_STEP = 0.03
SMALLEST_STEP = LARGEST_STEP / 64.0
MOST_PARTS = 64  # largest number of parts of a step in a hold


class SideLandedError(Exception):
    """The side came into contact with the platen in a scene with side "stop"."""


@dataclass(frozen=True, eq=False)
class State:
    """An equilibrium.

    Attributes
    ----------
    stretch : height over rest height.
    x : positions [m], shape (n, 3).
    carried : True for nodes on the platen, shape (n,); none while it is open.
    residual : residual relative to the load.
    time : time [s].
    """

    stretch: float
    x: Array
    carried: NDArray[np.bool_]
    residual: float = 0.0
    time: float = 0.0


@lru_cache(maxsize=8)
def _discretise(
    radius: float, height: float, kind: ElementKind, refinement: float, bonded: bool
) -> Discretisation:
    mesh = press_mesh(radius=radius, height=height, kind=kind, refinement=refinement)
    held = np.zeros((mesh.n_nodes, 3), dtype=bool)
    held[mesh.node_sets["top"]] = True if bonded else (False, False, True)
    return Discretisation.build(mesh, np.zeros(0, dtype=np.int32), held)


class PressSystem(BeamSystem):
    """One eighth of the cylinder, x, y, z >= 0 (`tisim.nonlinear.newton.System`); x contains the held values.

    A node of a bonded cylinder's side that would pass through the platen is held, in all components, at the
    point where its path meets the platen: the side rolls onto the platen and sticks.
    """

    def __init__(self, scene: Press) -> None:
        kind: ElementKind = "tet10" if scene.element == "default" else scene.element
        self.bonded = scene.platens == "bonded"
        shared = _discretise(scene.radius, scene.height, kind, scene.refinement, self.bonded)
        # nodes in contact are held in this scene only; no node is fixed, so rows of held are nodes
        discretisation = replace(shared, held=shared.held.copy())
        super().__init__(DiscretisedBody(discretisation, scene.material), tolerance=scene.solver.tolerance)
        self.scene = scene
        self._at_rest = 1e-6 * self.body.moduli.shear_modulus * scene.radius**2
        self._faces = shared.held
        self._side = discretisation.mesh.node_sets["side"]
        self._top = discretisation.mesh.node_sets["top"]
        self._pushes = not self.bonded and all(stop.value <= 1.0 for stop in stops_of(scene))
        self._iterations = min(MOST_ITERATIONS, scene.solver.max_iterations)

    def rest(self) -> State:
        return State(1.0, self.body.discretisation.mesh.nodes.copy(), self._ends(held=True))

    def _ends(self, *, held: bool) -> NDArray[np.bool_]:
        carried = np.zeros(self.body.discretisation.mesh.n_nodes, dtype=bool)
        carried[self._top] = held
        return carried

    def linearise(self, x: Array) -> tuple[Array, float]:
        residual, rounding = super().linearise(x)
        force, _ = self.body.internal_forces(x)
        # a floor, since there is no reaction at rest
        load = float(np.linalg.norm(force[self.body.discretisation.held])) + self._at_rest
        return residual, max(load, rounding)

    def plane(self, stretch: float) -> float:
        """Height of the upper platen above the middle plane [m]."""
        return 0.5 * self.scene.height * stretch

    def overlap(self, x: Array, stretch: float) -> float:
        """Largest distance of the side beyond the platen [m], at least 0."""
        return max(0.0, float((x[self._side, 2]).max()) - self.plane(stretch))

    def force(self, state: State) -> float:
        """Force of the platen on the body along z [N], negative in compression."""
        internal, _ = self.body.internal_forces(state.x)
        return 4.0 * float(internal[state.carried, 2].sum())  # the mesh has a quarter of the end face

    def equilibrium(
        self, state: State, before: State | None, stretch: float, time: float
    ) -> tuple[State | None, Status]:
        """Equilibrium at `stretch` and a time [s], one step after `state`; or None and the reason.

        Parameters
        ----------
        state, before : State
            The last state, and the one before it (None if there is none) for a secant start value.
        stretch, time : float
            Stretch and time [s] at the end of the step.

        Raises
        ------
        SideLandedError
            If the side comes into contact in a scene with side "stop".
        """
        self.body.begin(time - state.time)
        closed = bool(state.carried.any())
        for touches in (closed, not closed) if self._pushes else (True,):
            if touches:
                found, status = self._pressed(state, before, stretch, time)
            else:
                found, status = self._open(state, stretch, time)
            if found is not None and self._is_contact(found):
                self.body.accept(found.x)
                return found, Status.CONVERGED
        return None, Status.NOT_CONVERGED if status is Status.CONVERGED else status

    def _is_contact(self, state: State) -> bool:
        """True unless a free platen that compresses pulls at the body, or the body passes through it."""
        if not self._pushes:
            return True
        if state.carried.any():
            area = np.pi * self.scene.radius**2
            return self.force(state) <= PULL * self.body.moduli.shear_modulus * area
        return float(state.x[self._top, 2].max()) <= self.plane(state.stretch) + TOUCH * self.scene.height

    def _open(self, state: State, stretch: float, time: float) -> tuple[State | None, Status]:
        """Equilibrium of the body by itself."""
        free = self._ends(held=False)
        outcome = self._solve(state.x.copy(), free, self.body.pressures(state.x))
        if outcome.status is not Status.CONVERGED:
            return None, outcome.status
        return State(stretch, outcome.x, free, outcome.residual, time), Status.CONVERGED

    def _pressed(
        self, state: State, before: State | None, stretch: float, time: float
    ) -> tuple[State | None, Status]:
        """Equilibrium of the body on the platen."""
        status = Status.NOT_CONVERGED
        start = state if state.carried.any() else replace(state, carried=self._ends(held=True))
        for guess in self._guesses(start, before, stretch):
            carried = start.carried
            outcome = self._solve(guess, carried, self.body.pressures(state.x))
            for _ in range(MOST_LANDINGS):
                if outcome.status is not Status.CONVERGED:
                    break
                landed = self._landed(outcome.x, carried, stretch)
                if not len(landed):
                    return State(stretch, outcome.x, carried, outcome.residual, time), Status.CONVERGED
                if self.scene.side == "stop":
                    raise SideLandedError
                x = self._put_down(state, outcome.x, landed, stretch)
                carried = carried.copy()
                carried[landed] = True
                outcome = self._solve(x, carried, self.body.pressures(outcome.x))
            status = Status.NOT_CONVERGED if outcome.status is Status.CONVERGED else outcome.status
        return None, status

    def _guesses(self, state: State, before: State | None, stretch: float) -> list[Array]:
        """Start values: the last two states extrapolated, then the last one scaled; held nodes in place."""
        ratio = self.plane(stretch) / float(state.x[self._top, 2].max())
        scaled = state.x.copy()
        scaled[:, 2] *= ratio
        if not self.bonded:
            scaled[:, :2] *= ratio**-0.5
        guesses = [scaled]
        closed = before is not None and before.carried.any()
        if before is not None and closed and stretch != state.stretch != before.stretch:
            part = (stretch - state.stretch) / (state.stretch - before.stretch)
            guesses.insert(0, state.x + part * (state.x - before.x))
        for guess in guesses:
            if self.bonded:
                guess[state.carried, :2] = state.x[state.carried, :2]
            guess[state.carried, 2] = self.plane(stretch)
        return guesses

    def _solve(self, x: Array, carried: NDArray[np.bool_], pressure: Array) -> Outcome:
        """Newton with the element pressures as unknowns, the carried nodes held."""
        held = self.body.discretisation.held
        held[:] = self._faces
        if self.bonded:
            held[carried] = True
        elif not carried.any():
            held[self._top, 2] = False
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
        """Copy of x with the landed nodes where their straight paths from `state` meet the moving platen."""
        gap = self.plane(state.stretch) - state.x[landed, 2]
        now = self.plane(stretch) - x[landed, 2]
        part = np.clip(gap / (gap - now), 0.0, 1.0)[:, None]
        x = x.copy()
        x[landed, :2] = state.x[landed, :2] + part * (x[landed, :2] - state.x[landed, :2])
        x[landed, 2] = self.plane(stretch)
        return x


@one_thread()
def solve_press(scene: Press, *, on_step: OnStep = skip) -> Result:
    """Solve a compression test: one frame per stretch, or the frames of the course, until none converges.

    The middle plane stays at z = 0, the upper platen is at stretch * height / 2. The result's nominal_stress
    is the force of the platen on the body over the rest area, negative in compression, including the force
    on the part of the side in contact. Its support_force is that of the lower platen, its penetration the
    overlap of side and platen.
    """
    start = time.process_time()
    system = PressSystem(scene)
    mesh_seconds = time.process_time() - start
    here, before = system.rest(), None
    frames: list[_Frame] = []
    status, message, counts = Status.CONVERGED, "", _Counts()
    try:
        stops = stops_of(scene)
        for count, stop in enumerate(stops, start=1):
            here, before, status = _advance(system, here, before, stop, counts)
            if status is not Status.CONVERGED:
                message = f"no equilibrium beyond stretch {here.stretch:.4g} ({status.value})"
                break
            if stop.frame:
                frames.append(_frame(system, here))
            on_step(count / len(stops))
    except SideLandedError:
        status = Status.PENETRATION
        message = f"the side comes down on the platen beyond stretch {counts.reached:.4g}, and side is 'stop'"
    cost = Cost(
        core_seconds=time.process_time() - start - mesh_seconds,
        mesh_seconds=mesh_seconds,
        steps=counts.steps,
        newton_iterations=system.counts["newton"],
        factorisations=system.counts["factorisations"],
        step_cuts=counts.cuts,
    )
    return _result(scene, system.body.discretisation.mesh, frames, status, message, cost)


@dataclass
class _Counts:
    """Numbers of steps tried and of cuts, and the last stretch with an equilibrium."""

    steps: int = 0
    cuts: int = 0
    reached: float = 1.0


def _advance(
    system: PressSystem, here: State, before: State | None, stop: Stop, counts: _Counts
) -> tuple[State, State | None, Status]:
    """Advance from `here` to a stop in equal steps of the logarithm of the stretch, halved if they fail."""
    size, status, target = LARGEST_STEP, Status.CONVERGED, stop.value
    shorter = 1  # a hold is cut in time
    while here.stretch != target or here.time < stop.time:
        left = float(np.log(target / here.stretch))
        count = max(shorter, int(np.ceil(abs(left) / size - 1e-9)))
        stretch = target if count == 1 else here.stretch * float(np.exp(left / count))
        time = stop.time
        if count > 1:  # the stretch is linear in time
            part = (stretch - here.stretch) / (target - here.stretch) if left else 1.0 / count
            time = here.time + part * (stop.time - here.time)
        counts.steps += 1
        found, status = system.equilibrium(here, before, stretch, time)
        if found is None:
            counts.cuts += 1
            if left:
                size = 0.5 * min(size, abs(left))
            else:
                shorter *= 2
            if size < SMALLEST_STEP or shorter > MOST_PARTS:
                system.body.begin(0.0)
                return here, before, status
            continue
        before, here = here, found
        counts.reached = stretch
        size = min(2.0 * size, LARGEST_STEP)
        shorter = max(1, shorter - 1)
    return here, before, status


@dataclass(frozen=True, eq=False)
class _Frame:
    state: State
    force: float  # of the upper platen on the body along z [N]
    overlap: float
    min_jacobian: float
    dissipated: float


def _frame(system: PressSystem, state: State) -> _Frame:
    _, min_jacobian = system.body.internal_forces(state.x)
    overlap, lost = system.overlap(state.x, state.stretch), system.body.dissipated()
    return _Frame(state, system.force(state), overlap, min_jacobian, lost)


def _result(
    scene: Press, mesh: Mesh, frames: list[_Frame], status: Status, message: str, cost: Cost
) -> Result:
    n = len(frames)
    support = np.zeros((n, 3))
    support[:, 2] = [-f.force for f in frames]
    return Result(
        scene=scene,
        status=status,
        message=message,
        mesh=mesh,
        load=np.array([f.state.stretch for f in frames]),
        positions=np.array([f.state.x for f in frames]).reshape(n, mesh.n_nodes, 3),
        support_force=support,
        penetration=np.array([f.overlap for f in frames]),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.state.residual for f in frames]),
        nominal_stress=np.array([f.force for f in frames]) / (np.pi * scene.radius**2),
        time=None if scene.course is None else np.array([f.state.time for f in frames]),
        dissipated=np.array([f.dissipated for f in frames]) if scene.material.remembers else None,
        cost=cost,
    )
