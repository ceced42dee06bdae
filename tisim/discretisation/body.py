"""The discretisation of a mesh, shared by all bodies on it, and a body: a material on a discretisation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.discretisation.history import History
from tisim.discretisation.packed import features_of, history_of, pack
from tisim.discretisation.quadrature import Reference, bulk_shares, reference
from tisim.linear.blocks import Pattern, pattern_of
from tisim.linear.direct import DirectSolver
from tisim.material import Material
from tisim.mesh import Mesh

Array = NDArray[np.float64]

# Pointwise bulk modulus by element type, in units of the shear modulus, including the resistance of W itself.
# Without it a tet10 with one pressure is too soft in bending: against benchmarks/references/beams.json (K/mu
# 20 to 1000, mu 9 and 40 kPa) the default beams are within -0.43 and +0.61 % with 0 for Ogden's W, -0.51 and
# +0.16 % with 2/3, -0.70 and +0.03 % with 1. The Neo-Hookean W itself has 2/3.
POINTWISE = {"tet4": np.inf, "tet10": 2.0 / 3.0, "hex8": 2.0, "hex20": 2.0}


NO_STATE = np.zeros((1, 1, 1))


@dataclass(eq=False)
class Discretisation:
    """Data that depend on mesh and supports only: quadrature, numbering, sparsity, symbolic factor.

    Attributes
    ----------
    mesh : the mesh.
    fixed : indices of fixed nodes.
    held : True for components of free nodes that are prescribed (mirror planes, platens), shape (n_free, 3).
    reference : quadrature data of the rest shape.
    pattern : sparsity of the tangent.
    solver : direct solver with the symbolic factor.
    stiffness, density : factors of the material's stiffness and density at the quadrature points, shape
        (m, q); None if all are 1. The energy is linear in the stiffness, so that the kernels take its factors
        as part of their weights (the element's mean volumetric strain becomes the mean weighted by them).
    """

    mesh: Mesh
    fixed: NDArray[np.int32]
    held: NDArray[np.bool_]
    reference: Reference
    pattern: Pattern
    solver: DirectSolver
    _scratch: Array = field(repr=False)
    stiffness: Array | None = None
    density: Array | None = None

    @staticmethod
    def build(mesh: Mesh, fixed: NDArray[np.int32], held: NDArray[np.bool_] | None = None) -> Discretisation:
        held = np.zeros((mesh.n_nodes, 3), dtype=bool) if held is None else held.copy()
        for axis in mesh.symmetry:
            held[mesh.node_sets[f"mirror_{axis}"], "xyz".index(axis)] = True
        pattern = pattern_of(mesh.elements, mesh.n_nodes, fixed)
        integration = reference(mesh)
        return Discretisation(
            mesh=mesh,
            fixed=np.asarray(fixed, dtype=np.int32),
            held=held[pattern.free],
            reference=integration,
            pattern=pattern,
            solver=DirectSolver(pattern.indptr, pattern.indices),
            _scratch=np.zeros((integration.weights.shape[1], 9, 9)),
        )

    @property
    def multiplicity(self) -> float:
        """Number of copies of the mesh that make up the whole body."""
        return 2.0 ** len(self.mesh.symmetry)

    @property
    def still(self) -> NDArray[np.bool_]:
        """True for nodes that no solution moves, shape (n,): fixed ones, and those of no element."""
        found = np.ones(self.mesh.n_nodes, dtype=bool)
        found[self.pattern.free] = False
        return found

    def nodal_volume(self) -> Array:
        """Rest volume by node, the integral of each shape function [m3], shape (n,); sums to the volume.

        Factors of the density, if any, are included: nodal mass = nodal volume times the material's density.
        """
        ref, mesh = self.reference, self.mesh
        weights = ref.weights if self.density is None else ref.weights * self.density
        shares = weights @ ref.values
        volume = np.zeros(mesh.n_nodes)
        np.add.at(volume, mesh.elements.ravel(), shares.ravel())
        return volume

    def free_components(self, values: Array) -> Array:
        """Nodal values (n, 3) at the free nodes, with held components zero, shape (n_free, 3)."""
        found: Array = values[self.pattern.free]
        found[self.held] = 0.0
        return found

    def support_force(self, force: Array) -> Array:
        """Force of the supports on the whole body for nodal forces (n, 3) less the load [N], shape (3,)."""
        support: Array = force[self.fixed].sum(axis=0) * self.multiplicity
        for axis in self.mesh.symmetry:
            support["xyz".index(axis)] = 0.0
        return support

    def hold(self, blocks: Array) -> None:
        """Replace the rows and columns of the held components in blocks (nb, 3, 3) by a scaled identity."""
        if not self.held.any():
            return
        p = self.pattern
        rows = np.repeat(np.arange(len(p.free)), np.diff(p.indptr))
        diagonal = p.indptr[:-1]
        scale = np.abs(p.diagonal(blocks)).mean()
        partly: NDArray[np.bool_] = np.any(self.held, axis=1, keepdims=True)[:, 0]
        touched = np.flatnonzero(partly[rows] | partly[p.indices])
        keep = ~self.held[rows[touched]][:, :, None] & ~self.held[p.indices[touched]][:, None, :]
        blocks[touched] *= keep
        node, axis = np.nonzero(self.held)
        blocks[diagonal[node], axis, axis] = scale


class DiscretisedBody:
    """A material on a discretisation under dead loads: potential, forces, stiffness at positions x (n, 3).

    If the material depends on its history (`remembers`), forces are those of the present step, which `begin`
    starts and `accept` ends. A step that is not accepted has no effect on the history.

    Parameters
    ----------
    discretisation : Discretisation
    material : Material
    dead_load : ndarray of float, shape (n, 3), optional
        Nodal loads [N]; 0 by default.
    added_mass : ndarray of float, shape (n,), optional
        Point masses at the nodes for the dynamic methods [kg]; 0 by default.
    history : ndarray of float, shape (m, q, k), optional
        State of points whose history another body keeps (see `follow`), for a part of that body.
    """

    def __init__(
        self,
        discretisation: Discretisation,
        material: Material,
        *,
        dead_load: Array | None = None,
        added_mass: Array | None = None,
        history: Array | None = None,
    ) -> None:
        from tisim.kernels.elements import element_kernels  # imports Taichi
        from tisim.kernels.points import isochoric_kernels

        law = laws.get(material.law)
        law.check(material.parameters)
        self.discretisation = discretisation
        self.material = material
        self.law = law
        self.moduli = law.moduli(material.parameters)
        self.dead_load = np.zeros((discretisation.mesh.n_nodes, 3)) if dead_load is None else dead_load
        self.added_mass = np.zeros(discretisation.mesh.n_nodes) if added_mass is None else added_mass
        self.features = features_of(material)
        self._energy, self._forces, self._stiffness, self._pressures = element_kernels(
            law, features=self.features
        )
        self._sparse = int(discretisation.mesh.kind == "hex8")
        weights = discretisation.reference.weights
        self._weights = weights if discretisation.stiffness is None else weights * discretisation.stiffness
        self._prm = pack(material)
        points = (discretisation.mesh.n_elements, weights.shape[1])
        self.history = history_of(material, points) if history is None else None
        self.state = history if history is not None else NO_STATE
        if self.history is not None:
            self.state = self.history.state
            self._set_scale(self.history.scale)
            self._isochoric = isochoric_kernels(law, self.features)[0]
        kappa = law.kappa(material.parameters)
        wanted = POINTWISE[discretisation.mesh.kind] * self.moduli.shear_modulus - (
            self.moduli.bulk_modulus - kappa
        )
        pointwise = float(np.clip(wanted, 0.0, kappa)) if kappa > 0 else kappa
        self._kb, self._kp = bulk_shares(discretisation.mesh.kind, pointwise, kappa)
        if material.viscosity is not None:  # the instantaneous modulus
            more = material.viscosity.spectrum().instantaneous
            self.moduli = replace(self.moduli, shear_modulus=more * self.moduli.shear_modulus)

    def _common(self, x: Array) -> tuple[Any, ...]:
        ref = self.discretisation.reference
        return (
            x,
            self.discretisation.mesh.elements,
            ref.gradients,
            self._weights,
            self._prm,
            self.state,
            self._kp,
            self._kb,
        )

    @property
    def remembers(self) -> bool:
        """True if forces depend on the history of deformation."""
        return self.features.state_size > 0

    def begin(self, dt: float) -> None:
        """Begin a step of length dt [s] from the last accepted state; 0 for an instantaneous step."""
        if self.history is not None:
            self.history.begin(dt)
            self._set_scale(self.history.scale)

    def accept(self, x: Array) -> None:
        """Accept the present step, which ends at x (n, 3)."""
        if self.history is None:
            return
        ref, shape = self.discretisation.reference, self.history.dissipated.shape
        found = np.empty((*shape, 6)), np.empty((*shape, 6)), np.empty(shape)
        self._isochoric(x, self.discretisation.mesh.elements, ref.gradients, self._prm, self.state, *found)
        self.history.accept(found)
        self._set_scale(self.history.scale)

    def follow(self, whole: DiscretisedBody, elements: NDArray[np.bool_]) -> None:
        """Copy the state of `elements` (m,) of a body of the same material that this body is a part of."""
        if whole.history is not None:
            self.state[:] = whole.state[elements]
            self._set_scale(whole.history.scale)

    def take(self, history: History | None) -> None:
        """Continue from the history of a body of the same material and mesh; it is not copied."""
        self.history = history
        if history is not None:
            self.state = history.state
            self._set_scale(history.scale)

    def _set_scale(self, scale: float) -> None:
        self._prm[len(self._prm) - self.features.tail_size] = scale

    def dissipated(self) -> float:
        """Energy dissipated so far in the whole body [J]."""
        if self.history is None:
            return 0.0
        return float(np.vdot(self._weights, self.history.dissipated)) * self.discretisation.multiplicity

    def point_response(self, x: Array) -> tuple[Array, Array]:
        """Potential (m, q) [J/m3] and first Piola-Kirchhoff stress (m, q, 3, 3) [Pa] at x, by point.

        They do not include the discretisation's factors of stiffness. `internal_forces` are the integral of
        these stresses times the factors.
        """
        return self._points(x, self._prm, self.state)

    def stored_energy(self, x: Array) -> Array:
        """Recoverable energy density at the accepted x [J/m3], without factors of stiffness, shape (m, q)."""
        if self.history is None or not self.features.viscous:
            return self.point_response(x)[0]
        state, prm = self.state.copy(), self._prm.copy()
        state[..., :6] = 0.0
        prm[len(prm) - self.features.tail_size] = self.history.equilibrium
        return self._points(x, prm, state)[0] + self.history.stored()

    def _points(self, x: Array, prm: Array, state: Array) -> tuple[Array, Array]:
        from tisim.kernels.points import point_kernel

        x, conn, gradients, weights, _, _, kp, kb = self._common(x)
        psi, P = np.empty(weights.shape), np.empty((*weights.shape, 9))
        point_kernel(self.law, self.features)(x, conn, gradients, weights, prm, state, kp, kb, psi, P)
        return psi, P.reshape(*weights.shape, 3, 3)

    def pressures(self, x: Array, du: Array | None = None) -> Array:
        """Element pressures kb mean(theta) at x, advanced to first order by du (n, 3) [Pa], shape (m,)."""
        ref, out = self.discretisation.reference, np.zeros(self.discretisation.mesh.n_elements)
        if self._kb != 0.0:
            du = np.zeros_like(x) if du is None else du
            self._pressures(
                x, du, self.discretisation.mesh.elements, ref.gradients, self._weights, self._kb, out
            )
        return out

    def out_of_balance(self, force: Array) -> Array:
        """Out-of-balance force of internal forces (n, 3) at the free nodes [N], shape (n_free, 3)."""
        return self.discretisation.free_components(force - self.dead_load)

    def load_norm(self) -> float:
        """Norm of the dead load at the free nodes [N]."""
        return float(np.linalg.norm(self.dead_load[self.discretisation.pattern.free]))

    def energy(self, x: Array) -> tuple[float, float]:
        """Potential energy including that of the dead load [J], and the smallest det F."""
        out = np.empty(2)
        self._energy(*self._common(x), out)
        return float(out[0] - np.vdot(self.dead_load, x - self.discretisation.mesh.nodes)), float(out[1])

    def internal_forces(self, x: Array) -> tuple[Array, float]:
        """Gradient of the energy without the dead load [N], shape (n, 3), and the smallest det F."""
        out = np.empty(2)
        f = np.zeros_like(x)
        self._forces(*self._common(x), f, out)
        return f, float(out[1])

    def forces_and_energy(self, x: Array) -> tuple[Array, float, float]:
        """`internal_forces` and `energy` in one pass: forces (n, 3) [N], energy [J] and smallest det F."""
        out = np.empty(2)
        f = np.zeros_like(x)
        self._forces(*self._common(x), f, out)
        energy = float(out[0] - np.vdot(self.dead_load, x - self.discretisation.mesh.nodes))
        return f, energy, float(out[1])

    def stiffness(self, x: Array, pressure: Array | None = None) -> tuple[Array, Array, float]:
        """Blocks (nb, 3, 3) of the tangent [N/m], internal forces (n, 3) [N] and smallest det F.

        The tangent uses the element pressures `pressure` (m,) [Pa] if they are iterated as independent
        unknowns, else those at x.
        """
        pressure = self.pressures(x) if pressure is None else pressure
        p = self.discretisation.pattern
        out = np.empty(2)
        f = np.zeros_like(x)
        blocks = np.zeros((p.n_blocks, 3, 3))
        self._stiffness(
            *self._common(x), pressure, self._sparse, p.slot, self.discretisation._scratch, f, blocks, out
        )
        return blocks, f, float(out[1])


def gravity_load(
    discretisation: Discretisation, density: float, gravity: tuple[float, float, float]
) -> Array:
    """Consistent nodal weight [N], shape (n, 3), for a density [kg/m3] and gravity [m/s2]."""
    return density * discretisation.nodal_volume()[:, None] * np.asarray(gravity, dtype=float)
