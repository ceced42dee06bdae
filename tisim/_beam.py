"""Static beams: structured mesh, start from the rod theory, Newton at full load, load steps where that fails."""

from __future__ import annotations

import time
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim._body import Body, Layout, gravity_load
from tisim._newton import Outcome, newton
from tisim._quadrature import facet_load
from tisim._rod_theory import planar_rod
from tisim.mesh import Mesh
from tisim.mesh.beam import beam_mesh
from tisim.result import Cost, Result, Status
from tisim.scene import Beam, Circle

Array = NDArray[np.float64]


def solve_beam(scene: Beam) -> Result:
    """Equilibrium of a beam. The result has one frame, at load 1."""
    mesh_start = time.process_time()
    layout = beam_layout(scene)
    mesh_seconds = time.process_time() - mesh_start
    start = time.process_time()
    system = beam_system(scene, layout)
    outcome, counts = equilibrium(scene, system)
    return _result(scene, system, outcome, counts, mesh_seconds, time.process_time() - start)


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
    """A beam under a part `factor` of its load (see `tisim._newton.System`)."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self.full_load = body.dead_load
        self.factor = 1.0
        self.step_limit = np.inf
        self.counts = {"factorisations": 0, "newton": 0}
        self._blocks: Array | None = None
        self._pressure: Array | None = None

    def free_pressures(self, free: bool) -> None:
        """Iterate the element pressures as unknowns of their own, from zero, without a line search.

        A step that is right to first order leaves an error in volume of second order; the potential
        punishes it by the bulk modulus and would cut the step, the mixed iteration does not see it.
        """
        self._pressure = np.zeros(self.body.layout.mesh.n_elements) if free else None

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
        return residual, float(np.linalg.norm(self.body.dead_load[layout.pattern.free]))

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
    if any(scene.tip_force):
        if "tip" not in layout.mesh.facet_sets:
            raise ValueError("beam: a tip force needs a free end (mesh facet set 'tip')")
        share = facet_load(layout.mesh, layout.mesh.facet_sets["tip"])
        load += share[:, None] / share.sum() * np.asarray(scene.tip_force) / layout.multiplicity
    return BeamSystem(Body(layout, scene.material, dead_load=load))


def equilibrium(scene: Beam, system: BeamSystem) -> tuple[Outcome, dict[str, int]]:
    """Full load from the rod's shape; else from rest with adaptive load steps."""
    options = scene.solver
    rest = system.body.layout.mesh.nodes
    counts = {"steps": 1, "cuts": 0}
    if not system.full_load.any():
        return Outcome(rest.copy(), Status.CONVERGED, 0.0, 0), counts
    guess = rod_shape(scene, system.body)
    if guess is not None and system.potential(guess)[1] > 0.0:
        system.free_pressures(True)
        outcome = newton(
            system, guess, tolerance=options.tolerance, max_iterations=min(15, options.max_iterations)
        )
        system.free_pressures(False)
        if outcome.status is Status.CONVERGED:
            return outcome, counts
    x, reached, step = rest.copy(), 0.0, 0.25
    system.step_limit = 0.02
    while reached < 1.0:
        factor = min(1.0, reached + step)
        system.set_factor(factor)
        outcome = newton(
            system, x, tolerance=options.tolerance, max_iterations=options.max_iterations
        )
        counts["steps"] += 1
        if outcome.status is Status.CONVERGED:
            x, reached = outcome.x, factor
            step *= 2.0 if outcome.iterations < 8 else 1.0
        else:
            step *= 0.5
            counts["cuts"] += 1
            if step < 1.0 / 512.0:
                return Outcome(x, outcome.status, outcome.residual, outcome.iterations), counts
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
    scene: Beam, system: BeamSystem, outcome: Outcome, counts: dict[str, int], mesh_s: float, core_s: float
) -> Result:
    body = system.body
    force, min_jacobian = body.internal_forces(outcome.x)
    support = force[body.layout.fixed].sum(axis=0) - body.dead_load[body.layout.fixed].sum(axis=0)
    support *= body.layout.multiplicity
    for axis in body.layout.mesh.symmetry:
        support["xyz".index(axis)] = 0.0
    done = outcome.status is Status.CONVERGED
    return Result(
        scene=scene,
        status=outcome.status,
        message="" if done else f"stopped at {system.factor:.3g} of the load, residual {outcome.residual:.1e}",
        mesh=body.layout.mesh,
        load=np.array([1.0]) if done else np.zeros(0),
        positions=outcome.x[None] if done else np.zeros((0, *outcome.x.shape)),
        support_force=support[None] if done else np.zeros((0, 3)),
        rod_force=np.zeros((int(done), 3)),
        rod_tip=np.zeros((int(done), 3)),
        penetration=np.zeros(int(done)),
        min_jacobian=np.full(int(done), min_jacobian),
        residual=np.full(int(done), outcome.residual),
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
