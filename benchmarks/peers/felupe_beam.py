"""FElupe as a peer: one static solve of a tetrahedral mesh under gravity, PARDISO by pypardiso; SI units.

Plain displacement elements, 4 or 10 nodes: at K/mu of 100 and more the 4-node ones lock. Laws:
    neo_hookean   mu/2 (I1 - 3) - mu ln J + lam/2 ln^2 J (FElupe's NeoHookeCompressible), lam = K - 2 mu/3
    ogden         sum mu_p/alpha_p (sum lbar^alpha_p - 3) + K/2 ln^2 J; FElupe's own needs tensortrax, so
                  this is references/laws.py: NumPy, by eigenvalues of C
    mooney_rivlin C10 (I1bar - 3) + C01 (I2bar - 3) + K/2 ln^2 J, as Ogden with exponents 2 and -2
The time is this process's CPU time from mesh to equilibrium, assembly and factorisations included, imports
not. Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1 before Python starts.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import felupe as fe
import numpy as np
import pypardiso

from benchmarks.references.laws import OgdenIsochoric

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Result:
    """displacement [m], reaction [N] a node (zero where free), CPU seconds, Newton steps taken."""

    displacement: Array
    reaction: Array
    cpu_seconds: float
    converged: bool
    iterations: int


def material(law: str, bulk: float, **p: Any) -> Any:
    """FElupe law; moduli in Pa."""
    if law == "neo_hookean":
        return fe.NeoHookeCompressible(mu=p["mu"], lmbda=bulk - 2 * p["mu"] / 3)
    if law == "ogden":
        return OgdenIsochoric(p["mu"], p["alpha"], bulk)
    if law == "mooney_rivlin":
        return OgdenIsochoric((2 * p["C10"], -2 * p["C01"]), (2.0, -2.0), bulk)
    raise ValueError(f"no law called {law} here")


def body(points: Array, cells: Array, umat: Any) -> tuple[fe.FieldContainer, fe.SolidBody]:
    """Displacement field and solid of a mesh of 4- or 10-node tetrahedra."""
    if cells.shape[1] == 4:
        region: Any = fe.RegionTetra(fe.Mesh(points, cells, "tetra"))
    else:
        region = fe.RegionQuadraticTetra(fe.Mesh(points, cells, "tetra10"))
    field = fe.FieldContainer([fe.Field(region, dim=3)])
    return field, fe.SolidBody(umat, field)


def solve(
    points: Array,
    cells: Array,
    umat: Any,
    fixed: Array,
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81),
    density: float = 1000.0,
    increments: int = 5,
    tolerance: float = 1e-6,
) -> Result:
    """Equilibrium with the nodes `fixed` held, load in equal steps (halved where Newton fails).

    tolerance: residual on the free degrees of freedom over the reaction, as `felupe.newtonraphson` has it.
    """
    start = time.process_time()
    field, solid = body(points, cells, umat)
    load = fe.SolidBodyForce(field)
    held = np.zeros(len(points), dtype=bool)
    held[fixed] = True
    grip = fe.Boundary(field[0], mask=np.repeat(held[:, None], 3, axis=1))
    dof0, dof1 = fe.dof.partition(field, {"grip": grip})
    at, step, iterations = 0.0, 1.0 / increments, 0
    residual = np.zeros((len(points), 3))
    while at < 1 - 1e-12:
        before = field[0].values.copy()
        level = min(at + step, 1.0)
        load.update(density * level * np.asarray(gravity))
        try:
            with np.errstate(all="ignore"):
                result = fe.newtonraphson(
                    items=[solid, load],
                    x0=field,
                    dof0=dof0,
                    dof1=dof1,
                    ext0=np.zeros(len(dof0)),
                    tol=tolerance,
                    solver=pypardiso.spsolve,
                    verbose=0,
                    maxiter=16,
                )
        except ValueError:
            field[0].values[:] = before
            step /= 2
            iterations += 16
            if step < 1e-3:
                return Result(before, residual, time.process_time() - start, False, iterations)
            continue
        iterations += result.iterations
        residual = np.asarray(result.fun).reshape(-1, 3)
        at = level
    reaction = np.where(held[:, None], residual, 0.0)
    return Result(field[0].values.copy(), reaction, time.process_time() - start, True, iterations)
