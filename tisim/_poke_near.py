"""The tissue next to the rod brought to equilibrium by itself, between Newton's steps on the whole block.

What makes a step of a poke hard, sticking and slipping, folds under the rod's edge, happens within a few
millimetres of the tip, in a seventh of the nodes. Newton's method on the whole block pays for all nodes in
each of the many iterations that this takes. So after each of its steps the near nodes are relaxed with the
others held, at a tenth of the cost an iteration (nonlinear elimination: Cai and Li, SIAM J. Sci. Comput. 33,
2011), and what is left for the whole block is smooth. Equilibrium is judged on the whole block alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim import _pattern
from tisim._body import Body, Layout
from tisim._krylov import FactorGMRES
from tisim._poke_newton import contact_newton
from tisim._poke_system import PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]

# Near: closer to the tip than this; chosen anew when the tip has moved on so far (in radii of the rod).
REACH, RENEW = 1.6, 0.4
ITERATIONS = 8
# The near residual goes down to this part of what it was, or of what the whole block is to reach.
REDUCTION, GOAL = 0.03, 0.3
# The part of the residual that must be near for the near nodes to be relaxed at all.
WORTHWHILE = 0.3
# What a shift of the whole block's tangent (`FactorGMRES`) is far from the rod: it is to hold back the near
# nodes, not the slow bending of the block.
FAR_WEIGHT = 0.01


class NearField:
    """The near part of a poke's system; `relax` is what `contact_newton` takes.

    iterations: Newton's, on near nodes. factorisations: of near tangents.
    """

    def __init__(self, system: PokeSystem) -> None:
        self._system = system
        self._goal = GOAL * system.scene.solver.tolerance
        self._radius = system.scene.rod.radius
        self._centre: Array | None = None
        self._rest = 0
        self.iterations = self.factorisations = 0

    def begin(self) -> None:
        """A new load step: after one that failed, the near field rests for a step."""
        self._rest = max(self._rest - 1, 0)

    def relax(self, x: Array) -> Array:
        """x (n, 3) with the near nodes at rest among the others, or as it was where that fails."""
        system = self._system
        if self._centre is None or np.linalg.norm(self._centre - system.tip) > RENEW * self._radius:
            self._choose(x)
        if self._rest > 0 or self._body is None:
            return x
        self._weights[:] = system.layout.reference.weights[self._elements]
        part = system.restricted(self._body, self._linear, self._slot)
        residual, load = part.residual(x)
        near, whole = float(np.linalg.norm(residual)), system.residual_norm(x)
        if near < max(WORTHWHILE * whole, 2.0 * self._goal * load):
            return x
        goal = max(self._goal, REDUCTION * near / load)
        outcome = contact_newton(part, x, tolerance=goal, max_iterations=ITERATIONS, kept=False)
        self.iterations += outcome.iterations
        self.factorisations += self._linear.factorisations
        self._linear.factorisations = 0
        if outcome.status is Status.CONVERGED:
            return outcome.x
        self._rest = 2
        return outcome.x if outcome.residual < near / load else x

    def _choose(self, x: Array) -> None:
        system, whole = self._system, self._system.layout
        mesh, free = whole.mesh, whole.pattern.free
        self._centre = system.tip
        close = np.linalg.norm(x[free] - system.tip, axis=1) < REACH * self._radius
        system.linear.weights[:, 0] = np.where(close, 1.0, FAR_WEIGHT)
        near = np.zeros(mesh.n_nodes, dtype=bool)
        near[free] = close
        self._body: Body | None = None
        if not close.any():
            return
        self._elements = np.flatnonzero(near[mesh.elements].any(axis=1))
        fixed = np.flatnonzero(~near).astype(np.int32)
        part = replace(mesh, elements=mesh.elements[self._elements], node_sets={}, facet_sets={})
        pattern = _pattern.build(part.elements, mesh.n_nodes, fixed)
        reference = whole.reference
        self._weights = reference.weights[self._elements]
        layout = Layout(
            mesh=part,
            fixed=fixed,
            held=whole.held[whole.pattern.index[pattern.free]],
            reference=replace(
                reference,
                gradients=np.ascontiguousarray(reference.gradients[self._elements]),
                weights=self._weights,
            ),
            pattern=pattern,
            solver=whole.solver,
            _scratch=whole._scratch,
        )
        self._body = Body(layout, system.scene.material, dead_load=system.body.dead_load)
        self._linear = FactorGMRES(pattern)
        self._slot = pattern.slots(system.facets)
