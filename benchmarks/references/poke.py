"""Reference force of a normal poke, by FElupe on an axisymmetric model; writes poke.json beside this file.

    python -m benchmarks.references.poke --levels 1 2
    python -m benchmarks.references.poke --levels 3 --frictions 0.6 inf         # 100 s
    python -m benchmarks.references.poke --levels 2 --frictions 0.6 --penalty 2e10
    python -m benchmarks.references.poke --levels 1 --frictions inf 0 --penalty 2e10

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Disc of radius 50 mm and height 32 mm, base fixed, side free, Neo-Hookean of the paper with mu = 30 kPa,
K = 600 kPa (lam = K - 2 mu/3); rigid flat rod of radius 2.5 mm with an edge radius of 1 mm pushed down its
axis. Force on the rod [N] at 1, 2, 5 and 10 mm for friction 0, 0.6 and full stick.

9-node quadrilaterals with discontinuous linear pressure and volume ratio (Q2/P-1), refined under the rod;
level m cuts every element of level 1 into m x m. Penalty contact at 7 points an edge, see rod.py: the deepest
penetration is in the file. The travel steps are at most 0.25 mm / m.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.cylinder import graded
from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.references.quadrilaterals import quadrilaterals, with_middles
from benchmarks.references.rod import FlatRod
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]
FILE = Path(__file__).with_suffix(".json")
RADIUS, HEIGHT, ROD, EDGE = 0.050, 0.032, 0.0025, 0.001
MU, BULK, PENALTY = 30e3, 600e3, 6e9
DEPTHS = (0.001, 0.002, 0.005, 0.010)


def corners(knots: tuple[float, ...], counts: tuple[int, ...], level: int) -> Array:
    """Corners and middles of intervals cut evenly between the knots."""
    spans = zip(knots[:-1], knots[1:], counts, strict=True)
    ends = [np.linspace(a, b, n * level, endpoint=False) for a, b, n in spans]
    return with_middles(np.append(np.concatenate(ends), knots[-1]))


@dataclass(frozen=True, kw_only=True)
class Case:
    """One indentation: indenter, law and depths; moduli in Pa, depths in m.

    tip: "flat", with the edge radius above, or "hemisphere". law: "neo_hookean" or "ogden", alpha 4.
    """

    tip: str = "flat"
    law: str = "neo_hookean"
    bulk: float = BULK
    depths: tuple[float, ...] = DEPTHS

    def mixed_law(self) -> Any:
        """The law in mixed form, for FElupe's `SolidBody`."""
        if self.law == "neo_hookean":
            return mixed_law(self.law, self.bulk, mu=MU)
        return mixed_law(self.law, self.bulk, mu=(MU / 2,), alpha=(4.0,))


def disc(level: int, axis: int = 2) -> fe.Mesh:
    """9-node quadrilaterals, (axial, radial), small at the top under the rod.

    axis: elements of level 1 in the 1.2 mm next to the axis.
    """
    near = corners((0.0, 0.0012, 0.0036), (axis, 8), level)
    far = near[-1] + (RADIUS - near[-1]) * graded(8 * level, 4.0)
    radial = np.concatenate([near, far[1:]])
    axial = HEIGHT * (1 - graded(10 * level, 2.2))[::-1]
    return quadrilaterals(axial, radial)


def poke(
    friction: float,
    level: int,
    penalty: float = PENALTY,
    case: Case = Case(),
    *,
    largest_step: float = 2.5e-4,
    see: Callable[[float, Array, Array], None] | None = None,
) -> dict[str, dict[str, float]]:
    """Force and checks at every depth reached; travel steps of at most largest_step / level [m].

    see(depth, radii (n,), displacements (n, 2) outwards and up) is told of the top at every depth [m].
    """
    mesh = disc(level) if case.tip == "flat" else disc(level, 4)
    field = mixed_fields(fe.RegionBiQuadraticQuad(mesh), axisymmetric=True)
    dof = np.arange(2 * mesh.npoints).reshape(-1, 2)
    base, axis = mesh.points[:, 0] < 1e-9, mesh.points[:, 1] < 1e-9
    fixed = np.unique(np.concatenate([dof[base].ravel(), dof[axis, 1]]))
    top = np.flatnonzero(mesh.points[:, 0] > HEIGHT - 1e-9)
    whole_top = top = top[np.argsort(mesh.points[top, 1])]
    top = top[mesh.points[top, 1] < max(0.012, 0.8 * case.depths[-1])]
    top = top[: len(top) - 1 + len(top) % 2]
    edges = np.stack([top[:-2:2], top[2::2], top[1:-1:2]], -1)
    edge = EDGE if case.tip == "flat" else ROD
    rod = FlatRod(mesh, edges, HEIGHT, ROD, edge, friction, penalty)
    law = case.mixed_law()
    zero = np.zeros(field[0].values.size)
    model = MixedModel(field, law, fixed, lambda _: zero, tolerance=1e-7, contact=rod)
    vertical = np.isin(fixed, dof[base, 0])
    out: dict[str, dict[str, float]] = {}

    def report(depth: float) -> None:
        reaction = float(model.reaction[vertical].sum())
        J = np.linalg.det(np.moveaxis(field.extract()[0], (0, 1), (-2, -1)))
        key = f"{depth * 1e3:g}"
        out[key] = {"force": rod.force, "base": reaction}
        out[key] |= {"penetration": rod.deepest, "min_J": float(J.min())}
        if see is not None:
            see(depth, mesh.points[whole_top, 1], field[0].values[whole_top][:, ::-1])
        what = f"friction {friction} level {level} penalty {penalty:g} depth {key} mm"
        forces = f"force {rod.force:.4f} N, base {reaction:.4f}, penetration {rod.deepest * 1e6:.1f} um"
        print(f"{what}: {forces}, min J {J.min():.3f}, {model.solves} solves, {clock():.0f} s", flush=True)

    if not model.path(0.0, case.depths, report, min(1e-4, largest_step), largest_step / level):
        print(f"friction {friction} level {level}: no equilibrium beyond the values above", flush=True)
    return out


def estimate(found: dict[str, Any], depths: tuple[float, ...] = DEPTHS) -> dict[str, Any]:
    """Force for a rigid contact at each friction and depth, from the finest level, and its error [%].

    Of the contacts that this level and a coarser one have, the stiffest counts. Its penalty's part is
    c / penalty, c from the two stiffest contacts of the coarsest level that has two, else stick's. Error:
    half of that correction plus the difference of the two finest levels; nothing from one level.
    """
    out: dict[str, Any] = {}
    for name, depth in itertools.product(found, (f"{d * 1e3:g}" for d in depths)):
        forces = _forces(found[name], depth)
        c = _slope(forces)
        c = _slope(_forces(found.get("stick", {}), depth)) if c is None else c
        pairs = [
            (fine, k, coarse)
            for fine, k in forces
            for coarse, other in forces
            if coarse < fine and k == other
        ]
        if not pairs or c is None:
            continue
        fine, penalty, coarse = max(pairs)
        force = forces[fine, penalty] + c / penalty
        error = abs(c / penalty) / 2 + abs(forces[fine, penalty] - forces[coarse, penalty])
        out.setdefault(name, {})[depth] = {"force": force, "error_percent": round(100 * error / force, 2)}
    return out


def _forces(runs: dict[str, Any], depth: str) -> dict[tuple[int, float], float]:
    """Force [N] at a depth by level and contact stiffness [Pa/m], where it was reached."""
    found = {}
    for key, values in runs.items():
        level, _, penalty = key.partition(", penalty ")
        if depth in values:
            found[int(level), float(penalty or PENALTY)] = float(values[depth]["force"])
    return found


def _slope(forces: dict[tuple[int, float], float]) -> float | None:
    """Force [N] that a rigid contact adds, times the contact stiffness [Pa/m]; None from one stiffness."""
    for level in sorted({level for level, _ in forces}):
        stiffest = sorted(k for at, k in forces if at == level)[-2:]
        if len(stiffest) == 2:
            soft, stiff = stiffest
            return (forces[level, stiff] - forces[level, soft]) / (1 / soft - 1 / stiff)
    return None


def write(found: dict[str, Any]) -> None:
    """Write poke.json."""
    about = {
        "units": "m, N, Pa; depths in mm",
        "radius": RADIUS,
        "height": HEIGHT,
        "rod_radius": ROD,
        "edge_radius": EDGE,
        "mu": MU,
        "K": BULK,
        "felupe": fe.__version__,
        "values": "friction: depth: rigid contact, estimated from the runs",
        "forces": "friction: level: depth: what was computed",
    }
    text = json.dumps({"about": about, "values": estimate(found), "forces": found}, indent=1)
    write_whole(FILE, text + "\n")


def main() -> None:
    """Solve what is asked for, adding to poke.json."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--levels", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--frictions", type=float, nargs="+", default=[0.6, float("inf"), 0.0])
    parser.add_argument("--penalty", type=float, default=PENALTY, help="Pa/m")
    args = parser.parse_args()
    found: dict[str, Any] = json.loads(FILE.read_text())["forces"] if FILE.exists() else {}
    for level in args.levels:
        for friction in args.frictions:
            name = "stick" if np.isinf(friction) else f"{friction:g}"
            key = f"{level}" if args.penalty == PENALTY else f"{level}, penalty {args.penalty:g}"
            found.setdefault(name, {})[key] = poke(friction, level, args.penalty)
            write(found)


if __name__ == "__main__":
    main()
