"""Reference force of an oblique poke to 10 mm, by FElupe in 3-D; writes oblique.json beside this file.

    python -m benchmarks.references.oblique --levels 1              # some 10 core minutes
    python -m benchmarks.references.oblique --levels 1 --penalty 1e10
    python -m benchmarks.references.oblique --levels 1.4            # an hour
    python -m benchmarks.references.oblique --angle 0 --depth 2     # beside references/poke.json: a check

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Half (y >= 0) of a block of 100 x 100 x 32 mm, base fixed, sides free, Neo-Hookean of the paper with
mu = 30 kPa, K = 600 kPa, friction 0.6; rigid flat rod of radius 2.5 mm with an edge radius of 1 mm, pushed
along its axis, 45 degrees from the normal towards +x, the axis through the middle of the top. Depth: travel
from first touch. Force on the rod [N] and displacement of the top's nodes.

27-node hexahedra with discontinuous linear pressure and volume ratio (Q2/P-1) on a grid of planes, refined
under the rod; at level m there are m times as many elements each way (rounded). Contact by a penalty at
6 x 6 points a face, friction by an anchor on the rod's surface (see `Rod`). Travel steps of at most 0.3 mm.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np
import scipy.sparse as sp

from benchmarks.references.cylinder import graded, lattice_cells
from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.references.poke import BULK, EDGE, HEIGHT, MU, PENALTY, ROD, corners
from benchmarks.references.rod import pressure
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]
FILE = Path(__file__).with_suffix(".json")
ANGLE, FRICTION, HALF = 45.0, 0.6, 0.050
DEPTHS = (0.001, 0.002, 0.005, 0.0075, 0.010)
FRONT, BACK, BESIDE = 0.0080, -0.0045, 0.0050  # of the refined part of the top, from the middle [m]
STEP = 3e-4


class Rod:
    """Contact term of `mixed.MixedModel` in 3-D; the load factor is the rod's travel [m].

    The rod is what lies within `edge` of a flat-ended cylinder of radius `flat`: the gap is a distance less
    the edge radius. Traction on the area at rest: pressure penalty <-gap>, rounded off over the first `soft`;
    friction `stick` times the way, in the tangent plane, from the anchor to the foot of the point on the rod,
    held below friction times pressure by return mapping. The anchor is a point of the rod's surface: the foot
    of the surface point at the end of the step in which it first touched, moved when the point slips.
    """

    def __init__(self, mesh: fe.Mesh, faces: Array, *, angle: float, friction: float, penalty: float) -> None:
        """faces: (n, 9) nodes of faces of 27-node hexahedra, a 3 x 3 lattice row by row."""
        self.nodes, self.size, self.rest = faces, mesh.points.size, mesh.points
        self.flat, self.edge = ROD - EDGE, EDGE
        self.friction, self.penalty, self.stick, self.soft = friction, penalty, 0.5 * penalty, 1e-5
        tilt = math.radians(angle)
        self.push = np.array([math.sin(tilt), 0.0, -math.cos(tilt)])
        # the rounded edge's lowest point is `core sin + e (1 - cos)` below the height of the tip's centre
        lowest = self.flat * math.sin(tilt) + self.edge * (1 - math.cos(tilt))
        self.start = np.array([0.0, 0.0, HEIGHT]) - self.push * lowest / math.cos(tilt)
        a, w = np.polynomial.legendre.leggauss(6)
        line = np.stack([a * (a - 1) / 2, 1 - a**2, a * (a + 1) / 2], -1)
        slope = np.stack([a - 0.5, -2 * a, a + 0.5], -1)
        self.shape = np.einsum("pi,qj->pqij", line, line).reshape(36, 9)
        turn = [np.einsum("pi,qj->pqij", f, g).reshape(36, 9) for f, g in ((slope, line), (line, slope))]
        across = [np.einsum("qa,eai->eqi", t, mesh.points[faces]) for t in turn]
        self.weight = np.linalg.norm(np.cross(*across), axis=-1) * np.outer(w, w).ravel()
        self.anchor = np.full((*self.weight.shape, 3), np.nan)
        self.force, self.deepest = np.zeros(3), 0.0

    def _place(self, x: Array, travel: float) -> tuple[Array, Array, Array]:
        """Gap, outward normal, and foot on the rod's surface from the tip's centre, of points (..., 3)."""
        from_tip = x - (self.start + travel * self.push)
        height = -from_tip @ self.push
        radial = from_tip + height[..., None] * self.push
        r = np.linalg.norm(radial, axis=-1)
        outward = radial / np.maximum(r, 1e-12)[..., None]
        dr, dz = np.maximum(r - self.flat, 0.0), np.maximum(self.edge - height, 0.0)
        distance = np.maximum(np.hypot(dr, dz), 1e-12)
        normal = (dr[..., None] * outward + dz[..., None] * self.push) / distance[..., None]
        gap = distance - self.edge
        return gap, normal, from_tip - gap[..., None] * normal

    def _way(self, normal: Array, foot: Array) -> Array:
        """From the anchor to the foot, in the tangent plane; 0 where there is no anchor yet."""
        way = np.where(np.isnan(self.anchor), 0.0, foot - self.anchor)
        return np.asarray(way - (way * normal).sum(-1, keepdims=True) * normal)

    def _held(self, way: Array, pressure: Array) -> Array:
        """The way that friction holds."""
        size = np.maximum(np.linalg.norm(way, axis=-1), 1e-15)
        return np.asarray(way * np.minimum(1.0, self.friction * pressure / self.stick / size)[..., None])

    def traction(self, x: Array, travel: float) -> Array:
        """Force an area at rest on the surface [Pa], (..., 3)."""
        gap, normal, foot = self._place(x, travel)
        p = pressure(gap, self.penalty, self.soft)
        return p[..., None] * normal - self.stick * self._held(self._way(normal, foot), p)

    def assemble(self, u: Array, factor: float) -> tuple[Array, sp.csr_matrix]:
        """Residual and tangent (central differences of the traction)."""
        x = np.einsum("qa,eai->eqi", self.shape, (self.rest + u)[self.nodes])
        f = self.traction(x, factor) * self.weight[..., None]
        dof = 3 * self.nodes[..., None] + np.arange(3)
        residual = np.zeros(self.size)
        np.add.at(residual, dof, -np.einsum("qa,eqi->eai", self.shape, f))
        h = 1e-10
        columns = [self.traction(x + d, factor) - self.traction(x - d, factor) for d in h * np.eye(3)]
        slope = np.stack(columns, -1) / (2 * h) * self.weight[..., None, None]
        touching = np.flatnonzero(np.abs(slope).max(axis=(1, 2, 3)) > 0)
        slope, index = slope[touching], dof[touching].reshape(len(touching), 27)
        block = -np.einsum("qa,eqij,qb->eaibj", self.shape, slope, self.shape, optimize=True)
        rows, cols = np.repeat(index, 27, axis=1), np.tile(index, (1, 27))
        matrix = sp.csr_matrix((block.ravel(), (rows.ravel(), cols.ravel())), shape=(self.size, self.size))
        return residual, matrix

    def accept(self, u: Array, factor: float) -> None:
        """Anchors of new touches, slip of old ones; force of the half on the rod, deepest penetration."""
        x = np.einsum("qa,eai->eqi", self.shape, (self.rest + u)[self.nodes])
        gap, normal, foot = self._place(x, factor)
        self.force = -np.einsum("eqi,eq->i", self.traction(x, factor), self.weight)
        self.deepest = float(np.maximum(-gap, 0.0).max())
        held = self._held(self._way(normal, foot), pressure(gap, self.penalty, self.soft))
        tip = self.start + factor * self.push
        moved = self._place(tip + foot - held, factor)[2]  # back onto the rod's surface
        fresh = np.isnan(self.anchor)
        touching = (gap < 0.0)[..., None]
        self.anchor = np.where(touching, np.where(fresh, foot, moved), np.nan)


def half_block(level: float) -> tuple[fe.Mesh, Array]:
    """Mesh and the node numbers (x, y) of its top."""

    def count(n: int) -> int:
        return round(n * level)

    side = graded(count(4), 3.0)[1:]
    x = np.concatenate([
        BACK - (HALF + BACK) * side[::-1],
        corners((BACK, FRONT), (count(14),), 1),
        FRONT + (HALF - FRONT) * side,
    ])  # fmt: skip
    y = np.concatenate(
        [corners((0.0, 0.003, BESIDE), (count(4), count(2)), 1), BESIDE + (HALF - BESIDE) * side]
    )
    z = HEIGHT * (1 - graded(count(6), 3.0))[::-1]
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1)
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    return fe.Mesh(grid.reshape(-1, 3), lattice_cells(number), "hexahedron27"), number[:, :, -1]


def poke(
    level: float,
    penalty: float,
    depths: tuple[float, ...] = DEPTHS,
    *,
    angle: float = ANGLE,
    step: float = STEP,
) -> dict[str, Any]:
    """Force, checks and the top's displacement at every depth reached."""
    mesh, top = half_block(level)
    field = mixed_fields(fe.RegionTriQuadraticHexahedron(mesh))
    dof = np.arange(3 * mesh.npoints).reshape(-1, 3)
    base, mirror = mesh.points[:, 2] < 1e-9, mesh.points[:, 1] < 1e-9
    fixed = np.unique(np.concatenate([dof[base].ravel(), dof[mirror, 1]]))
    at = mesh.points[top]
    near = (np.abs(at[..., 0]) < 0.018) & (at[..., 1] < 0.012)
    i, j = (np.flatnonzero(near.any(axis=k)) for k in (1, 0))
    i, j = i[i % 2 == 0], j[j % 2 == 0]
    faces = [top[a : a + 3, b : b + 3].ravel() for a in i[:-1] for b in j[:-1]]
    rod = Rod(mesh, np.array(faces), angle=angle, friction=FRICTION, penalty=penalty)
    zero = np.zeros(field[0].values.size)
    law = mixed_law("neo_hookean", BULK, mu=MU)
    model = MixedModel(field, law, fixed, lambda _: zero, tolerance=1e-6, contact=rod)
    held = np.isin(fixed, dof[base, 2])
    out: dict[str, Any] = {}
    print(f"level {level:g}: {mesh.npoints} nodes", flush=True)

    def report(depth: float) -> None:
        reaction = 2 * float(model.reaction[held].sum())
        J = np.linalg.det(np.moveaxis(field.extract()[0], (0, 1), (-2, -1)))
        force = 2 * rod.force * [1, 0, 1]
        out[f"{depth * 1e3:g}"] = {
            "force": force.round(6).tolist(),
            "along": round(float(-force @ rod.push), 6),
            "base": round(reaction, 6),
            "penetration": rod.deepest,
            "min_J": round(float(J.min()), 4),
            "surface": np.round(1e3 * field[0].values[top[near]], 4).tolist(),
        }
        what = f"level {level:g} penalty {penalty:g} depth {depth * 1e3:g} mm: force {force.round(4)} N"
        checks = f"base {reaction:.4f}, penetration {rod.deepest * 1e6:.1f} um, min J {J.min():.3f}"
        print(f"{what}, {checks}, {model.solves} solves, {clock():.0f} s", flush=True)

    reached = model.path(0.0, depths, report, min(1e-4, step), step)
    if not reached:
        print(f"level {level:g}: no equilibrium beyond the values above", flush=True)
    return {"points": np.round(1e3 * at[near][:, :2], 4).tolist(), "nodes": mesh.npoints, "depths": out}


def main() -> None:
    """Solve what is asked for, adding to oblique.json."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--levels", type=float, nargs="+", default=[1.0])
    parser.add_argument("--penalty", type=float, default=PENALTY, help="Pa/m")
    parser.add_argument("--depth", type=float, default=10.0, help="mm; below 10 nothing is written")
    parser.add_argument("--step", type=float, default=1e3 * STEP, help="largest travel of a step [mm]")
    parser.add_argument("--angle", type=float, default=ANGLE, help="degrees; but for 45 nothing is written")
    args = parser.parse_args()
    for level in args.levels:
        depths = tuple(d for d in DEPTHS if d <= 1e-3 * args.depth)
        run = poke(level, args.penalty, depths, angle=args.angle, step=1e-3 * args.step)
        if len(depths) < len(DEPTHS) or args.angle != ANGLE:
            continue
        found: dict[str, Any] = json.loads(FILE.read_text())["runs"] if FILE.exists() else {}
        key = f"{level:g}" if args.penalty == PENALTY else f"{level:g}, penalty {args.penalty:g}"
        key += "" if args.step == 1e3 * STEP else f", steps of {args.step:g} mm"
        about = {
            "units": "N, Pa/m; depths, points at rest (x, y) and displacements of the top in mm",
            "model": "benchmarks/references/oblique.py",
            "felupe": fe.__version__,
        }
        text = json.dumps({"about": about, "runs": found | {key: run}})
        write_whole(FILE, text + "\n")


if __name__ == "__main__":
    main()
