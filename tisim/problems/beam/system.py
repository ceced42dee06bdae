"""Nonlinear system of a static beam: shared mesh and numbering, material, loads."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import Discretisation, DiscretisedBody, gravity_load
from tisim.discretisation.mass import facet_mass
from tisim.discretisation.quadrature import facet_load
from tisim.mesh import Mesh
from tisim.mesh.beam import beam_mesh
from tisim.problems.beam.rest_shape import is_planar
from tisim.scene import Beam

Array = NDArray[np.float64]

# Fraction of the nodal forces in imperfect clamps that counts as load: they largely cancel in their sum.
CLAMPS_PART = 0.01


def beam_discretisation(scene: Beam) -> Discretisation:
    """Mesh, numbering and symbolic factor of a beam, cached for the next beams on the same mesh."""
    if scene.mesh is not None:
        return _own_discretisation(scene.mesh, scene.held)
    return _structured_discretisation(
        scene.length,
        scene.section,
        scene.supports,
        scene.element,
        scene.axial_element_size,
        scene.radial_elements,
        is_planar(scene),
    )


@lru_cache(maxsize=16)
def _structured_discretisation(
    length: float,
    section: Any,
    supports: Any,
    element: str,
    axial_element_size: float,
    radial_elements: int,
    mirror: bool,
) -> Discretisation:
    kind: Any = "tet10" if element == "default" else element
    mesh = beam_mesh(
        length=length,
        section=section,
        supports=supports,
        kind=kind,
        axial_element_size=axial_element_size,
        radial_elements=radial_elements,
        mirror=mirror,
    )
    return _discretise(mesh, [name for name in ("clamp", "far_clamp") if name in mesh.node_sets])


@lru_cache(maxsize=16)
def _own_discretisation(mesh: Mesh, held: tuple[str, ...]) -> Discretisation:
    for name in held:
        if name not in mesh.node_sets:
            raise ValueError(f"beam mesh: expected a node set {name!r}")
    return _discretise(mesh, held)


def _discretise(mesh: Mesh, held: Sequence[str]) -> Discretisation:
    return Discretisation.build(mesh, np.unique(np.concatenate([mesh.node_sets[name] for name in held])))


class BeamSystem:
    """A beam under the fraction `factor` of its load (see `tisim.nonlinear.newton.System`).

    Parameters
    ----------
    body : DiscretisedBody
    tolerance : float
        Residual relative to the load that the solver will require. If the rounding error (stiffness times
        the last digit of the positions, for thin or nearly incompressible beams) exceeds it, `linearise`
        returns a load at which the tolerance is just reachable.
    """

    def __init__(self, body: DiscretisedBody, *, tolerance: float = 1e-6) -> None:
        self.body = body
        self.tolerance = tolerance
        self.full_load = body.dead_load
        self.factor = 1.0
        self.step_limit = np.inf
        self.least_load = 0.0  # smallest load scale [N], for a beam that is unloaded again
        self.clamps_load = (
            False  # True if clamps strain the body: their forces then contribute to the load scale
        )
        self.counts = {"factorisations": 0, "newton": 0}
        self.min_jacobian = 1.0
        self.factored_at: Array | None = None  # positions whose tangent has the last factor
        self._linearised_at: Array | None = None
        self._blocks: Array | None = None
        self._pressure: Array | None = None

    def free_pressures(self, start: Array | None) -> None:
        """Iterate the element pressures as unknowns, from `start` (m,) [Pa], without a line search.

        With None, pressures follow from the positions again.

        A step that is accurate to first order leaves a second-order error in volume. The potential penalises
        it by the bulk modulus and would cut the step; the mixed iteration does not.
        """
        self._pressure = start

    def searches(self) -> bool:
        return self._pressure is None

    def set_factor(self, factor: float) -> None:
        self.factor = factor
        self.body.dead_load = factor * self.full_load

    def potential(self, x: Array) -> tuple[float, float]:
        return self.body.energy(x)

    def linearise(self, x: Array) -> tuple[Array, float]:
        self._blocks, force, self.min_jacobian = self.body.stiffness(x, self._pressure)
        self._linearised_at = x
        self.counts["newton"] += 1
        residual = self.body.out_of_balance(force)
        if self.min_jacobian <= 0.0:
            residual[:] = np.nan
        return residual, max(self.load_scale(force), self._rounding(x) / self.tolerance)

    def load_scale(self, force: Array) -> float:
        """Scale of a residual [N], for internal forces (n, 3): the load, or that of the clamps."""
        load = max(self.body.load_norm(), self.least_load)
        if self.clamps_load:
            held = (force - self.body.dead_load)[self.body.discretisation.fixed]
            load = max(load, CLAMPS_PART * float(np.linalg.norm(held)))
        return load

    def _rounding(self, x: Array) -> float:
        """Estimated residual norm from rounding of the positions [N], 2 to 3 times the measured one."""
        assert self._blocks is not None
        diagonal = self.body.discretisation.pattern.diagonal(self._blocks)
        return 0.5 * float(np.finfo(float).eps * np.linalg.norm(diagonal) * np.abs(x).max())

    def step(self, residual: Array, *, forcing: float) -> Array:  # noqa: ARG002 - the solve is exact
        discretisation = self.body.discretisation
        assert self._blocks is not None
        discretisation.hold(self._blocks)
        self.factored_at = self._linearised_at
        diagonal = discretisation.pattern.indptr[:-1]
        scale = float(np.abs(discretisation.pattern.diagonal(self._blocks)).mean())
        shift = 0.0
        for attempt in range(8):
            discretisation.solver.factorise(self._blocks)
            self.counts["factorisations"] += 1
            step = discretisation.solver.solve(-residual)
            if discretisation.solver.negative == 0 and np.vdot(step, residual) < 0.0:
                return step
            # indefinite: shift the spectrum until the step is a descent direction
            more = scale * 1e-4 * 8.0**attempt
            self._blocks[diagonal] += (more - shift) * np.eye(3)
            shift = more
        return -residual / scale

    def second_step(self, residual: Array) -> Array | None:  # noqa: ARG002
        return None

    def advance(self, x: Array, step: Array) -> Array:
        moved = x.copy()
        moved[self.body.discretisation.pattern.free] += step
        if self._pressure is not None:
            self._pressure = self.body.pressures(x, moved - x)
        return moved

    def residual_norm(self, x: Array) -> float:
        return float(np.linalg.norm(self.body.out_of_balance(self.body.internal_forces(x)[0])))

    def largest_step(self) -> float:
        return self.step_limit


def beam_system(scene: Beam, discretisation: Discretisation) -> BeamSystem:
    """System of a beam with its material and loads; ValueError for a tip load on a mesh without a tip."""
    load = gravity_load(discretisation, scene.material.density, scene.gravity)
    mass = np.zeros(discretisation.mesh.n_nodes)
    if any(scene.tip_force) or scene.tip_mass:
        if "tip" not in discretisation.mesh.facet_sets:
            raise ValueError("beam: a tip force needs a free end (mesh facet set 'tip'), as a tip mass does")
        facets = discretisation.mesh.facet_sets["tip"]
        share = facet_load(discretisation.mesh, facets)
        load += share[:, None] / share.sum() * np.asarray(scene.tip_force) / discretisation.multiplicity
        mass += facet_mass(discretisation.mesh, facets, scene.tip_mass / discretisation.multiplicity)
    body = DiscretisedBody(discretisation, scene.material, dead_load=load, added_mass=mass)
    return BeamSystem(body, tolerance=scene.solver.tolerance)
