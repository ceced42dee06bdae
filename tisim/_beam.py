"""Static beams: structured mesh, Newton at full load from the rod's shape, load steps where that fails."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim._body import Body, Layout, gravity_load
from tisim._mass import facet_mass
from tisim._newton import Outcome, newton
from tisim._quadrature import facet_load
from tisim._rod_theory import planar_rod
from tisim._specimen import is_ideal
from tisim.mesh import Mesh
from tisim.mesh.beam import beam_mesh
from tisim.result import Cost, Result, Status
from tisim.scene import Beam, Circle

Array = NDArray[np.float64]

# Part of the forces in imperfect clamps that counts as load: they are many and cancel, their sum is small.
CLAMPS_PART = 0.01


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A solved candidate to start the next one from: its layout, positions, rod shape and pressures."""

    layout: Layout
    x: Array
    rod: Array
    pressure: Array


def solve_beam(scene: Beam) -> Result:
    """Equilibrium of a beam. The result has one frame, at load 1."""
    return next(solve_beams([scene]))


def solve_beams(scenes: Sequence[Beam]) -> Iterator[Result]:
    """Equilibria of beams one after the other, each started from the one before on the same mesh."""
    neighbour: Neighbour | None = None
    for scene in scenes:
        mesh_start = time.process_time()
        layout = beam_layout(scene)
        mesh_seconds = time.process_time() - mesh_start
        start = time.process_time()
        if is_ideal(scene):
            system = beam_system(scene, layout)
            outcome, counts, neighbour = equilibrium(scene, system, neighbour)
            reached = f"{system.factor:.3g} of the load"
        else:
            from tisim._imperfect import imperfect_equilibrium  # which is built on what stands here

            found = imperfect_equilibrium(scene, layout, neighbour)
            system, outcome, counts, neighbour = found.system, found.outcome, found.counts, found.neighbour
            reached = f"{found.part:.3g} of the imperfections"
        yield _result(scene, system, outcome, counts, reached, mesh_seconds, time.process_time() - start)


def beam_layout(scene: Beam) -> Layout:
    """Mesh, numbering and symbolic factor of a beam; kept for the next candidate on the same mesh."""
    if scene.mesh is not None:
        return _own_layout(scene.mesh)
    return _structured_layout(
        scene.length, scene.section, scene.supports, scene.element, scene.layer, scene.rings, _planar(scene)
    )


@lru_cache(maxsize=16)
def _structured_layout(
    length: float, section: Any, supports: Any, element: str, layer: float, rings: int, mirror: bool
) -> Layout:
    kind: Any = "tet10" if element == "default" else element
    return _layout(
        beam_mesh(
            length=length,
            section=section,
            supports=supports,
            kind=kind,
            layer=layer,
            rings=rings,
            mirror=mirror,
        )
    )


@lru_cache(maxsize=16)
def _own_layout(mesh: Mesh) -> Layout:
    if "clamp" not in mesh.node_sets:
        raise ValueError("beam mesh: expected a node set 'clamp'")
    return _layout(mesh)


def _layout(mesh: Mesh) -> Layout:
    fixed = np.concatenate([mesh.node_sets[k] for k in ("clamp", "far_clamp") if k in mesh.node_sets])
    return Layout.build(mesh, np.unique(fixed))


def _planar(scene: Beam) -> bool:
    """Whether all loads lie in the mirror plane y = 0, so that half a beam is enough."""
    return scene.gravity[1] == 0.0 and scene.tip_force[1] == 0.0


class BeamSystem:
    """A beam under a part `factor` of its load (see `tisim._newton.System`).

    tolerance: what the residual will be asked to reach, relative to the load. Where rounding is more than
    that (stiffness times the last digit of the positions: thin beams, nearly incompressible), `linearise`
    returns the load that makes it just reachable.
    """

    def __init__(self, body: Body, *, tolerance: float = 1e-6) -> None:
        self.body = body
        self.tolerance = tolerance
        self.full_load = body.dead_load
        self.factor = 1.0
        self.step_limit = np.inf
        self.clamps_load = (
            False  # whether clamps strain the body, so that equilibrium has a scale without load
        )
        self.counts = {"factorisations": 0, "newton": 0}
        self._blocks: Array | None = None
        self._pressure: Array | None = None

    def free_pressures(self, start: Array | None) -> None:
        """Iterate the element pressures as unknowns, from `start` (m,) [Pa], without a line search.

        None: back to pressures that follow the positions.

        A step that is right to first order leaves an error in volume of second order; the potential
        punishes it by the bulk modulus and would cut the step, the mixed iteration does not see it.
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
        layout = self.body.layout
        self._blocks, force, min_jacobian = self.body.stiffness(x, self._pressure)
        self.counts["newton"] += 1
        residual = (force - self.body.dead_load)[layout.pattern.free]
        residual[layout.held] = 0.0
        if min_jacobian <= 0.0:
            residual[:] = np.nan
        load = self.load_norm()
        if self.clamps_load:
            held = (force - self.body.dead_load)[layout.fixed]
            load = max(load, CLAMPS_PART * float(np.linalg.norm(held)))
        return residual, max(load, self._rounding(x) / self.tolerance)

    def load_norm(self) -> float:
        """Size of the load at the free nodes [N]."""
        return float(np.linalg.norm(self.body.dead_load[self.body.layout.pattern.free]))

    def _rounding(self, x: Array) -> float:
        """Size of the residual that rounding the positions makes [N]; 2 to 3 times what is measured."""
        assert self._blocks is not None
        diagonal = self._blocks[self.body.layout.pattern.indptr[:-1]][:, [0, 1, 2], [0, 1, 2]]
        return 0.5 * float(np.finfo(float).eps * np.linalg.norm(diagonal) * np.abs(x).max())

    def step(self, residual: Array, *, forcing: float) -> Array:  # noqa: ARG002 - the solve is exact
        layout = self.body.layout
        assert self._blocks is not None
        layout.hold(self._blocks)
        diagonal = layout.pattern.indptr[:-1]
        scale = float(np.abs(self._blocks[diagonal][:, [0, 1, 2], [0, 1, 2]]).mean())
        shift = 0.0
        for attempt in range(12):
            layout.solver.factorise(self._blocks)
            self.counts["factorisations"] += 1
            step = layout.solver.solve(-residual)
            if layout.solver.negative == 0 and np.vdot(step, residual) < 0.0:
                return step
            # indefinite: shift the spectrum until the step goes downhill
            more = scale * 1e-4 * 4.0**attempt
            self._blocks[diagonal] += (more - shift) * np.eye(3)
            shift = more
        return -residual / scale

    def second_step(self, residual: Array) -> Array | None:  # noqa: ARG002
        return None

    def advance(self, x: Array, step: Array) -> Array:
        moved = x.copy()
        moved[self.body.layout.pattern.free] += step
        if self._pressure is not None:
            self._pressure = self.body.pressures(x, moved - x)
        return moved

    def residual_norm(self, x: Array) -> float:
        layout = self.body.layout
        residual = (self.body.internal_forces(x)[0] - self.body.dead_load)[layout.pattern.free]
        residual[layout.held] = 0.0
        return float(np.linalg.norm(residual))

    def largest_step(self) -> float:
        return self.step_limit


def beam_system(scene: Beam, layout: Layout) -> BeamSystem:
    """Material and loads of a beam on its layout."""
    load = gravity_load(layout, scene.material.density, scene.gravity)
    mass = np.zeros(layout.mesh.n_nodes)
    if any(scene.tip_force) or scene.tip_mass:
        if "tip" not in layout.mesh.facet_sets:
            raise ValueError("beam: a tip force needs a free end (mesh facet set 'tip'), as a tip mass does")
        facets = layout.mesh.facet_sets["tip"]
        share = facet_load(layout.mesh, facets)
        load += share[:, None] / share.sum() * np.asarray(scene.tip_force) / layout.multiplicity
        mass += facet_mass(layout.mesh, facets, scene.tip_mass / layout.multiplicity)
    body = Body(layout, scene.material, dead_load=load, added_mass=mass)
    return BeamSystem(body, tolerance=scene.solver.tolerance)


def equilibrium(
    scene: Beam, system: BeamSystem, neighbour: Neighbour | None = None
) -> tuple[Outcome, dict[str, int], Neighbour | None]:
    """Full load from a neighbour's or the rod's shape; else from rest with adaptive load steps.

    A neighbour on the same layout is moved on by what rod theory says of the change, and its pressures
    are kept: 3.2 to 3.8 linearisations against 4.3 to 4.6 from the rod's shape alone, over designs
    within a factor of 1.35 to 3.3 of their centre in stiffness and in K/mu.
    """
    layout = system.body.layout
    if not system.full_load.any():
        return Outcome(layout.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0), {"steps": 1, "cuts": 0}, None
    rod = rod_shape(scene, system.body)
    if rod is not None:
        # the rod's shape is right in shape, not in volume: its pressures would be wrong by far
        starts = [(rod, np.zeros(layout.mesh.n_elements))]
        if neighbour is not None and neighbour.layout is layout:
            moved = neighbour.x + (rod - neighbour.rod)
            moved[layout.fixed] = layout.mesh.nodes[layout.fixed]  # an imperfect neighbour's stand elsewhere
            starts.insert(0, (moved, neighbour.pressure))
        for guess, pressure in starts:
            if system.potential(guess)[1] > 0.0:
                outcome = _mixed_newton(scene, system, guess, pressure)
                if outcome.status is Status.CONVERGED:
                    found = Neighbour(layout, outcome.x, rod, system.body.pressures(outcome.x))
                    return outcome, {"steps": 1, "cuts": 0}, found
    return *_load_steps(scene, system), None


def _mixed_newton(scene: Beam, system: BeamSystem, x: Array, pressure: Array) -> Outcome:
    """Newton with the element pressures as unknowns; quick or not at all."""
    options = scene.solver
    system.free_pressures(pressure)
    outcome = newton(system, x, tolerance=options.tolerance, max_iterations=min(15, options.max_iterations))
    system.free_pressures(None)
    return outcome


def _load_steps(scene: Beam, system: BeamSystem) -> tuple[Outcome, dict[str, int]]:
    """From rest; a step that fails with free pressures is tried once more on the potential, then halved."""
    options, body = scene.solver, system.body
    counts = {"steps": 0, "cuts": 0}
    outcome = Outcome(body.layout.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0)
    reached, step = 0.0, 0.25
    system.step_limit = 0.2 * scene.length
    while reached < 1.0:
        factor = min(1.0, reached + step)
        system.set_factor(factor)
        trial = _mixed_newton(scene, system, outcome.x, body.pressures(outcome.x))
        if trial.status is not Status.CONVERGED:
            trial = newton(
                system, outcome.x, tolerance=options.tolerance, max_iterations=options.max_iterations
            )
        counts["steps"] += 1
        if trial.status is Status.CONVERGED:
            outcome, reached = trial, factor
            step *= 2.0 if trial.iterations < 8 else 1.0
            continue
        step *= 0.5
        counts["cuts"] += 1
        if step < 1.0 / 512.0:
            system.set_factor(reached)
            return Outcome(outcome.x, trial.status, trial.residual, trial.iterations), counts
    return outcome, counts


def rod_shape(scene: Beam, body: Body) -> Array | None:
    """Node positions of the beam bent as a planar rod; None where rod theory has nothing to say."""
    section = scene.section
    if isinstance(section, Circle):
        area, inertia = np.pi * section.radius**2, np.pi * section.radius**4 / 4.0
    else:
        area = section.width * section.height
        inertia = None
    line = scene.material.density * area * np.asarray(scene.gravity, dtype=float)
    tip = np.asarray(scene.tip_force, dtype=float)
    across = (line * scene.length + tip) * np.array([0.0, 1.0, 1.0])
    size = float(np.linalg.norm(across))
    e2 = across / size if size > 0 else np.array([0.0, 0.0, 1.0])
    if inertia is None:
        if abs(e2[1]) > 1e-12 and abs(e2[2]) > 1e-12:
            return None  # a rectangle bent off its principal planes leaves the plane of the load
        b, h = (section.width, section.height) if abs(e2[2]) > 0.5 else (section.height, section.width)  # type: ignore[union-attr]
        inertia = b * h**3 / 12.0
    g, k = body.moduli.shear, body.moduli.bulk
    young = 9.0 * k * g / (3.0 * k + g)
    s, r, theta = planar_rod(
        length=scene.length,
        bending=young * inertia,
        stretching=young * area,
        line_load=(float(line[0]), float(line @ e2)),
        tip_force=(float(tip[0]), float(tip @ e2)),
        clamped_end=scene.supports == "clamped-clamped",
    )
    rest = body.layout.mesh.nodes
    t = np.clip(rest[:, 0], 0.0, scene.length)
    e3 = np.cross([1.0, 0.0, 0.0], e2)
    offset, side = rest @ e2, rest @ e3
    angle = np.interp(t, s, theta)
    x1 = np.interp(t, s, r[:, 0]) - offset * np.sin(angle) + (rest[:, 0] - t)
    x2 = np.interp(t, s, r[:, 1]) + offset * np.cos(angle)
    x = x1[:, None] * np.array([1.0, 0.0, 0.0]) + x2[:, None] * e2 + side[:, None] * e3
    x[body.layout.fixed] = rest[body.layout.fixed]
    for axis in body.layout.mesh.symmetry:
        nodes = body.layout.mesh.node_sets[f"mirror_{axis}"]
        x[nodes, "xyz".index(axis)] = rest[nodes, "xyz".index(axis)]
    return x


def _result(
    scene: Beam,
    system: BeamSystem,
    outcome: Outcome,
    counts: dict[str, int],
    reached: str,
    mesh_s: float,
    core_s: float,
) -> Result:
    body = system.body
    force, min_jacobian = body.internal_forces(outcome.x)
    support = force[body.layout.fixed].sum(axis=0) - body.dead_load[body.layout.fixed].sum(axis=0)
    support *= body.layout.multiplicity
    for axis in body.layout.mesh.symmetry:
        support["xyz".index(axis)] = 0.0
    done = outcome.status is Status.CONVERGED
    load = system.load_norm()
    residual = system.residual_norm(outcome.x) / load if load > 0.0 else outcome.residual
    return Result(
        scene=scene,
        status=outcome.status,
        message="" if done else f"no equilibrium found beyond {reached} ({outcome.status.value})",
        mesh=body.layout.mesh,
        load=np.array([1.0]) if done else np.zeros(0),
        positions=outcome.x[None] if done else np.zeros((0, *outcome.x.shape)),
        support_force=support[None] if done else np.zeros((0, 3)),
        rod_force=np.zeros((int(done), 3)),
        rod_tip=np.zeros((int(done), 3)),
        penetration=np.zeros(int(done)),
        min_jacobian=np.full(int(done), min_jacobian),
        residual=np.full(int(done), residual),
        nominal_stress=np.zeros(int(done)),
        cost=Cost(
            core_seconds=core_s,
            mesh_seconds=mesh_s,
            steps=counts["steps"],
            newton_iterations=system.counts["newton"],
            factorisations=system.counts["factorisations"],
            step_cuts=counts["cuts"],
        ),
    )
