"""Equilibrium of a block under a rod: Newton's method on nodes near the rod, static condensation of the rest.

Stick and slip, folds and snaps along the shaft occur within a few millimetres of the rod, in a quarter of the
nodes. The other nodes respond almost linearly. Their tangent is condensed once for several load steps (a
Schur complement on the nodes of the interface). Newton's method then solves for the near nodes with this
complement as a spring, at a quarter of the cost of an iteration on the whole block. The far nodes are updated
after it, and their remaining nonlinear residual is reduced in the next round. Convergence is judged by the
true residual of the whole block. (Nonlinear elimination: Cai and Li, SIAM J. Sci. Comput. 33, 2011; here the
eliminated part is the smooth one.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.linear.blocks import FullMatrix, pattern_of
from tisim.linear.direct import Condensation, LinearSolveError
from tisim.linear.krylov import FactorGMRES
from tisim.nonlinear.contact_newton import contact_newton, settled
from tisim.nonlinear.newton import CRUSHED, Outcome
from tisim.problems.indentation.far_field import Drag, FarField, Forces, Part
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

# Near nodes are within REACH of the rod's surface, now or after a motion by RENEW along its axis. After that
# motion they are selected again (in radii of the rod).
REACH, RENEW = 0.8, 1.8
ASIDE = 0.3  # motion across the rod's axis after which they are selected again, for a rod that turns
# Largest number of near iterations per round: in a snap the far nodes have to follow, and a trust region that
# has become small starts again (5, 6 and 20 take longer: benchmarks/README.md).
INNER = 8
# If a round leaves more than SLOW times the residual, the far tangent is renewed, at the cost of three near
# iterations. ROUNDS is the largest number of rounds.
SLOW, ROUNDS = 0.7, 12
# Number of step lengths tried, each half of the last, if elements invert.
SHORTER = 4
# The tolerance of the near residual is REDUCTION times the whole residual, or GOAL times the tolerance of the
# whole. With smaller ones the near part is solved more accurately than the far part warrants (studies/depth,
# "A fifth less").
REDUCTION, GOAL = 0.2, 0.8


@dataclass(frozen=True, eq=False)
class _Split:
    """Near and far part of a block.

    Attributes
    ----------
    inside : True for elements of the near part, shape (m,).
    near : the near part.
    body : the far part.
    beyond : True for rows of the far part that are not on the interface, shape (n_far,).
    condensation : condensation of the far part on the interface.
    far : condensed far part.
    """

    inside: Bools
    near: Part
    body: DiscretisedBody
    beyond: Bools
    condensation: Condensation
    far: FarField

    def together(self, x: Array, near: Forces) -> Forces:
        """Forces of the whole block at x, those of its near part being `near`."""
        far = Forces(*self.body.forces_and_energy(x))
        dead = float(np.vdot(self.body.dead_load, x - self.body.discretisation.mesh.nodes))
        return Forces(
            near.force + far.force,
            near.energy + far.energy + dead,  # each part has the potential of the whole dead load
            min(near.min_jacobian, far.min_jacobian),
        )


class CondensedBlock:
    """Solver of a `PokeSystem` at its present depth.

    Attributes
    ----------
    iterations : number of Newton iterations on the near nodes.
    factorisations : number of factorisations of near tangents and of condensations.
    linear_iterations : number of GMRES iterations.
    rounds : number of rounds of near iterations and far update.
    condensations : number of condensations of the far tangent.
    last_residual : relative residual of the last accepted step; set by the caller.
    """

    def __init__(self, system: PokeSystem) -> None:
        self._system = system
        self._radius = system.scene.rod.radius
        self._split: _Split | None = None
        self._chosen: Array | None = None
        self._stale = True
        self.iterations = self.factorisations = self.linear_iterations = 0
        self.rounds = self.condensations = 0
        self.last_residual = 0.0

    def solve(
        self,
        x: Array,
        *,
        tolerance: float,
        max_iterations: int,
        kept: bool,
        drag: float = 0.0,
        dragged_from: Array | None = None,
    ) -> Outcome:
        """Equilibrium from x (n, 3) [m].

        Parameters
        ----------
        x, tolerance, max_iterations, kept
            As in `contact_newton`.
        drag : float
            Resistance of each near node to motion away from `dragged_from` [N/m] (`Drag`).
        dragged_from : ndarray of float, shape (n, 3), optional
            Positions [m]; by default x.
        """
        system = self._system
        if self._chosen is None or self._beyond(self._chosen):
            self._choose(x)
        split = self._split
        moving = system.discretisation if split is None else split.near.body.discretisation
        start = x if dragged_from is None else dragged_from
        system.drag = Drag(start, _of_free(drag, moving)) if drag else None
        if split is None:
            outcome = contact_newton(system, x, tolerance=tolerance, max_iterations=max_iterations, kept=kept)
            self._count(system.linear, outcome.iterations)
            return outcome
        weights = system.discretisation.reference.weights
        split.near.body.discretisation.reference.weights[:] = weights[split.inside]
        split.body.discretisation.reference.weights[:] = weights[~split.inside]
        split.near.body.follow(system.body, split.inside)
        split.body.follow(system.body, ~split.inside)
        part = system.restricted(split.near, split.far)
        near = Forces(*split.near.body.forces_and_energy(x))
        previous, used = np.inf, 0
        rounds = 0
        while True:
            residual, load = system.residual(x)
            relative = float(np.linalg.norm(residual)) / load
            if not np.isfinite(relative):
                return Outcome(x, Status.NOT_CONVERGED, np.inf, used)
            if settled(system, residual, load, tolerance=tolerance, kept=kept):
                return Outcome(x, Status.CONVERGED, relative, used)
            if used >= max_iterations or rounds == ROUNDS:
                return Outcome(x, Status.NOT_CONVERGED, relative, used)
            if rounds > 1 and relative > SLOW * previous:
                self._stale = True
            try:
                left = self._place(split, x, near)
            except LinearSolveError:
                return Outcome(x, Status.SINGULAR, relative, used)
            part.forces.know(x, near)
            enough = REDUCTION * relative
            goal = enough if relative <= tolerance else max(GOAL * tolerance, enough)
            outcome = contact_newton(
                part, x, tolerance=goal, max_iterations=min(INNER, max_iterations - used), kept=False
            )
            used += outcome.iterations
            self._count(split.near.linear, outcome.iterations)
            if outcome.status is Status.CONVERGED:
                rounds, previous = rounds + 1, relative
            elif outcome.status is Status.NOT_CONVERGED and outcome.iterations == INNER:
                rounds = 0
            else:
                return Outcome(x, outcome.status, relative, used)
            moved, near = self._follow(split, x, outcome.x, left), part.forces.of_elements(outcome.x)
            system.forces.know(moved, split.together(moved, near))
            found, share = self._sound(x, moved)
            if found is None:
                return Outcome(x, Status.INVERTED, relative, used)
            self._stale = share < 1.0  # the step is too large for the linearised far tissue
            if self._stale:
                near = Forces(*split.near.body.forces_and_energy(found))
            x = found
            self.rounds += 1

    def renew(self) -> None:
        """Renew the far tangent at the next state, which may be far from the state of the last one."""
        self._stale = True

    def _count(self, linear: FactorGMRES, iterations: int) -> None:
        self.iterations += iterations
        self.factorisations += linear.factorisations
        self.linear_iterations += linear.iterations
        linear.factorisations = linear.iterations = 0

    def _place(self, split: _Split, x: Array, near: Forces) -> Array:
        """Place the far field at x, the near part's forces there being `near`.

        Returns the residual forces on the far rows, eliminated (`Condensation.eliminate`).
        """
        discretisation = split.body.discretisation
        if self._stale:
            blocks, _, _ = split.body.stiffness(x)
            discretisation.hold(blocks)
            split.far.set_stiffness(split.condensation.factorise(blocks))
            self.condensations += 1
            self.factorisations += 1
            self._stale = False
        force = self._system.internal - near.force
        left = split.condensation.eliminate(split.body.out_of_balance(force))
        passed_on = split.condensation.passed_on(left).reshape(-1, 3)
        split.far.place(x, force[split.far.nodes] - passed_on)
        return left

    def _follow(self, split: _Split, x: Array, moved: Array, left: Array) -> Array:
        """Copy of `moved` (n, 3) with the far nodes in linear equilibrium with the moved interface."""
        at = split.far.nodes
        change = split.condensation.expand(-left, (moved[at] - x[at]).ravel())
        found = moved.copy()
        found[split.body.discretisation.pattern.free[split.beyond]] += change[split.beyond]
        return found

    def _sound(self, x: Array, moved: Array) -> tuple[Array | None, float]:
        """First step from x towards `moved` without inverted elements, and its fraction; None, 0 if none."""
        part = 1.0
        for _ in range(SHORTER):
            trial = moved if part == 1.0 else x + part * (moved - x)
            if self._system.potential(trial)[1] > CRUSHED:
                return trial, part
            part *= 0.5
        return None, 0.0

    def _choose(self, x: Array) -> None:
        """Split the block at x into near and far part; no split if one of them would have no own nodes."""
        system, whole = self._system, self._system.discretisation
        mesh = whole.mesh
        self._chosen, self._split, self._stale = system.tip, None, True
        free = np.zeros(mesh.n_nodes, dtype=bool)
        free[whole.pattern.free] = True
        close = free & (self._distance(x) < REACH * self._radius)
        inside: Bools = np.any(close[mesh.elements], axis=1, keepdims=True)[:, 0]
        of_near, of_far = (_nodes_of(mesh.elements[e], mesh.n_nodes) & free for e in (inside, ~inside))
        interface = of_near & of_far
        if not interface.any() or not (of_far & ~of_near).any():
            return
        near, body = self._body(inside, of_near), self._body(~inside, of_far)
        pattern = near.discretisation.pattern
        facets = system.facets
        far = FarField(np.flatnonzero(interface).astype(np.int32), pattern)
        linear = FactorGMRES(far.factor_pattern, joined=far.joined)
        part = Part(near, linear, FullMatrix(pattern, facets), pattern.slots(facets))
        p = body.discretisation.pattern
        kept = interface[p.free]
        self._split = _Split(
            inside=inside, near=part, body=body, beyond=~kept,
            condensation=Condensation(p.indptr, p.indices, kept),
            far=far,
        )  # fmt: skip

    def _beyond(self, chosen: Array) -> bool:
        """True if the near part has to be selected again, since the tip has moved far from `chosen` (3,)."""
        way = self._system.tip - chosen
        aside = way - (way @ self._system.axis) * self._system.axis
        far, beside = float(np.linalg.norm(way)), float(np.linalg.norm(aside))
        return far > RENEW * self._radius or beside > ASIDE * self._radius

    def _distance(self, x: Array) -> Array:
        """Distances (n,) [m] from the volume that the rod sweeps up to the next selection; 0 inside it."""
        system = self._system
        from_tip = x - system.tip
        ahead = from_tip @ system.axis
        off = np.linalg.norm(from_tip - ahead[:, None] * system.axis, axis=1)
        beside: Array = np.maximum(off - self._radius, 0.0)
        return np.hypot(beside, np.maximum(ahead - RENEW * self._radius, 0.0))

    def _body(self, elements: Bools, moving: Bools) -> DiscretisedBody:
        """Body of the `elements` (m,), with the `moving` nodes (n,) free and the others fixed."""
        whole = self._system.discretisation
        mesh, reference = whole.mesh, whole.reference
        chosen = np.flatnonzero(elements)
        part = replace(mesh, elements=mesh.elements[chosen], node_sets={}, facet_sets={})
        fixed = np.flatnonzero(~moving).astype(np.int32)
        pattern = pattern_of(part.elements, mesh.n_nodes, fixed)
        discretisation = Discretisation(
            mesh=part,
            fixed=fixed,
            held=whole.held[whole.pattern.index[pattern.free]],
            reference=replace(
                reference,
                gradients=np.ascontiguousarray(reference.gradients[chosen]),
                weights=reference.weights[chosen],
            ),
            pattern=pattern,
            solver=whole.solver,
            _scratch=whole._scratch,
        )
        body = self._system.body
        return DiscretisedBody(
            discretisation,
            self._system.scene.material,
            dead_load=body.dead_load,
            history=np.zeros_like(body.state[chosen]) if body.remembers else None,
        )


def _of_free(value: float, discretisation: Discretisation) -> Array:
    """The value at free nodes, 0 at the others, shape (n,)."""
    found = np.zeros(discretisation.mesh.n_nodes)
    found[discretisation.pattern.free] = value
    return found


def _nodes_of(elements: NDArray[np.int32], n_nodes: int) -> Bools:
    used = np.zeros(n_nodes, dtype=bool)
    used[elements.ravel()] = True
    return used
