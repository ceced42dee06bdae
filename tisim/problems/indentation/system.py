"""A block under a rod at one pose: energy, residual and Newton step of body and contact combined."""

from __future__ import annotations

from copy import copy, deepcopy
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import Discretisation, DiscretisedBody, gravity_load
from tisim.discretisation.history import History
from tisim.discretisation.quadrature import TetrahedralParts, facet_areas
from tisim.kernels.contact import contact_kernels, pack_rod
from tisim.linear.blocks import FullMatrix
from tisim.linear.krylov import FactorGMRES
from tisim.mesh.indentation import sliding
from tisim.problems.indentation.far_field import Drag, ElasticForces, FarField, Part
from tisim.problems.indentation.first_touch import FirstTouch, near_facets
from tisim.problems.indentation.turning import axis_at, rotation
from tisim.scene import Poke

Array = NDArray[np.float64]

# Contact stiffness in units of shear modulus over edge radius: the penetration under a pressure of ten
# shear moduli is a twentieth of the edge radius. With twice the stiffness, stick and slip are more abrupt.
NORMAL_STIFFNESS = 200.0
# Factor of that stiffness, less 1, where the surface slides round the rod's edge (`sliding`): its penetration
# is deepest there.
STIFFER_SLIDING = 2.0
# Penetration, as a fraction of the edge radius, at which the pressure is twice that of a linear penalty. With
# a linear penalty the surface of crushed tissue slips past the rod's edge (studies/depth).
HARDENS_AT = 0.1
# Slip at which friction reaches its limit, in units of the edge radius and the coefficient of friction: what
# holds a sticking point is in proportion to the pressure alone. A spring of one stiffness for all pressures
# gives way too far under the tractions of a law that stiffens, or holds a soft tissue's surface at the shaft
# too low (studies/depth).
ELASTIC_SLIP = 1.0 / 12.0
# Upper limit of the edge radius in the contact stiffness and in limits of the penetration, as a fraction of
# the rod's radius. With its whole radius a hemisphere would penetrate so far that its force is 1.3 % low,
# whatever the mesh.
ROUNDEST = 0.4
# Contact points along a facet's side, by its number of nodes. With three on the facets of hex20 the rod's
# edge passes between them where the tissue is stretched most (studies/depth).
POINTS_PER_SIDE = {3: 4, 4: 4, 6: 4, 8: 5}
# Points per side at which the penetration of a converged surface is measured: the rod's edge could pass
# between the contact points of a curved facet.
WATCHED_PER_SIDE = 7
# Penetration of an accepted state, as a fraction of the edge radius, from which facets have FINER more points
# of contact per side (and WATCHED_FINER are measured): over crushed tissue the edge passes between fewer.
FINER_FROM, FINER, WATCHED_FINER = 0.22, 2, 10
# Largest area of the deformed surface on which the contact acts, in units of that at rest. At 30 of 32 mm
# the surface over the edge is stretched to 18 times its area: per area at rest, its contact would be as many
# times softer, and the edge would pass through it.
LARGEST_AREA = 30.0


class Remembered(NamedTuple):
    """Data of the last accepted state, see `PokeSystem.remembered`."""

    x: Array
    depth: float
    pose: tuple[Array, Array]
    slip: Array
    gap: Array
    finer: bool
    area: Array
    history: History | None
    parts: tuple[Array, Array] | None


class PokeSystem:
    """The block under a rod at one pose (see `tisim.nonlinear.contact_newton`).

    Attributes
    ----------
    axis : direction of the rod, shape (3,).
    depth : depth of the rod [m].
    facets : facets of the top that the rod can touch, shape (f, a).
    rounding : edge radius of the rod, at most ROUNDEST of its radius [m]; unit of penetrations.
    forces : internal forces of the elements and of the far tissue.
    far : condensed far tissue, if the body is the near part of a block; else None.
    drag : resistance to motion, added to energy, forces and tangent; None for equilibrium.
    finer : True once the facets have more contact points (`FINER_FROM`).
    report : results of the last residual or linearisation, shape (6,): force on the rod (3) [N], smallest
        distance [m], area in contact [m2], 1 if friction acts.
    """

    def __init__(self, scene: Poke, discretisation: Discretisation) -> None:
        mesh, rod = discretisation.mesh, scene.rod
        self._parts: TetrahedralParts | None = None
        if mesh.kind == "hex8":  # copy the weights, which change with the rod's depth
            own = replace(discretisation.reference, weights=discretisation.reference.weights.copy())
            discretisation = replace(discretisation, reference=own)
            self._parts = TetrahedralParts(mesh, own)
        self.scene, self.discretisation = scene, discretisation
        self.body = DiscretisedBody(
            discretisation,
            scene.material,
            dead_load=gravity_load(discretisation, scene.material.density, scene.gravity),
        )
        self.axis = self.previous_axis = axis_at(scene, 0.0)
        self.edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
        self.facets = near_facets(scene, mesh)
        self._touch = FirstTouch(scene, mesh, self.facets)
        self.start = self._previous_start = self._touch.tip(self.axis)
        self._slot = discretisation.pattern.slots(self.facets)
        g = self.body.moduli.shear_modulus
        edge = self.rounding = min(self.edge, ROUNDEST * rod.radius)
        normal = NORMAL_STIFFNESS * (1.0 + STIFFER_SLIDING * sliding(scene.friction))
        slip = ELASTIC_SLIP * scene.friction * edge
        self._law = np.array([normal * g / edge, slip, scene.friction, HARDENS_AT * edge])
        self._measure, self._energy, self._assemble = contact_kernels()
        self._place_points(finer=False)
        self.linear = FactorGMRES(discretisation.pattern)
        self.full = FullMatrix(discretisation.pattern, self.facets)
        self.far: FarField | None = None
        self.drag: Drag | None = None
        self.linearisations = 0
        self.min_jacobian = 1.0
        self.forces = ElasticForces(self.body)
        self.previous = mesh.nodes.copy()
        self.depth = self.previous_depth = 0.0
        self._pose(0.0)
        self._measure(self.previous, self.facets, self._shape, self._rod, self._gap)
        self.report = np.zeros(6)

    def _pose(self, depth: float) -> None:
        self.depth = depth
        rod = self.scene.rod
        shift = (depth - self.previous_depth) * self.axis
        turned = None
        if self.axis is not self.previous_axis:
            shift += self.previous_depth * (self.axis - self.previous_axis)
            shift += self.start - self._previous_start
            turned = rotation(self.previous_axis, self.axis)
        self._rod = pack_rod(self.tip, self.axis, rod.radius, self.edge, shift, turned)

    def _place_points(self, *, finer: bool) -> None:
        """Place contact points that do not touch yet, and those at which the penetration is measured."""
        rest, more = self.discretisation.mesh.nodes, FINER if finer else 0
        self._per_side = POINTS_PER_SIDE[self.facets.shape[1]] + more
        shape, self._rest_area = facet_areas(rest, self.facets, self._per_side)
        self._area = self._rest_area
        self._shape = np.ascontiguousarray(shape)
        between = facet_areas(rest, self.facets, WATCHED_FINER if finer else WATCHED_PER_SIDE)[0]
        self._watched = np.ascontiguousarray(between), np.empty((len(self.facets), len(between)))
        points = self._area.shape
        self._memory, self._slip = np.zeros((*points, 3)), np.zeros((*points, 3))
        self._skew = np.zeros((*points, 9))
        self._gap, self._pressure = np.full(points, 1.0), np.zeros(points)
        self._part = np.zeros(points)
        self.finer = finer

    def _add_points(self) -> None:
        """More contact points, each with the slip of the nearest of those before."""
        shape, slip = self._shape, self._memory
        self._place_points(finer=True)
        # the nearer two places on a facet are, the less their shape functions differ
        apart = np.linalg.norm(self._shape[:, None] - shape, axis=2)
        self._memory = np.ascontiguousarray(slip[:, apart.argmin(axis=1)])
        self._area = self._areas(self.previous)

    def _areas(self, x: Array) -> Array:
        """Areas (f, q) [m2] of the contact points on the surface at x (n, 3), at least those at rest."""
        now = facet_areas(x, self.facets, self._per_side)[1]
        found: Array = np.clip(now, self._rest_area, LARGEST_AREA * self._rest_area)
        return found

    @property
    def tip(self) -> Array:
        return self.start + self.depth * self.axis

    def move_to(self, depth: float, axis: Array | None = None) -> None:
        """Move the rod to a depth [m] and, if given, a direction (unit vector) from the accepted state."""
        if axis is not None:
            same = np.array_equal(axis, self.previous_axis)
            self.axis = self.previous_axis if same else axis
            self.start = self._touch.tip(self.axis)
        self._pose(depth)

    def turn(self, way: float) -> None:
        """Set the sense of motion, way > 0 down or way < 0 up; going up, tetrahedral parts may fall again."""
        if self._parts is not None:
            self._parts.may_recover = way < 0.0

    def touch(self, guess: Array) -> None:
        """Estimate from the start value the fraction of the step in which each point is in contact."""
        distance = np.empty_like(self._gap)
        self._measure(guess, self.facets, self._shape, self._rod, distance)
        gap = np.maximum(self._gap, 0.0)
        overlap = np.maximum(-distance, 0.0)
        self._part = np.where(self._gap <= 0.0, 1.0, overlap / (gap + overlap + 1e-15))

    def begin(self, dt: float) -> None:
        """Begin a step of length dt [s] from the last accepted state."""
        self.body.begin(dt)
        self.forces.forget()

    def accept(self, x: Array, *, follow: bool = True) -> None:
        """Accept x as converged state: update the history of friction, material and distorted elements.

        With `follow`, the contact's areas become those of the surface at x: the forces at x change, and the
        next step finds their equilibrium.
        """
        if self.body.remembers:
            self.body.accept(x)
            self.forces.forget()
        self._memory = self._slip.copy()
        if not self.finer and self.overlap(x) > FINER_FROM * self.rounding:
            self._add_points()
        if follow:
            self._area = self._areas(x)
        self._measure(x, self.facets, self._shape, self._rod, self._gap)
        self.previous, self.previous_depth = x, self.depth
        self.previous_axis, self._previous_start = self.axis, self.start
        if self._parts is not None:
            self._parts.update(x)
            self.forces.forget()

    def remembered(self) -> Remembered:
        """Data of the last accepted state, for `recall`."""
        return Remembered(
            x=self.previous,
            depth=self.previous_depth,
            pose=(self.previous_axis, self._previous_start),
            slip=self._memory,
            gap=self._gap.copy(),
            finer=self.finer,
            area=self._area,
            history=deepcopy(self.body.history),
            parts=None if self._parts is None else self._parts.state(),
        )

    def recall(self, earlier: Remembered) -> None:
        """Return to an earlier accepted state; each `Remembered` can be used only once."""
        self.previous, self.previous_depth = earlier.x, earlier.depth
        self.previous_axis, self._previous_start = earlier.pose
        if self.finer != earlier.finer:
            self._place_points(finer=earlier.finer)
        self._memory, self._gap, self._area = earlier.slip, earlier.gap, earlier.area
        self.body.take(earlier.history)
        if self._parts is not None and earlier.parts is not None:
            self._parts.restore(earlier.parts)
        self.forces.forget()

    def restricted(self, part: Part, far: FarField) -> PokeSystem:
        """This system at its depth, restricted to some elements, with `far` in place of the others.

        The contact's data of the last accepted state are shared with this system, those of trials are not.
        """
        it = copy(self)
        it.discretisation, it.body, it.linear = part.body.discretisation, part.body, part.linear
        it.full, it._slot, it.far = part.full, part.slot, far
        it._pressure, it._slip, it._skew = self._pressure.copy(), self._slip.copy(), self._skew.copy()
        it.forces, it.report = ElasticForces(part.body, far), np.zeros(6)
        return it

    def potential(self, x: Array) -> tuple[float, float]:
        """Potential [J] at fixed pressures in the friction, and smallest det F."""
        _, energy, min_jacobian = self.forces.at(x)
        out = np.empty(2)
        self._energy(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law,
            self._memory, self._part, self._pressure, out,
        )  # fmt: skip
        energy += float(out[0])
        if self.drag is not None:
            energy += self.drag.energy(x)
        return energy, min_jacobian

    @property
    def penetration(self) -> float:
        """Largest penetration of the last accepted state into the rod at the contact points [m], or 0."""
        return max(-float(self._gap.min()), 0.0)

    def overlap(self, x: Array) -> float:
        """Largest penetration of the surface at x into the rod [m], also between contact points, or 0."""
        shape, distance = self._watched
        self._measure(x, self.facets, shape, self._rod, distance)
        return max(-float(distance.min()), 0.0)

    def residual(self, x: Array) -> tuple[Array, float]:
        """Residual at the free nodes (n_free, 3) [N] and the load scale [N]; sets `report`."""
        force, _, self.min_jacobian = self.forces.at(x)
        none = np.full_like(self._slot, -1)
        return self._with_contact(x, force, none, np.zeros((1, 3, 3)))

    def linearise(self, x: Array) -> tuple[Array, float]:
        """As `residual`, and assemble the tangent for the next steps."""
        self._blocks, force, self.min_jacobian = self.body.stiffness(x)
        if self.far is not None:
            self.far.add_to(force, x)
        self.linearisations += 1
        found = self._with_contact(x, force, self._slot, self._blocks)
        if self.drag is not None:
            pattern = self.discretisation.pattern
            diagonal = pattern.indptr[:-1]
            self._blocks[diagonal] += self.drag.stiffness[pattern.free, None, None] * np.eye(3)
        self.discretisation.hold(self._blocks)
        self._matrix = self.full.filled(self._blocks, self._unsymmetric())
        return found

    def _unsymmetric(self) -> Array | None:
        """Unsymmetric part of the friction tangent by node pair [N/m], (f, a, a, 3, 3); None if it is 0."""
        if self.report[5] == 0.0:
            return None
        pairs = self._shape[:, :, None] * self._shape[:, None, :]  # (q, a, a)
        points, nodes = self._shape.shape
        return (pairs.reshape(points, -1).T @ self._skew).reshape(-1, nodes, nodes, 3, 3)

    def _with_contact(
        self, x: Array, force: Array, slot: NDArray[np.int32], blocks: Array
    ) -> tuple[Array, float]:
        self.internal = force
        total = force.copy()
        self._assemble(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law, self._memory,
            self._part, self._pressure, self._slip, self._skew, slot, total, blocks, self.report,
        )  # fmt: skip
        if self.drag is not None:
            total += self.drag.forces(x)
        # a floor on the scale of a millinewton, since there is no force before first contact
        floor = 1e-4 * self.body.moduli.shear_modulus * self.edge**2
        load = np.linalg.norm(self.report[:3]) + np.linalg.norm(self.body.dead_load) + floor
        return self.body.out_of_balance(total), float(load)

    def step(self, residual: Array, *, forcing: float) -> Array:
        return self.linear.solve(self._blocks, -residual, tolerance=forcing, multiply=self.multiply)

    def multiply(self, v: Array) -> Array:
        """Product of the last tangent and v, shapes (3 n_free,)."""
        product: Array = self._matrix @ v
        if self.far is not None:
            self.far.add_product(v, product)
        return product

    def residual_norm(self, x: Array) -> float:
        """Norm of the residual at a trial x [N]; leaves `report` and the contact's data unchanged."""
        total = self.forces.at(x).force.copy()
        report, pressure = np.zeros(6), np.zeros_like(self._pressure)
        slip, skew = np.empty_like(self._slip), np.empty_like(self._skew)
        none = np.full_like(self._slot, -1)
        self._assemble(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law, self._memory,
            self._part, pressure, slip, skew, none, total, np.zeros((1, 3, 3)), report,
        )  # fmt: skip
        if self.drag is not None:
            total += self.drag.forces(x)
        return float(np.linalg.norm(self.body.out_of_balance(total)))

    def rod_force(self) -> float:
        """Magnitude of the force on the rod in the last residual or linearisation [N]."""
        return float(np.linalg.norm(self.report[:3]))

    def advance(self, x: Array, step: Array) -> Array:
        moved = x.copy()
        moved[self.discretisation.pattern.free] += step
        return moved

    def base_force(self) -> Array:
        """Force of the supports on the body in the last residual or linearisation [N], shape (3,)."""
        fixed = self.discretisation.fixed
        return (self.internal[fixed] - self.body.dead_load[fixed]).sum(axis=0)
