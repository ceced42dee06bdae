"""A discretised body: a mesh's layout, shared by all candidates on it, and a material on that layout."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim import _pattern, _quadrature, laws
from tisim._kernels import element_kernels
from tisim._linear import DirectSolver
from tisim.mesh import Mesh
from tisim.scene import Material

Array = NDArray[np.float64]

# Bulk modulus that stays pointwise, what W itself resists included, in units of the shear modulus, by
# element. One pressure a tet10 is too soft in bending without it: against benchmarks/references/beams.json
# (K/mu 20 to 1000, mu 9 and 40 kPa) the default beams are within -0.43 and +0.61 % with 0 left to W of
# Ogden, -0.51 and +0.16 % with 2/3, -0.70 and +0.03 % with 1. The Neo-Hookean W has 2/3 of its own.
POINTWISE = {"tet4": np.inf, "tet10": 2.0 / 3.0, "hex8": 2.0}


@dataclass(eq=False)
class Layout:
    """What depends on the mesh and its supports only: quadrature, numbering, sparsity, symbolic factor.

    held: boolean (n, 3), components of free nodes that may not move (mirror planes, platens).
    stiffness, density: (m, q), factors of the material's stiffness and density at the quadrature points, None
        where all are 1. The energy is linear in the stiffness (the element's mean volumetric strain becomes
        the mean weighted by it), so the kernels take them as part of their weights.
    """

    mesh: Mesh
    fixed: NDArray[np.int32]
    held: NDArray[np.bool_]
    reference: _quadrature.Reference
    pattern: _pattern.Pattern
    solver: DirectSolver
    _scratch: Array = field(repr=False)
    stiffness: Array | None = None
    density: Array | None = None

    @staticmethod
    def build(mesh: Mesh, fixed: NDArray[np.int32], held: NDArray[np.bool_] | None = None) -> Layout:
        held = np.zeros((mesh.n_nodes, 3), dtype=bool) if held is None else held.copy()
        for axis in mesh.symmetry:
            held[mesh.node_sets[f"mirror_{axis}"], "xyz".index(axis)] = True
        pattern = _pattern.build(mesh.elements, mesh.n_nodes, fixed)
        na = mesh.elements.shape[1]
        return Layout(
            mesh=mesh,
            fixed=np.asarray(fixed, dtype=np.int32),
            held=held[pattern.free],
            reference=_quadrature.reference(mesh),
            pattern=pattern,
            solver=DirectSolver(pattern.indptr, pattern.indices),
            _scratch=np.zeros((na, 9 * na + 3)),
        )

    @property
    def multiplicity(self) -> float:
        """How many copies of the mesh make the whole body."""
        return 2.0 ** len(self.mesh.symmetry)

    def nodal_volume(self) -> Array:
        """Rest volume by node, the integral of each shape function, shape (n,); sums to the volume.

        Where the layout has a density, that of the volume at the material's stated density with as much mass.
        """
        ref, mesh = self.reference, self.mesh
        weights = ref.weights if self.density is None else ref.weights * self.density
        shares = weights @ ref.values
        volume = np.zeros(mesh.n_nodes)
        np.add.at(volume, mesh.elements.ravel(), shares.ravel())
        return volume

    def hold(self, blocks: Array) -> None:
        """Decouple the held components: their rows and columns of the matrix become a scaled identity."""
        if not self.held.any():
            return
        p = self.pattern
        rows = np.repeat(np.arange(len(p.free)), np.diff(p.indptr))
        diagonal = p.indptr[:-1]
        scale = np.abs(blocks[diagonal][:, [0, 1, 2], [0, 1, 2]]).mean()
        partly: NDArray[np.bool_] = np.any(self.held, axis=1, keepdims=True)[:, 0]
        touched = np.flatnonzero(partly[rows] | partly[p.indices])
        keep = ~self.held[rows[touched]][:, :, None] & ~self.held[p.indices[touched]][:, None, :]
        blocks[touched] *= keep
        node, axis = np.nonzero(self.held)
        blocks[diagonal[node], axis, axis] = scale


class Body:
    """A material on a layout under dead nodal loads: potential, forces, stiffness at positions x (n, 3).

    added_mass (n,): point masses at the nodes, of the dynamic methods [kg].
    """

    def __init__(
        self,
        layout: Layout,
        material: Material,
        *,
        dead_load: Array | None = None,
        added_mass: Array | None = None,
    ) -> None:
        law = laws.get(material.law)
        law.check(material.parameters)
        self.layout = layout
        self.material = material
        self.moduli = law.moduli(material.parameters)
        self.dead_load = np.zeros((layout.mesh.n_nodes, 3)) if dead_load is None else dead_load
        self.added_mass = np.zeros(layout.mesh.n_nodes) if added_mass is None else added_mass
        self._energy, self._forces, self._stiffness, self._pressures = element_kernels(
            law.name, sparse=layout.mesh.kind == "hex8"
        )
        weights = layout.reference.weights
        self._weights = weights if layout.stiffness is None else weights * layout.stiffness
        self._prm = np.ascontiguousarray(law.pack(material.parameters), dtype=np.float64)
        kappa = law.kappa(material.parameters)
        wanted = POINTWISE[layout.mesh.kind] * self.moduli.shear - (self.moduli.bulk - kappa)
        self._kp = float(np.clip(wanted, 0.0, kappa)) if kappa > 0 else kappa
        self._kb = kappa - self._kp

    def _common(self, x: Array) -> tuple[Any, ...]:
        ref = self.layout.reference
        return (x, self.layout.mesh.elements, ref.gradients, self._weights, self._prm, self._kp, self._kb)

    def pressures(self, x: Array, du: Array | None = None) -> Array:
        """Element pressures kb mean(theta) at x, advanced to first order by du (n, 3), shape (m,) [Pa]."""
        ref, out = self.layout.reference, np.zeros(self.layout.mesh.n_elements)
        if self._kb != 0.0:
            du = np.zeros_like(x) if du is None else du
            self._pressures(x, du, self.layout.mesh.elements, ref.gradients, self._weights, self._kb, out)
        return out

    def energy(self, x: Array) -> tuple[float, float]:
        """Potential energy [J] with the dead load, and the smallest det F."""
        out = np.empty(2)
        self._energy(*self._common(x), out)
        return float(out[0] - np.vdot(self.dead_load, x - self.layout.mesh.nodes)), float(out[1])

    def internal_forces(self, x: Array) -> tuple[Array, float]:
        """dEnergy/dx without the dead load, shape (n, 3) [N], and the smallest det F."""
        out = np.empty(2)
        f = np.zeros_like(x)
        self._forces(*self._common(x), f, out)
        return f, float(out[1])

    def forces_and_energy(self, x: Array) -> tuple[Array, float, float]:
        """`internal_forces` and `energy` in one pass: forces (n, 3) [N], energy [J], smallest det F."""
        out = np.empty(2)
        f = np.zeros_like(x)
        self._forces(*self._common(x), f, out)
        energy = float(out[0] - np.vdot(self.dead_load, x - self.layout.mesh.nodes))
        return f, energy, float(out[1])

    def stiffness(self, x: Array, pressure: Array | None = None) -> tuple[Array, Array, float]:
        """Blocks (nb, 3, 3) of the tangent [N/m], internal forces (n, 3), smallest det F.

        pressure (m,): element pressures of the tangent where they are iterated as unknowns of their own.
        """
        pressure = self.pressures(x) if pressure is None else pressure
        p = self.layout.pattern
        out = np.empty(2)
        f = np.zeros_like(x)
        blocks = np.zeros((p.n_blocks, 3, 3))
        self._stiffness(*self._common(x), pressure, p.slot, self.layout._scratch, f, blocks, out)
        return blocks, f, float(out[1])


def gravity_load(layout: Layout, density: float, gravity: tuple[float, float, float]) -> Array:
    """Consistent nodal weight, shape (n, 3) [N]."""
    return density * layout.nodal_volume()[:, None] * np.asarray(gravity, dtype=float)
