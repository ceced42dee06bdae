"""Homogeneous material tests by finite elements: a cube driven to a sequence of stretches."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tisim.course import Stop
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.mesh import Mesh, boundary_facets
from tisim.nonlinear.newton import Outcome, newton
from tisim.parallel.threads import one_thread
from tisim.problems._registry import OnStep, skip
from tisim.problems._stops import stops_of
from tisim.problems.beam.system import BeamSystem
from tisim.result import Cost, Result, Status
from tisim.scene import Coupon

Array = NDArray[np.float64]

EDGE = 0.010  # of the cube [m]; the stress does not depend on it
# The middle node is off the centre, so that each solution is a patch test.
MIDDLE = (0.45, 0.55, 0.48)
SMALLEST_VOLUME = 1e-2  # det F below which a specimen has collapsed
SMALLEST_PART = 1.0 / 256.0  # smallest fraction of the way from one stretch to the next

# Axes whose far faces are driven to the stretch, and axes held at rest; the others are free.
_DRIVEN = {"uniaxial": (0,), "equibiaxial": (0, 1), "planar": (0,), "simple-shear": ()}
_HELD = {"uniaxial": (), "equibiaxial": (), "planar": (1,), "simple-shear": ()}
# Start value of the free sides at constant volume: the stretch to this power.
_THINNING = {"uniaxial": -0.5, "equibiaxial": -2.0, "planar": -1.0, "simple-shear": 0.0}


@one_thread()
def solve_coupon(scene: Coupon, *, on_step: OnStep = skip) -> Result:
    """Solve a homogeneous test: one frame per stretch, or the frames of the course, until none converges.

    The near faces are on rollers, the far faces of the driven axes are displaced, the other sides are free.
    In mode "planar" y is held; in "simple-shear" the whole boundary is driven to x = X + gamma Z. The
    result's nominal_stress is the force along x on the driven face over its rest area, its support_force the
    force on the opposite face.
    """
    start = time.process_time()
    discretisation = _discretise(scene.mode)
    system = CouponSystem(DiscretisedBody(discretisation, scene.material), tolerance=scene.solver.tolerance)
    x, here = discretisation.mesh.nodes.copy(), 1.0
    frames: list[CouponFrame] = []
    status, steps, cuts = Status.CONVERGED, 0, 0
    stops, now = stops_of(scene), 0.0
    for count, stop in enumerate(stops, start=1):
        outcome, here, tried, failed = _drive(scene, system, x, here, stop.value, stop.time - now)
        steps, cuts, x, now = steps + tried, cuts + failed, outcome.x, stop.time
        if outcome.status is not Status.CONVERGED:
            status = outcome.status
            break
        if stop.frame:
            frames.append(_frame(scene, system, outcome, stop))
        on_step(count / len(stops))
    cost = Cost(
        core_seconds=time.process_time() - start,
        steps=steps,
        newton_iterations=system.counts["newton"],
        factorisations=system.counts["factorisations"],
        step_cuts=cuts,
    )
    return coupon_result(scene, discretisation.mesh, frames, status, here, cost)


@lru_cache(maxsize=4)
def _discretise(mode: str) -> Discretisation:
    """Discretisation of eight hexahedra; rollers and driven faces are held components."""
    mesh = coupon_mesh()
    held = np.zeros((mesh.n_nodes, 3), dtype=bool)
    near, far = mesh.nodes == 0.0, mesh.nodes == EDGE
    if mode == "simple-shear":
        held[(near | far).any(axis=1)] = True
    else:
        held[near] = True
        for axis in _DRIVEN[mode] + _HELD[mode]:
            held[far[:, axis], axis] = True
    return Discretisation.build(mesh, np.zeros(0, dtype=np.int32), held)


def coupon_mesh() -> Mesh:
    ticks = np.array([0.0, 0.5, 1.0])
    nodes = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    nodes[13] = MIDDLE
    index = np.arange(27, dtype=np.int32).reshape(3, 3, 3)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    elements = np.stack([index[i : i + 2, j : j + 2, k : k + 2].ravel() for i, j, k in corners], axis=1)
    return Mesh(
        kind="hex8",
        nodes=EDGE * nodes,
        elements=elements,
        facet_sets={"surface": boundary_facets("hex8", elements)},
    )


class CouponSystem(BeamSystem):
    """A cube driven by its held components, whose values x contains (`tisim.nonlinear.newton.System`)."""

    def linearise(self, x: Array) -> tuple[Array, float]:
        residual, rounding = super().linearise(x)
        discretisation = self.body.discretisation
        force, _ = self.body.internal_forces(x)
        load = float(np.linalg.norm(force[discretisation.pattern.free][discretisation.held]))
        # a floor, since there is no reaction at rest
        return residual, max(load + 1e-6 * self.body.moduli.shear_modulus * EDGE**2, rounding)


def _drive(
    scene: Coupon, system: CouponSystem, x: Array, here: float, target: float, duration: float
) -> tuple[Outcome, float, int, int]:
    """Drive the cube from stretch `here` to `target` in `duration` [s], in steps that are cut if they fail.

    Returns outcome, stretch reached, number of steps tried and number of cuts.
    """
    part, reached, steps, cuts = 1.0, 0.0, 0, 0
    outcome = Outcome(x, Status.CONVERGED, 0.0, 0)
    begin = here
    while reached < 1.0:
        end = min(1.0, reached + part)
        stretch = target if end == 1.0 else begin + end * (target - begin)
        system.body.begin((end - reached) * duration)
        trial = _equilibrium(scene, system, _moved(scene, system, outcome.x, here, stretch))
        steps += 1
        if trial.status is Status.CONVERGED:
            outcome, here, reached = trial, stretch, end
            system.body.accept(outcome.x)
            part *= 2.0
            continue
        part, cuts = 0.5 * part, cuts + 1
        if part < SMALLEST_PART:
            return Outcome(outcome.x, trial.status, trial.residual, trial.iterations), here, steps, cuts
    return outcome, here, steps, cuts


def _moved(scene: Coupon, system: CouponSystem, x: Array, here: float, stretch: float) -> Array:
    """Positions with the driven faces at `stretch` and free sides contracted at constant volume."""
    x = x.copy()
    if scene.mode == "simple-shear":
        x[:, 0] += (stretch - here) * system.body.discretisation.mesh.nodes[:, 2]
        return x
    scale = np.full(3, (stretch / here) ** _THINNING[scene.mode])
    scale[list(_DRIVEN[scene.mode])] = stretch / here
    scale[list(_HELD[scene.mode])] = 1.0
    return x * scale


def _equilibrium(scene: Coupon, system: CouponSystem, x: Array) -> Outcome:
    if system.potential(x)[1] <= 0.0:
        return Outcome(x, Status.INVERTED, np.inf, 0)
    found = newton(system, x, tolerance=scene.solver.tolerance, max_iterations=scene.solver.max_iterations)
    if found.status is Status.CONVERGED and system.potential(found.x)[1] < SMALLEST_VOLUME:
        # a free side whose stress vanishes with its area is no equilibrium
        return Outcome(x, Status.INVERTED, np.inf, found.iterations)
    return found


@dataclass(frozen=True, eq=False)
class CouponFrame:
    time: float
    stretch: float
    dissipated: float
    x: Array
    support: Array
    stress: float
    min_jacobian: float
    residual: float


def _frame(scene: Coupon, system: CouponSystem, outcome: Outcome, stop: Stop) -> CouponFrame:
    nodes = system.body.discretisation.mesh.nodes
    force, min_jacobian = system.body.internal_forces(outcome.x)
    normal = 2 if scene.mode == "simple-shear" else 0
    pull = force[nodes[:, normal] == EDGE].sum(axis=0)
    support = force[nodes[:, normal] == 0.0].sum(axis=0)
    stress, dissipated = pull[0] / EDGE**2, system.body.dissipated()
    return CouponFrame(
        stop.time, stop.value, dissipated, outcome.x, support, stress, min_jacobian, outcome.residual
    )


def coupon_result(
    scene: Coupon, mesh: Mesh, frames: list[CouponFrame], status: Status, here: float, cost: Cost
) -> Result:
    n = len(frames)
    return Result(
        scene=scene,
        status=status,
        message="" if status is Status.CONVERGED else f"no equilibrium beyond stretch {here:.4g}",
        mesh=mesh,
        load=np.array([f.stretch for f in frames]),
        positions=np.array([f.x for f in frames]).reshape(n, mesh.n_nodes, 3),
        support_force=np.array([f.support for f in frames]).reshape(n, 3),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.residual for f in frames]),
        nominal_stress=np.array([f.stress for f in frames]),
        time=None if scene.course is None else np.array([f.time for f in frames]),
        dissipated=np.array([f.dissipated for f in frames]) if scene.material.remembers else None,
        cost=cost,
    )
