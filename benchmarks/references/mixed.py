"""Q2/P-1 mixed finite elements on FElupe: assembly, exact condensation, Newton with adaptive load steps."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import felupe as fe
import numpy as np
import pypardiso
import scipy.sparse as sp

Array = np.ndarray[Any, Any]


class LinearDiscontinuous(fe.Element):
    """1, r, s, t (or 1, r, s in the plane) on each element: the pressure of Q2/P-1."""

    def __init__(self, dim: int = 3) -> None:
        super().__init__()
        self.shape = (dim + 1, dim)
        self.points = np.zeros((dim + 1, dim))
        self.cells = np.arange(dim + 1).reshape(1, -1)
        self.cell_type = "linear-discontinuous"

    def function(self, rst: Array) -> Array:
        """Shape functions at a point of the reference element."""
        return np.array([1.0, *rst])

    def gradient(self, rst: Array) -> Array:
        """Their derivatives."""
        return np.vstack([np.zeros(len(rst)), np.eye(len(rst))])


def mixed_fields(region: Any, axisymmetric: bool = False) -> fe.FieldContainer:
    """Displacement, pressure and volume ratio on a region of biquadratic or triquadratic elements."""
    mesh = region.mesh
    n = mesh.dim + 1
    cells = np.arange(n * mesh.ncells).reshape(-1, n)
    dual = fe.Mesh(np.zeros((cells.size, mesh.dim)), cells, "linear-discontinuous")
    pressure_region = fe.Region(dual, LinearDiscontinuous(mesh.dim), region.quadrature, grad=False)
    kind = fe.FieldAxisymmetric if axisymmetric else fe.Field
    one = np.zeros((cells.size, 1))
    one[::n] = 1.0
    pressure, ratio = fe.Field(pressure_region, dim=1), fe.Field(pressure_region, dim=1, values=one)
    return fe.FieldContainer([kind(region, dim=mesh.dim), pressure, ratio])


class Contact(Protocol):
    """Surface forces in addition to the load."""

    def assemble(self, u: Array, factor: float) -> tuple[Array, sp.csr_matrix]:
        """Residual (minus the force on the nodes) and its tangent at displacements u, load factor."""

    def accept(self, u: Array, factor: float) -> None:
        """Take a converged step into the history."""


class MixedModel:
    """A body with fixed or prescribed degrees of freedom under a load proportional to a factor.

    prescribed(factor) gives the values of the `fixed` degrees of freedom [m], load(factor) the nodal
    forces [N] on all displacement degrees of freedom.
    """

    def __init__(
        self,
        field: fe.FieldContainer,
        law: Any,
        fixed: Array,
        load: Callable[[float], Array],
        prescribed: Callable[[float], Array] | None = None,
        tolerance: float = 1e-8,
        contact: Contact | None = None,
    ) -> None:
        self.field, self.solid = field, fe.SolidBody(law, field)
        self.nu, self.np = field[0].values.size, field[1].values.size
        self.fixed, self.load = fixed, load
        self.prescribed = prescribed or (lambda _: np.zeros(len(fixed)))
        self.free = np.setdiff1d(np.arange(self.nu), fixed)
        self.tolerance, self.solves, self.reaction = tolerance, 0, np.zeros(len(fixed))
        self.contact = contact  # its tangent need not be symmetric
        self.solver = pypardiso.PyPardisoSolver(mtype=-2 if contact is None else 11)

    def state(self) -> list[Array]:
        """Copies of the three fields' values."""
        return [f.values.copy() for f in self.field.fields]

    def restore(self, state: Sequence[Array]) -> None:
        """Put a state back."""
        for field, values in zip(self.field.fields, state, strict=True):
            field.values[:] = values

    def _direction(self, K: sp.csr_matrix, r: Array, step: Array) -> list[Array]:
        """Newton update with pressure and volume ratio condensed; `step` is that of the fixed dofs."""
        nu, npr, fixed, free = self.nu, self.np, self.fixed, self.free
        n = self.field[0].region.mesh.dim + 1
        Kup, KJJ, KpJ = K[:nu, nu : nu + npr], K[nu + npr :, nu + npr :], K[nu : nu + npr, nu + npr :]
        ru, rp, rJ = r[:nu], r[nu : nu + npr], r[nu + npr :]
        blocks = -KpJ.tobsr((n, n)).data
        rows = np.arange(npr // n + 1)
        inverse = sp.bsr_matrix((np.linalg.inv(blocks), rows[:-1], rows), shape=(npr, npr)).tocsr()
        D = inverse.T @ KJJ @ inverse
        A = (K[:nu, :nu] + Kup @ D @ Kup.T).tocsr()
        right = -(ru + Kup @ (inverse.T @ (KJJ @ (inverse @ rp) + rJ)))
        du = np.zeros(nu)
        du[fixed] = step
        right = right - A @ du
        A = A[free][:, free]
        A = sp.triu(A, format="csr") if self.contact is None else A.tocsr()
        A.sort_indices()
        self.solver.factorize(A)
        du[free] = self.solver.solve(A, right[free])
        dJ = inverse @ (Kup.T @ du + rp)
        dp = inverse.T @ (KJJ @ dJ + rJ)
        self.solves += 1
        return [du, dp, dJ]

    def newton(self, factor: float, iterations: int = 14) -> bool:
        """Equilibrium at `factor` from the present state; False where Newton does not get there."""
        external, target = self.load(factor), self.prescribed(factor)
        largest = 0.0
        for i in range(iterations):
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                r = self.solid.assemble.vector(self.field).toarray().ravel()
                if not np.isfinite(r).all() or largest > 1e6:
                    return False
                self.reaction = (r[: self.nu] - external)[self.fixed]
                r[: self.nu] -= external
                if self.contact is not None:
                    pushed, stiffness = self.contact.assemble(self.field[0].values, factor)
                    r[: self.nu] += pushed
                step = target - self.field[0].values.ravel()[self.fixed]
                force = max(np.linalg.norm(external), np.linalg.norm(self.reaction), 1e-30)
                residual = np.linalg.norm(r[self.free]) / force
                if i and residual < self.tolerance and largest < 1e-7:
                    return True
                K = self.solid.assemble.matrix(self.field).tocsr()
                if self.contact is not None:
                    stiffness.resize(K.shape)
                    K = K + stiffness
                update = self._direction(K, r, step)
            if not all(np.isfinite(u).all() for u in update):
                return False
            for field, values in zip(self.field.fields, update, strict=True):
                field.values += values.reshape(field.values.shape)
            largest = float(np.abs(update[0]).max()) / float(np.ptp(self.field[0].region.mesh.points))
        return False

    def path(
        self,
        start: float,
        factors: Sequence[float],
        report: Callable[[float], None],
        step: float,
        largest_step: float = np.inf,
    ) -> bool:
        """Through rising `factors` with a secant predictor, first step `step`; halves steps that fail."""
        at, last = start, None
        for target in factors:
            while at < target:
                nxt = min(at + step, target)
                if target - nxt < 0.3 * step:
                    nxt = target
                here = self.state()
                if last is not None:
                    ratio = (nxt - at) / (at - last[0])
                    self.restore([h + ratio * (h - p) for h, p in zip(here, last[1], strict=True)])
                before = self.solves
                if self.newton(nxt):
                    last, at = (at, here), nxt
                    if self.contact is not None:
                        self.contact.accept(self.field[0].values, nxt)
                    step = min(step * 1.7, largest_step) if self.solves - before < 6 else step
                else:
                    self.restore(here)
                    step = (nxt - at) / 2
                    if step < 1e-3 * target:
                        return False
            report(target)
        return True


def clock() -> float:
    """CPU seconds of this process."""
    return time.process_time()
