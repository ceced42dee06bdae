"""Homogeneous material tests with fibres oblique to the specimen's sides, which shears under tension.

The specimen is a long strip whose grips permit shear: the deformation gradient F is uniform, lines along x
stay along x (F is upper triangular), and the components of the first Piola-Kirchhoff stress that are
conjugate to the free entries of F vanish.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from tisim.material_points import MaterialPoints
from tisim.parallel.threads import one_thread
from tisim.problems._registry import OnStep, skip
from tisim.problems._stops import stops_of
from tisim.problems.homogeneous.solve import (
    EDGE,
    SMALLEST_PART,
    SMALLEST_VOLUME,
    CouponFrame,
    coupon_mesh,
    coupon_result,
)
from tisim.result import Cost, Result, Status
from tisim.scene import Coupon

Array = NDArray[np.float64]

# Entries of F that are prescribed, and those that are free of stress.
_DRIVEN = {"uniaxial": ((0, 0),), "equibiaxial": ((0, 0), (1, 1)), "planar": ((0, 0),)}
_FREE = {
    "uniaxial": ((0, 1), (0, 2), (1, 1), (1, 2), (2, 2)),
    "equibiaxial": ((0, 2), (1, 2), (2, 2)),
    "planar": ((0, 2), (1, 2), (2, 2)),
}


@one_thread()
def solve_oblique(scene: Coupon, *, on_step: OnStep = skip) -> Result:
    """Solve as `solve_coupon`, for a homogeneous deformation with sides free to shear."""
    start = time.process_time()
    mesh = coupon_mesh()
    points = MaterialPoints(scene.material)
    F, status = np.eye(3), Status.CONVERGED
    frames: list[CouponFrame] = []
    stops, now, here = stops_of(scene), 0.0, 1.0
    steps = cuts = iterations = 0
    for count, stop in enumerate(stops, start=1):
        begin, reached, part = here, 0.0, 1.0
        while reached < 1.0:
            end = min(1.0, reached + part)
            stretch = stop.value if end == 1.0 else begin + end * (stop.value - begin)
            points.begin((end - reached) * (stop.time - now))
            found, residual, used = _equilibrium(scene, points, F, stretch)
            steps, iterations = steps + 1, iterations + used
            if found is not None:
                points.accept(found[None])
                F, here, reached, part = found, stretch, end, 2.0 * part
                continue
            part, cuts = 0.5 * part, cuts + 1
            if part < SMALLEST_PART:
                status = Status.NOT_CONVERGED
                break
        if status is not Status.CONVERGED:
            break
        now = stop.time
        if stop.frame:
            P = points.evaluate(F[None])[1][0]
            lost = float(points.dissipated[0]) * EDGE**3
            x, support = mesh.nodes @ F.T, -P[:, 0] * EDGE**2
            volume = float(np.linalg.det(F))
            frames.append(CouponFrame(now, stop.value, lost, x, support, float(P[0, 0]), volume, residual))
        on_step(count / len(stops))
    cost = Cost(
        core_seconds=time.process_time() - start, steps=steps, newton_iterations=iterations, step_cuts=cuts
    )
    return coupon_result(scene, mesh, frames, status, here, cost)


def _equilibrium(
    scene: Coupon, points: MaterialPoints, F: Array, stretch: float
) -> tuple[Array | None, float, int]:
    """F with the driven entries at the stretch, or None; residual relative to the stress; iterations."""
    rows, columns = (list(v) for v in zip(*_FREE[scene.mode], strict=True))
    F = F.copy()
    grown = stretch / F[0, 0]
    for i, k in _DRIVEN[scene.mode]:
        F[i, k] = stretch
    # start value of constant volume
    thin = {"uniaxial": -0.5, "equibiaxial": -2.0, "planar": -1.0}[scene.mode]
    for i, k in _FREE[scene.mode]:
        if i == k:
            F[i, k] *= grown**thin
    residual = np.inf
    for iteration in range(scene.solver.max_iterations + 1):
        if not np.linalg.det(F) > SMALLEST_VOLUME:
            return None, residual, iteration
        _, (P,), (A,) = points.evaluate(F[None])
        free = P[rows, columns]
        # at rest there is no stress to compare with
        size = float(np.linalg.norm(P)) + 1e-6 * points.shear_modulus
        residual = float(np.linalg.norm(free)) / size
        if not np.isfinite(residual):
            return None, residual, iteration
        if residual <= scene.solver.tolerance:
            return F, residual, iteration
        try:
            step = np.linalg.solve(A[rows, columns][:, rows, columns], -free)
        except np.linalg.LinAlgError:
            return None, residual, iteration
        F = F.copy()
        F[rows, columns] += step
    return None, residual, scene.solver.max_iterations
