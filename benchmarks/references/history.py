"""A block of 4-node tetrahedra that softens or creeps, pulled and sheared: a common mesh for other codes.

    python -m benchmarks.references.history        # writes history.json beside it, ten seconds

4-node tetrahedra have one point each, so that any code with displacement elements has the same equations: its
answer to the softening block is this one to solver tolerance. psi = mu/2 (I1bar - 3) + K/2 ln^2 J, with

- "softening": FElupe's own `OgdenRoxburgh` on the isochoric part; the largest energy so far is that of the
  frames before;
- "viscosity": finite linear viscoelasticity of the isochoric part (Simo 1987; Holzapfel 2000), integrated by
  exact convolution of piecewise linear stresses in STEPS and twice as many steps a ramp, and extrapolated to
  none. FElupe's own `finite_strain_viscoelastic` is another model (a multiplicative split).

`displacement` (frames, nodes, 3) [m]; `force` (frames, 3) [N] pulls the driven face. Needs the extra `bench`.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.timed.convolution import Memory
from benchmarks.blind.timed.material import Prony
from benchmarks.blind.timed.solve_indentation import ViscousNeoHookean, isochoric
from benchmarks.references.mixed import clock
from benchmarks.whole import write_whole

Array = NDArray[np.float64]
FILE = Path(__file__).with_suffix(".json")
SIDES, CELLS = (0.010, 0.008, 0.006), (3, 2, 2)  # [m]
MU, BULK = 20e3, 400e3
R, M, BETA = 2.0, 1.5e3, 0.2
PRONY = Prony(fractions=(0.4, 0.25), times=(0.5, 8.0))
DIRECTION = np.array([1.0, 0.4, 0.0])
# of the driven face along DIRECTION [m]: a rise, a fall, a further rise, a fall
SOFTENING = np.array([1, 2, 3, 2, 1, 2, 3, 4, 3, 2, 1, 0]) * 1e-3
# (seconds, driven [m]): ramps between
VISCOSITY = ((1.0, 3e-3), (4.0, 3e-3), (2.0, 1e-3), (20.0, 1e-3))
STEPS = 64


def block() -> fe.Mesh:
    """Six tetrahedra a cell; inner nodes off their places."""
    ticks = [np.linspace(0.0, side, n + 1) for side, n in zip(SIDES, CELLS, strict=True)]
    nodes = np.stack(np.meshgrid(*ticks, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange(len(nodes)).reshape([n + 1 for n in CELLS])
    corner = [index[i : CELLS[0] + i, j : CELLS[1] + j, k : CELLS[2] + k].ravel()
              for i in (0, 1) for j in (0, 1) for k in (0, 1)]  # fmt: skip
    paths = ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1))  # around the diagonal from corner 0 to 7
    tets = np.concatenate([np.stack([corner[0], corner[a], corner[b], corner[7]], -1) for a, b in paths])
    inner = ((nodes > 1e-9) & (nodes < np.array(SIDES) - 1e-9)).all(axis=1)
    nodes[inner] += 4e-4 * np.random.default_rng(1).uniform(-1, 1, (int(inner.sum()), 3))
    edges = nodes[tets[:, 1:]] - nodes[tets[:, :1]]
    turned = np.linalg.det(edges) < 0.0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    return fe.Mesh(nodes, tets, "tetra")


class WithVolume(fe.ConstitutiveMaterial):
    """A material with bulk/2 ln^2 J beside it."""

    def __init__(self, material: Any, bulk: float) -> None:
        self.material, self.bulk, self.x = material, bulk, material.x
        self.kwargs: dict[str, float] = {}

    def _gradient(self, x: list[Any]) -> list[Any]:
        P, state = self.material.gradient(x)
        return [P + self.bulk * np.log(fe.math.det(x[0])) * self._inverse(x[0]), state]

    def _hessian(self, x: list[Any]) -> list[Any]:
        H, log = self._inverse(x[0]), np.log(fe.math.det(x[0]))
        A = np.einsum("iJ...,kL...->iJkL...", H, H) - log * np.einsum("iL...,kJ...->iJkL...", H, H)
        return [self.material.hessian(x)[0] + self.bulk * A]

    @staticmethod
    def _inverse(F: Array) -> Array:
        """F^-T."""
        return np.asarray(np.moveaxis(np.linalg.inv(np.moveaxis(F, (0, 1), (-1, -2))), (-2, -1), (0, 1)))


class Block:
    """The block with a law, driven frame by frame."""

    def __init__(self, law: Any) -> None:
        self.mesh = block()
        self.field = fe.FieldContainer([fe.Field(fe.RegionTetra(self.mesh), dim=3)])
        self.solid = fe.SolidBody(WithVolume(law, BULK), self.field)
        x = self.mesh.points[:, 0]
        self.near, self.far = np.flatnonzero(x < 1e-9), np.flatnonzero(x > SIDES[0] - 1e-9)
        dof = np.arange(self.mesh.points.size).reshape(-1, 3)
        self.fixed = np.concatenate([dof[self.near].ravel(), dof[self.far].ravel()])
        self.free = np.setdiff1d(dof.ravel(), self.fixed)

    def drive(self, to: float) -> Array:
        """Equilibrium with the far face moved; its force (3,)."""
        u = self.field[0].values
        given = np.concatenate([np.zeros(3 * len(self.near)), np.tile(to * DIRECTION, len(self.far))])
        for _ in range(30):
            r = self.solid.assemble.vector(self.field).toarray().ravel()
            step = given - u.ravel()[self.fixed]
            if np.abs(step).max() < 1e-15 and np.abs(r[self.free]).max() < 1e-12 * BULK * SIDES[0] ** 2:
                return np.asarray(r.reshape(-1, 3)[self.far].sum(axis=0))
            K = self.solid.assemble.matrix(self.field).toarray()
            move = np.zeros(u.size)
            move[self.fixed] = step
            right = -r[self.free] - K[np.ix_(self.free, self.fixed)] @ step
            move[self.free] = np.linalg.solve(K[np.ix_(self.free, self.free)], right)
            u += move.reshape(u.shape)
        raise RuntimeError(f"block: no equilibrium at {to}")

    def gradient(self) -> Array:
        return np.asarray(self.field.extract()[0])


def softening() -> dict[str, Any]:
    """Frames of the softening block."""
    law = fe.OgdenRoxburgh(fe.NeoHooke(mu=MU), r=R, m=M, beta=BETA)
    test = Block(law)

    def accept() -> None:
        test.solid.results.statevars = test.solid.results._statevars.copy()

    found = _frames(test, SOFTENING, accept)
    return {"r": R, "m": M, "beta": BETA, "driven": SOFTENING.tolist(), **found}


def _frames(test: Block, driven: Array, accept: Callable[[], None]) -> dict[str, Any]:
    forces, moved = [], []
    for to in driven:
        forces.append(test.drive(float(to)))
        accept()
        moved.append(test.field[0].values.copy())
    return {"force": _rounded(np.array(forces)), "displacement": _rounded(np.array(moved))}


def viscosity() -> dict[str, Any]:
    """Ends of the ramps of the viscous block, extrapolated to no time step."""
    coarse, fine = (_viscous(STEPS * k) for k in (1, 2))
    best = [(4.0 * f - c) / 3.0 for c, f in zip(coarse, fine, strict=True)]
    error = float(np.abs(fine[0] - coarse[0]).max() / np.abs(fine[0]).max())
    return {
        "fractions": PRONY.fractions,
        "times": PRONY.times,
        "time": np.cumsum([t for t, _ in VISCOSITY]).tolist(),
        "driven": [d for _, d in VISCOSITY],
        "force": _rounded(best[0]),
        "displacement": _rounded(best[1]),
        "force_change_by_halving_steps": error,
    }


def _viscous(steps: int) -> tuple[Array, Array]:
    law = ViscousNeoHookean(MU)
    test = Block(law)
    memory = Memory(PRONY, (3, 3, *test.gradient().shape[2:]))
    at, forces, moved = 0.0, [], []
    for duration, to in VISCOSITY:
        # a hold's steps grow; a ramp's are even
        part = np.arange(1, steps + 1) / steps
        ends = duration * (part if to != at else part**3)
        now = 0.0
        for end in ends:
            law.scale, test.solid.results.statevars = memory.begin(end - now)
            force = test.drive(at + (to - at) * end / duration)
            memory.accept(MU * isochoric(test.gradient()))
            now = float(end)
        at = to
        forces.append(force)
        moved.append(test.field[0].values.copy())
    return np.array(forces), np.array(moved)


def _rounded(values: Array) -> Any:
    return np.vectorize(lambda v: float(f"{v:.10g}"))(np.where(np.abs(values) < 1e-16, 0.0, values)).tolist()


def main() -> None:
    mesh = block()
    test = Block(fe.NeoHooke(mu=MU))
    found = {
        "about": {
            "units": "m, s, N, Pa; m of softening in J/m3",
            "law": "mu/2 (I1bar - 3) + bulk/2 ln^2 J (tisim: ogden, mu, alpha 2)",
            "mu": MU,
            "bulk": BULK,
            "direction": DIRECTION.tolist(),
            "felupe": fe.__version__,
        },
        "nodes": _rounded(mesh.points),
        "tetrahedra": mesh.cells.tolist(),
        "clamped": test.near.tolist(),
        "driven": test.far.tolist(),
        "softening": softening(),
        "viscosity": viscosity(),
    }
    write_whole(FILE, json.dumps(found) + "\n")
    print(f"{FILE.stat().st_size / 1e3:.0f} kB, {clock():.0f} s")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
