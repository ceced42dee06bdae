"""Equilibrium inside a stored surface: the positions of all nodes where the surface is prescribed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim import Material
from tisim.mesh import Mesh

Array = NDArray[np.float64]
Ints = NDArray[np.integer[Any]]

_ITERATIONS, _HALVINGS = 40, 5
_PARTS = tuple(0.5**k for k in range(7))  # of a Newton step: the first one that brings it nearer is taken
_SAME = 1e-6  # m: positions that differ by less are one equilibrium
_SLOW = 0.3  # what an iteration leaves of the forces, above which the tangent is factorised anew


class NoInteriorError(Exception):
    """No equilibrium was found inside the stored surface of a frame."""


class Interior:
    """Positions of all nodes, frame by frame: the surface as stored, the interior in equilibrium."""

    def __init__(
        self,
        mesh: Mesh,
        material: Material,
        surface: Ints,
        moved: Array,
        tolerance: Array,
        *,
        balanced: Callable[[int, Array], bool],
    ) -> None:
        """Take displacements `moved` (frames, k, 3) [m] of the nodes `surface`, `tolerance` (frames,) [N].

        Crushed tissue may have several equilibria inside one surface. While `balanced(frame, positions)` is
        false, another one is sought in shorter steps from the frame before; the last one counts.
        """
        from tisim.discretisation.body import Discretisation, DiscretisedBody

        self._mesh, self._surface, self._moved, self._tolerance = mesh, surface, moved, tolerance
        self._discretisation = Discretisation.build(mesh, surface.astype(np.int32))
        self._body = DiscretisedBody(self._discretisation, material)
        self._free = self._discretisation.pattern.free
        self._balanced = balanced

    def __iter__(self) -> Iterator[Array]:
        x, before = self._mesh.nodes.copy(), np.zeros_like(self._moved[0])
        for frame, moved in enumerate(self._moved):
            x = self._to(frame, x, before, moved)
            before = moved
            yield x

    def _to(self, frame: int, x: Array, before: Array, moved: Array) -> Array:
        """Positions for the next surface, reached in one step or, if these are not balanced, in 2, 4, ..."""
        reached: Array | None = None
        for halving in range(_HALVINGS):
            parts = 2**halving
            at = x
            for part in range(1, parts + 1):
                aim = before + (part / parts) * (moved - before)
                last = part == parts
                found = self._step(at, aim, self._tolerance[frame] * (1.0 if last else 10.0))
                if found is None:
                    break
                at = found
            else:
                again = reached is not None and float(np.abs(at - reached).max()) < _SAME
                reached = at
                if self._balanced(frame, at) or again:
                    return at
        if reached is None:
            raise NoInteriorError
        return reached

    def _step(self, x: Array, aim: Array, tolerance: float) -> Array | None:
        """Interior equilibrium for the surface displaced by `aim`, from x; None without convergence."""
        from tisim.linear.direct import LinearSolveError

        body, solver, free = self._body, self._discretisation.solver, self._free
        start = np.zeros_like(x)
        start[self._surface] = self._mesh.nodes[self._surface] + aim - x[self._surface]
        small = 1e-6 / max(float(np.abs(start).max()), 1e-12)
        blocks, force, _ = body.stiffness(x)
        try:
            solver.factorise(blocks)
            # K_is du_s by a difference quotient
            change = (body.internal_forces(x + small * start)[0] - force) / small
            start[free] = -solver.solve(change[free] + force[free])
            x = x + start
            force, least = body.internal_forces(x)
            left = float(np.linalg.norm(force[free]))
            if not (least > 0.0 and np.isfinite(left)):
                return None
            exact = False  # the factor is of the tangent at x; modified Newton: kept while it serves
            for _ in range(_ITERATIONS):
                if left <= tolerance:
                    return x
                found = self._nearer(x, solver.solve(force[free]), left)
                if found is None and exact:
                    return None
                slow = found is None
                if found is not None:
                    slow = found[2] > _SLOW * left
                    x, force, left = found
                exact = slow
                if slow:
                    solver.factorise(body.stiffness(x)[0])
        except LinearSolveError:
            return None
        return None

    def _nearer(self, x: Array, step: Array, left: float) -> tuple[Array, Array, float] | None:
        """Positions on the way of a step that turns no element over and leaves less than `left` [N].

        Also the forces there, and what they leave; None if there are none. Where tissue is crushed, a whole
        step turns elements over.
        """
        free = self._free
        for part in _PARTS:
            there = x.copy()
            there[free] -= part * step
            force, least = self._body.internal_forces(there)
            size = float(np.linalg.norm(force[free]))
            if least > 0.0 and size < left:
                return there, force, size
        return None
