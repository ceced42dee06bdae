"""A rod pushed into a block, step by step, each step an equilibrium with frictional contact."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim._body import Body, Layout, gravity_load
from tisim._contact import contact_kernels, pack_rod
from tisim._krylov import FactorGMRES
from tisim._newton import newton
from tisim._quadrature import facet_areas, facet_quadrature
from tisim.mesh import Mesh
from tisim.mesh.poke_block import poke_mesh
from tisim.result import Cost, Result, Status
from tisim.scene import Poke, Rod

Array = NDArray[np.float64]

# Contact stiffness in units of shear modulus over edge radius: the penetration under a pressure of ten
# shear moduli is a fortieth of the edge radius.
NORMAL_STIFFNESS = 400.0
TANGENT_STIFFNESS = 100.0
POINTS_PER_SIDE = 4
# Penetration, as a part of the edge radius, at which the contact is made stiffer, and a step refused.
STIFFEN_AT, REFUSE_AT = 0.25, 0.5
FIRST_STEP, LARGEST_STEP, SMALLEST_STEP = 0.1e-3, 0.5e-3, 0.02e-3
SAME = 1e-9  # depths closer than this are one [m]


@dataclass(frozen=True, eq=False)
class Frame:
    """One equilibrium: depth [m], positions, forces on rod and base [N], and how good it is."""

    depth: float
    x: Array
    rod_force: Array
    base_force: Array
    tip: Array
    penetration: float
    min_jacobian: float
    residual: float


def rod_start(rod: Rod, site: tuple[float, float], height: float, axis: Array) -> Array:
    """Tip centre where the rod, its axis through the site, first touches the plane z = height."""
    edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
    core = rod.radius - edge
    tilt = np.sqrt(max(0.0, 1.0 - axis[2] ** 2))
    # lowest point below the tip's centre: the edge torus, e ahead of its centre circle
    reach = core * tilt + edge - edge * abs(axis[2])
    target = np.array([site[0], site[1], height])
    return target - axis * (reach / abs(axis[2]))


class PokeSystem:
    """The block under a rod at one pose (see `tisim._newton.System`)."""

    def __init__(self, scene: Poke, layout: Layout) -> None:
        mesh, rod = layout.mesh, scene.rod
        self.scene, self.layout = scene, layout
        self.body = Body(
            layout, scene.material, dead_load=gravity_load(layout, scene.material.density, scene.gravity)
        )
        self.axis = np.asarray(scene.direction, dtype=float) / np.linalg.norm(scene.direction)
        self.edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
        height = float(mesh.nodes[mesh.facet_sets["top"], 2].max())
        self.start = rod_start(rod, scene.site, height, self.axis)
        self.facets = np.ascontiguousarray(self._near(mesh), dtype=np.int32)
        self._slot = layout.pattern.slots(self.facets)
        self._shape = np.ascontiguousarray(facet_quadrature(self.facets.shape[1], POINTS_PER_SIDE)[0])
        self._area = facet_areas(mesh, self.facets, POINTS_PER_SIDE)[1]
        points = self._area.shape
        g = self.body.moduli.shear
        kn = NORMAL_STIFFNESS * g / self.edge
        self._law = np.array([kn, TANGENT_STIFFNESS * g / self.edge, scene.friction])
        self._memory, self._slip = np.zeros((*points, 3)), np.zeros((*points, 3))
        self._skew = np.zeros((*points, 9))
        self._gap, self._pressure = np.full(points, 1.0), np.zeros(points)
        self._part = np.zeros(points)
        self._measure, self._energy, self._assemble, self._multiply_skew = contact_kernels()
        self.linear = FactorGMRES(layout.pattern)
        self.linearisations = 0
        self._known: tuple[Array, float, float] | None = None
        self.previous = mesh.nodes.copy()
        self.depth = self.previous_depth = 0.0
        self._pose(0.0)
        self._measure(self.previous, self.facets, self._shape, self._rod, self._gap)
        self.report = np.zeros(6)

    def _near(self, mesh: Mesh) -> NDArray[np.int32]:
        """Facets of the top that the rod can come to touch."""
        top = mesh.facet_sets["top"]
        centres = mesh.nodes[top].mean(axis=1)[:, :2] - np.asarray(self.scene.site)
        along = np.array(self.axis[:2])
        reach = 0.5 * self.scene.depth + 4.0 * self.scene.rod.radius
        travel = np.clip(centres @ along / max(float(along @ along), 1e-12), 0.0, self.scene.depth)
        off = np.linalg.norm(centres - travel[:, None] * along, axis=1)
        return top[off < reach]

    def _pose(self, depth: float) -> None:
        self.depth = depth
        rod = self.scene.rod
        self._rod = pack_rod(
            self.tip, self.axis, rod.radius, self.edge, (depth - self.previous_depth) * self.axis
        )

    @property
    def tip(self) -> Array:
        return self.start + self.depth * self.axis

    def move_to(self, depth: float) -> None:
        """Put the rod at this depth; slip counts from the last accepted state."""
        self._pose(depth)

    def touch(self, guess: Array) -> None:
        """Set the part of the step in which each point touches, by the step's start value."""
        distance = np.empty_like(self._gap)
        self._measure(guess, self.facets, self._shape, self._rod, distance)
        gap = np.maximum(self._gap, 0.0)
        overlap = np.maximum(-distance, 0.0)
        self._part = np.where(self._gap <= 0.0, 1.0, overlap / (gap + overlap + 1e-15))

    def accept(self, x: Array) -> None:
        """Take x as the converged state: friction remembers it."""
        self._memory = self._slip.copy()
        self._measure(x, self.facets, self._shape, self._rod, self._gap)
        self.previous, self.previous_depth = x, self.depth

    def stiffen(self) -> None:
        """Double the contact's normal stiffness: deep down the pressure at the edge outgrows it."""
        self._law[0] *= 2.0

    def potential(self, x: Array) -> tuple[float, float]:
        if self._known is None or self._known[0] is not x:
            self._known = (x, *self.body.energy(x))  # an accepted trial is the next search's start
        _, energy, min_jacobian = self._known
        out = np.empty(2)
        self._energy(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law,
            self._memory, self._part, self._pressure, out,
        )  # fmt: skip
        return energy + float(out[0]), min_jacobian

    def linearise(self, x: Array) -> tuple[Array, float]:
        layout = self.layout
        blocks, force, min_jacobian = self.body.stiffness(x)
        self.internal = force.copy()
        self._assemble(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law, self._memory,
            self._part, self._pressure, self._slip, self._skew, self._slot, force, blocks, self.report,
        )  # fmt: skip
        layout.hold(blocks)
        self._blocks = blocks
        self.min_jacobian = min_jacobian
        self.linearisations += 1
        residual = (force - self.body.dead_load)[layout.pattern.free]
        residual[layout.held] = 0.0
        # before first touch there is no force to compare with: a millinewton-scale floor
        floor = 1e-4 * self.body.moduli.shear * self.edge**2
        load = np.linalg.norm(self.report[:3]) + np.linalg.norm(self.body.dead_load) + floor
        return residual, float(load)

    def step(self, residual: Array, *, forcing: float) -> Array:
        skew = self._skew_product if self.report[5] > 0.0 else None
        return self.linear.solve(self._blocks, -residual, tolerance=forcing, skew=skew)

    def second_step(self, residual: Array) -> Array | None:
        """Without the unsymmetric part of friction, which can make the whole tangent near singular."""
        if self.report[5] == 0.0:
            return None
        return self.linear.solve(self._blocks, -residual, tolerance=1e-2)

    def _skew_product(self, v: Array, out: Array) -> None:
        self._multiply_skew(
            self.facets,
            self.layout.pattern.index,
            self._shape,
            self._pressure,
            self._part,
            self._skew,
            v,
            out,
        )

    def residual_norm(self, x: Array) -> float:
        """Size of the residual at x, with Coulomb's law without lag [N]."""
        layout = self.layout
        force, _ = self.body.internal_forces(x)
        report, pressure = np.zeros(6), np.zeros_like(self._pressure)
        none = np.full_like(self._slot, -1)
        self._assemble(
            x, self.previous, self.facets, self._shape, self._area, self._rod, self._law, self._memory,
            self._part, pressure, self._slip, self._skew, none, force, np.zeros((1, 3, 3)), report,
        )  # fmt: skip
        residual = (force - self.body.dead_load)[layout.pattern.free]
        residual[layout.held] = 0.0
        return float(np.linalg.norm(residual))

    def advance(self, x: Array, step: Array) -> Array:
        moved = x.copy()
        moved[self.layout.pattern.free] += step
        return moved

    def searches(self) -> bool:
        return True

    def largest_step(self) -> float:
        return 2e-3

    def base_force(self) -> Array:
        """Force of the fixed nodes on the body, from the last linearisation [N]."""
        fixed = self.layout.fixed
        return (self.internal[fixed] - self.body.dead_load[fixed]).sum(axis=0)


def solve_poke(scene: Poke, *, trace: Callable[[str], None] | None = None) -> Result:
    """Push the rod in until the depth asked for, or until the solution ends; frames at every spacing.

    trace: called with one line of text for each step tried.
    """
    mesh_start = time.process_time()
    mesh = scene.mesh or poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod,
        refinement=scene.refinement,
    )  # fmt: skip
    layout = Layout.build(mesh, mesh.node_sets["base"])
    mesh_seconds = time.process_time() - mesh_start
    start = time.process_time()
    system = PokeSystem(scene, layout)
    frames, status, steps, cuts, iterations = _push(scene, system, trace=trace)
    cost = Cost(
        core_seconds=time.process_time() - start,
        mesh_seconds=mesh_seconds,
        steps=steps,
        newton_iterations=iterations,
        factorisations=system.linear.factorisations,
        linear_iterations=system.linear.iterations,
        step_cuts=cuts,
    )
    return _result(scene, mesh, frames, status, cost)


def _push(
    scene: Poke, system: PokeSystem, *, trace: Callable[[str], None] | None
) -> tuple[list[Frame], Status, int, int, int]:
    x = system.previous.copy()
    velocity = np.zeros_like(x)
    depth, step = 0.0, FIRST_STEP
    frames: list[Frame] = []
    steps = cuts = iterations = 0
    status = Status.CONVERGED
    next_frame = scene.frame_spacing
    while depth < scene.depth - SAME:
        target = min(depth + step, next_frame, scene.depth)
        if SAME < next_frame - target < 0.2 * step:
            target = 0.5 * (depth + next_frame)
        system.move_to(target)
        guess = _predict(system, x, velocity * (target - depth))
        system.touch(guess)
        outcome = newton(
            system, guess, tolerance=scene.solver.tolerance, max_iterations=scene.solver.max_iterations
        )
        steps += 1
        iterations += outcome.iterations
        overlap = -float(system.report[3])
        failed: Status | None = None if outcome.status is Status.CONVERGED else outcome.status
        if failed is None and overlap > REFUSE_AT * system.edge:
            failed = Status.PENETRATION
        if trace is not None:
            trace(
                f"{target * 1e3:7.3f} step {step * 1e3:.3f} it {outcome.iterations:2d}"
                f" {outcome.status.value:14s} F {system.report[:3] @ -system.axis:8.4f}"
                f" overlap {overlap * 1e3:.3f}"
                f" J {system.min_jacobian:.3f} res {outcome.residual:.1e} cg {system.linear.iterations}"
                f" fac {system.linear.factorisations} shift {system.linear.shift:.0e}"
            )
        if failed is not None:
            status = failed
            cuts += 1
            step *= 0.4
            if step < SMALLEST_STEP:
                return frames, status, steps, cuts, iterations
            continue
        velocity = (outcome.x - x) / (target - depth)
        x, depth = outcome.x, target
        system.accept(x)
        if overlap > STIFFEN_AT * system.edge:
            system.stiffen()
        if outcome.iterations <= 6:
            step = min(step * 2.0, LARGEST_STEP)
        elif outcome.iterations > 12:
            step *= 0.7
        if depth >= next_frame - SAME or depth >= scene.depth - SAME:
            frames.append(
                Frame(
                    depth, x, system.report[:3].copy(), system.base_force(), system.tip, max(overlap, 0.0),
                    system.min_jacobian, outcome.residual,
                )
            )  # fmt: skip
            next_frame = depth + scene.frame_spacing
    return frames, Status.CONVERGED, steps, cuts, iterations


def _predict(system: PokeSystem, x: Array, move: Array) -> Array:
    """x carried on along the last motion, as far as no element turns over."""
    part = 1.0
    for _ in range(4):
        trial = x + part * move
        if system.body.energy(trial)[1] > 0.02:
            return trial
        part *= 0.5
    return x.copy()


def _result(scene: Poke, mesh: Mesh, frames: list[Frame], status: Status, cost: Cost) -> Result:
    def stack(values: list[Array], width: tuple[int, ...]) -> Array:
        return np.array(values) if values else np.zeros((0, *width))

    reached = f"{frames[-1].depth * 1e3:.2f}" if frames else "0"
    return Result(
        scene=scene,
        status=status,
        message="" if status is Status.CONVERGED else f"{status.value} after {reached} mm",
        mesh=mesh,
        load=np.array([f.depth for f in frames]),
        positions=stack([f.x for f in frames], (mesh.n_nodes, 3)),
        support_force=stack([f.base_force for f in frames], (3,)),
        rod_force=stack([f.rod_force for f in frames], (3,)),
        rod_tip=stack([f.tip for f in frames], (3,)),
        penetration=np.array([f.penetration for f in frames]),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.residual for f in frames]),
        nominal_stress=np.zeros(len(frames)),
        cost=cost,
    )
