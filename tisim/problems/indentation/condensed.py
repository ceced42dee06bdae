"""Equilibrium of a block under a rod: Newton's method next to the rod, the rest condensed.

What makes a poke hard, sticking and slipping, folds, snaps along the shaft, happens within a few millimetres
of the rod, in a quarter of the nodes. The others respond almost linearly. So their tangent is eliminated once
and for several load steps (a Schur complement on the nodes where they meet the near ones), and Newton's
method works on the near nodes with that complement as a spring, at a quarter of an iteration's cost on the
whole block. Then the far nodes follow, and what their nonlinearity leaves is taken up in the next round.
Equilibrium is judged on the whole block, by its true residual. (Nonlinear elimination: Cai and Li, SIAM J.
Sci. Comput. 33, 2011; here the eliminated part is the smooth one.)
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
from tisim.problems.indentation.far_field import FarField
from tisim.problems.indentation.system import Drag, Part, PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

# Near: closer to the rod's surface than this, also when it will have gone on by RENEW; then near nodes are
# chosen anew (in radii of the rod).
REACH, RENEW = 0.8, 1.8
ASIDE = 0.3  # across the rod, of one that turns
# A round ends after so many near iterations: in a snap, far nodes are to come along, and a trust region that
# has grown small is begun anew (5, 6 and 20 take longer: benchmarks/README.md).
INNER = 8
# A round leaves less than SLOW of the residual, or the far tangent is renewed, at the price of three near
# iterations; so many rounds are tried.
SLOW, ROUNDS = 0.7, 12
# So often the way is halved on which elements turn over.
SHORTER = 4
# The near residual goes down to this part of the whole, or of what the whole is to reach. Smaller ones solve
# the near part better than its far neighbours deserve (studies/depth, "A fifth less").
REDUCTION, GOAL = 0.2, 0.8


@dataclass(frozen=True, eq=False)
class _Split:
    """Near and far part of a block.

    inside (m,): elements of the near part. beyond (n_far,): far rows that are no interface.
    """

    inside: Bools
    near: Part
    body: DiscretisedBody
    beyond: Bools
    condensation: Condensation
    far: FarField


class CondensedBlock:
    """Solves a system at the depths it is moved to.

    iterations, factorisations, linear_iterations: Newton's on near nodes, of near tangents and condensations,
    of GMRES. rounds: as above. condensations: of the far tangent. last_residual: of the last accepted step.
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
        self, x: Array, *, tolerance: float, max_iterations: int, kept: bool, drag: float = 0.0
    ) -> Outcome:
        """Equilibrium from x (n, 3) on, as by `contact_newton`, whose tolerance and `kept` these are.

        drag: of each near node against motion away from x [N/m] (`Drag`).
        """
        system = self._system
        if self._chosen is None or self._beyond(self._chosen):
            self._choose(x)
        split = self._split
        moving = system.discretisation if split is None else split.near.body.discretisation
        system.drag = Drag(x, _of_free(drag, moving)) if drag else None
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
                left = self._place(split, x)
            except LinearSolveError:
                return Outcome(x, Status.SINGULAR, relative, used)
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
            found, share = self._sound(x, self._follow(split, x, outcome.x, left))
            if found is None:
                return Outcome(x, Status.INVERTED, relative, used)
            self._stale = share < 1.0  # too far for a linear answer of the far tissue
            x = found
            self.rounds += 1

    def renew(self) -> None:
        """Take the far tangent at the next state: the last one was far from where the block is now."""
        self._stale = True

    def _count(self, linear: FactorGMRES, iterations: int) -> None:
        self.iterations += iterations
        self.factorisations += linear.factorisations
        self.linear_iterations += linear.iterations
        linear.factorisations = linear.iterations = 0

    def _place(self, split: _Split, x: Array) -> Array:
        """Put the far field at x; returns what is left of the forces on far rows (n_far, 3)."""
        discretisation = split.body.discretisation
        if self._stale:
            blocks, _, _ = split.body.stiffness(x)
            discretisation.hold(blocks)
            split.far.set_stiffness(split.condensation.factorise(blocks))
            self.condensations += 1
            self.factorisations += 1
            self._stale = False
        force = self._system.internal - split.near.body.internal_forces(x)[0]
        left: Array = (force - split.body.dead_load)[discretisation.pattern.free]
        left[discretisation.held] = 0.0
        passed_on = split.condensation.reduce(left).reshape(-1, 3)
        split.far.place(x, force[split.far.nodes] - passed_on)
        return left

    def _follow(self, split: _Split, x: Array, moved: Array, left: Array) -> Array:
        """moved (n, 3), of which near nodes and interface are new, with far nodes where they come to rest."""
        at = split.far.nodes
        change = split.condensation.expand(-left, (moved[at] - x[at]).ravel())
        found = moved.copy()
        found[split.body.discretisation.pattern.free[split.beyond]] += change[split.beyond]
        return found

    def _sound(self, x: Array, moved: Array) -> tuple[Array | None, float]:
        """The way from x to moved as far as no element turns over, and which part of it that is."""
        part = 1.0
        for _ in range(SHORTER):
            trial = moved if part == 1.0 else x + part * (moved - x)
            if self._system.potential(trial)[1] > CRUSHED:
                return trial, part
            part *= 0.5
        return None, 0.0

    def _choose(self, x: Array) -> None:
        """Part the block at x; into no parts where all of it, or nothing, is near."""
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
        """True if the tip is so far from where the near part was chosen that it has to be chosen again."""
        way = self._system.tip - chosen
        aside = way - (way @ self._system.axis) * self._system.axis
        far, beside = float(np.linalg.norm(way)), float(np.linalg.norm(aside))
        return far > RENEW * self._radius or beside > ASIDE * self._radius

    def _distance(self, x: Array) -> Array:
        """Distances (n,) [m] from the rod's surface on its way to the next choice, its inside 0."""
        system = self._system
        from_tip = x - system.tip
        ahead = from_tip @ system.axis
        off = np.linalg.norm(from_tip - ahead[:, None] * system.axis, axis=1)
        beside: Array = np.maximum(off - self._radius, 0.0)
        return np.hypot(beside, np.maximum(ahead - RENEW * self._radius, 0.0))

    def _body(self, elements: Bools, moving: Bools) -> DiscretisedBody:
        """Some of the elements (m,), of whose nodes those `moving` (n,) are free."""
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
    """(n,): the value at nodes that move, 0 at the others."""
    found = np.zeros(discretisation.mesh.n_nodes)
    found[discretisation.pattern.free] = value
    return found


def _nodes_of(elements: NDArray[np.int32], n_nodes: int) -> Bools:
    used = np.zeros(n_nodes, dtype=bool)
    used[elements.ravel()] = True
    return used
