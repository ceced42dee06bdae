"""Force of a rod on a viscous layer over a course, by axisymmetric finite elements on FElupe.

    python -m benchmarks.blind.timed.solve_indentation checks         # a sphere on a half-space, and others
    python -m benchmarks.blind.timed.solve_indentation seeds 0 1 2    # the indentations of these seeds

Both add what is missing to `indentation.json`; ten seconds of CPU an indentation. 9-node quadrilaterals with
discontinuous pressure, Neo-Hookean with a Prony series, K/G = 300 unless the layer says otherwise; a disc of
`Layer.side` stands for the block. Penalty contact with Coulomb friction, four times as stiff as that of
`benchmarks.blind.indentation.make_table`: forces 0.3 % below those of a rigid contact. Forces are over the
long-time shear modulus [m2]. Needs the extra `bench`.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import felupe as fe
import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.timed.cases import pushes_of
from benchmarks.blind.timed.convolution import Memory, step_times
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.indentation import CHECKS, Layer, Push, load, save
from benchmarks.blind.timed.material import Prony
from benchmarks.references.laws import log_volumetric
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.references.quadrilaterals import quadrilaterals, with_middles
from benchmarks.references.rod import FlatRod

Array = NDArray[np.float64]
MU, PENALTY, SOFT = 30e3, 2.4e10, 2.5e-6
ITERATIONS, SHORTEST = 14, 1.0 / 64.0  # of Newton's method; the shortest part of a step that is tried
STEPS_A_RAMP, GROWTH = 14, 0.35
TINY = 1e-10  # travel of the rod by which its push is differentiated [m]


class ViscousNeoHookean(fe.ConstitutiveMaterial):
    """scale mu/2 (I1bar - 3) + H : C/2, H in the place of the state variables; mu in Pa."""

    def __init__(self, mu: float) -> None:
        self.isochoric, self.scale = fe.NeoHooke(mu=mu), 1.0
        self.kwargs = {"mu": mu}
        self.x = [np.eye(3), np.zeros((3, 3))]

    def _gradient(self, x: list[Any]) -> list[Any]:
        F, history = x[0], x[-1]
        P = self.scale * self.isochoric.gradient([F, None])[0]
        return [P + np.einsum("iJ...,JL...->iL...", F, history), history]

    def _hessian(self, x: list[Any]) -> list[Any]:
        F, history = x[0], x[-1]
        A = self.scale * self.isochoric.hessian([F, None])[0]
        return [A + np.einsum("ik,JL...->iJkL...", np.eye(3), history)]


def isochoric(F: Array) -> Array:
    """S_iso of mu/2 (I1bar - 3), over mu; F (3, 3, ...)."""
    C = np.einsum("kI...,kJ...->...IJ", F, F)
    trace = np.trace(C, axis1=-2, axis2=-1)[..., None, None]
    scale = np.linalg.det(C)[..., None, None] ** (-1 / 3)
    return np.asarray(np.moveaxis(scale * (np.eye(3) - trace / 3 * np.linalg.inv(C)), (-2, -1), (0, 1)))


def meridian(s: Layer) -> fe.Mesh:
    """(axial, radial) [m], fine at the top in the `fine` radius, 9-node quadrilaterals."""
    h = s.fine / s.elements
    r = np.concatenate(
        [np.linspace(0.0, 1.5 * s.fine, round(1.5 * s.elements) + 1), _spread(1.5 * s.fine, s.side, h)]
    )
    down = np.concatenate([[0.0], _spread(0.0, s.height, h / 1.3)])
    z = (s.height - down)[::-1]
    z[0] = 0.0
    return quadrilaterals(with_middles(z), with_middles(r))


def _spread(start: float, end: float, last: float) -> Array:
    """Corners beyond start, each interval longer by 1.3 than the one before."""
    sizes = [1.3 * last]
    while sum(sizes) < end - start:
        sizes.append(1.3 * sizes[-1])
    return np.asarray(start + (end - start) * np.cumsum(sizes) / sum(sizes))


class Indentation:
    """A rod on a layer, step after step in time."""

    def __init__(self, layer: Layer, prony: Prony) -> None:
        mesh = meridian(layer)
        self.field = mixed_fields(fe.RegionBiQuadraticQuad(mesh), axisymmetric=True)
        z, r = mesh.points.T
        dof = np.arange(2 * mesh.npoints).reshape(-1, 2)
        fixed = np.unique(np.concatenate([dof[z < 1e-12].ravel(), dof[r < 1e-12, 1]]))
        top = np.flatnonzero(z > layer.height - 1e-12)
        top = top[np.argsort(r[top])]
        top = top[r[top] < 2.5 * max(layer.fine, layer.rod * (layer.tip == "flat"))]
        top = top[: len(top) - 1 + len(top) % 2]
        edges = np.stack([top[:-2:2], top[2::2], top[1:-1:2]], -1)
        edge = layer.rod * (0.4 if layer.tip == "flat" else 1.0)
        self.rod = FlatRod(
            mesh,
            edges,
            layer.height,
            layer.rod,
            edge,
            layer.friction,
            layer.penalty * PENALTY,
            SOFT / layer.penalty,
        )
        self.law = ViscousNeoHookean(MU)
        zero = np.zeros(self.field[0].values.size)
        self.model = MixedModel(
            self.field,
            log_volumetric(self.law, layer.bulk_ratio * MU),
            fixed,
            lambda _: zero,
            tolerance=1e-6,
            contact=self.rod,
        )
        self.memory = Memory(prony, self._stress().shape)
        self._before: tuple[float, list[Any]] | None = None
        self._depth = 0.0

    def _stress(self) -> Array:
        return MU * isochoric(self.field.extract()[0])

    def turn(self) -> None:
        """A piece of the course ended: the next step does not go on as the last one."""
        self._before = None

    def step(self, dt: float, depth: float) -> bool:
        """To a depth [m] in dt [s]; a step that fails leaves nothing behind.

        Newton starts from the last step continued, or from the tangent with all contacts kept.
        """
        here = self.model.state()
        self.law.scale, self.model.solid.results.statevars = self.memory.begin(dt)
        for start in (self._continued, self._linear):
            if not start(here, dt, depth):
                continue
            if self.model.newton(depth, ITERATIONS):
                self.memory.accept(self._stress())
                self.rod.accept(self.field[0].values, depth)
                self._before, self._depth = (dt, here), depth
                return True
            self.model.restore(here)
        return False

    def _continued(self, here: list[Any], dt: float, _: float) -> bool:
        if self._before is None or dt == 0.0:
            return False
        ratio = dt / self._before[0]
        self.model.restore([h + ratio * (h - p) for h, p in zip(here, self._before[1], strict=True)])
        return True

    def _linear(self, here: list[Any], _: float, depth: float) -> bool:
        u = self.field[0].values
        pushed, stiffness = self.rod.assemble(u, self._depth)
        ahead, _ = self.rod.assemble(u, self._depth + TINY)
        r = self.model.solid.assemble.vector(self.field).toarray().ravel()
        r[: self.model.nu] += pushed + (depth - self._depth) / TINY * (ahead - pushed)
        K = self.model.solid.assemble.matrix(self.field).tocsr()
        stiffness.resize(K.shape)
        moves = self.model._direction(K + stiffness, r, np.zeros(len(self.model.fixed)))
        if not all(np.isfinite(m).all() for m in moves):
            return False
        self.model.restore([h + m.reshape(h.shape) for h, m in zip(here, moves, strict=True)])
        return True


def force(
    layer: Layer, prony: Prony, course: Course, *, finer: float = 1.0
) -> tuple[list[float], list[float]]:
    """Times [s] and forces over the long-time modulus [m2], at the ends of all time steps.

    finer: divides the time steps.
    """
    test = Indentation(layer, prony)
    corner_times, _ = course.corners()
    times, forces = [0.0], [0.0]
    for begin, end in itertools.pairwise(corner_times):
        test.turn()
        ramp = course.value(begin) != course.value(end)
        part = np.arange(1, round(STEPS_A_RAMP * finer) + 1) / round(STEPS_A_RAMP * finer)
        if ramp:  # finer where the contact begins
            stops = begin + (end - begin) * (part**1.5 if course.value(begin) == 0.0 else part)
        else:
            shortest = float(prony.tau.min()) if len(prony.times) else end - begin
            stops = begin + step_times(np.array([end - begin]), shortest, GROWTH / finer)
        for stop in stops:
            _reach(test, times[-1], float(stop), course)
            times.append(float(stop))
            forces.append(max(test.rod.force, 0.0) / MU)
            print(
                f"  {stop:.4g} s: {1e3 * course.value(stop):.4g} mm, {1e6 * forces[-1]:.5g} mm2, "
                f"{test.model.solves} solves, {clock():.0f} s",
                flush=True,
            )
    return times, [float(f"{f:.7g}") for f in forces]


def _reach(test: Indentation, now: float, end: float, course: Course) -> None:
    part, whole = 1.0, end - now
    while now < end:
        to = min(now + part * whole, end)
        if end - to < 1e-9 * whole:
            to = end
        if test.step(to - now, float(course.value(to))):
            now = to
            continue
        part *= 0.5
        if part < SHORTEST:
            raise RuntimeError(f"indentation: no equilibrium at {to:.4g} s")


def add(pushes: dict[str, Push]) -> None:
    """Solve what the store does not have yet."""
    for name, push in pushes.items():
        found = load()
        if name in found:
            continue
        print(name, flush=True)
        times, forces = force(push.layer, push.prony, push.course, finer=push.finer)
        found[name] = {"push": asdict(push), "time": [float(f"{t:.9g}") for t in times], "force": forces}
        save(found)


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("checks", "seeds"))
    parser.add_argument("seed", nargs="*", type=int)
    parser.add_argument("--only", default="", help="names that hold this")
    given = parser.parse_args(argv)
    if given.what == "checks":
        add({name: push for name, push in CHECKS.items() if given.only in name})
        return
    for seed in given.seed:
        add({name: push for name, push in pushes_of(seed).items() if given.only in name})


if __name__ == "__main__":
    main()
