"""How far the simulator agrees with itself on other meshes: below this no surrogate is to blame.

    python -m benchmarks.label_noise --out runs/noise                # 22 pokes on 3 meshes each: 15 to 20 min
    python -m benchmarks.label_noise --out runs/noise --pokes 44
    python -m benchmarks.label_noise --out runs/fine --refinements 1.0 1.5 --pokes 6

Pokes of a recipe, spread evenly over its shapes, are meshed anew and solved at each refinement. The first is
what the dataset holds; the others are compared with it, frame by frame, on the 32 x 32 grid: mean and largest
distance, distance at the point that rests nearest to first touch in % of the depth, the same by rings of
distance from first touch, and the size of the rod's force. Refinements next to the first show the noise of
labels; much finer ones their bias as well. What ended before its depth is counted, and its frames are used.
Each solved poke is kept under --out: a run that was stopped goes on where it ended.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

import tisim
from benchmarks.whole import whole_file
from factory.plan import make_plan
from factory.plan.poke import PlannedPoke
from factory.recipe import load_recipe
from factory.sampling import SIZE, grid_points, interpolation
from factory.simulation.record import first_touch

Array = NDArray[np.float64]
RINGS = (0.0, 5.0, 10.0, 20.0, 40.0, np.inf)  # mm


@dataclass(frozen=True)
class Solved:
    """One poke on one mesh. depth (f,) [m], grid (f, 1024, 3) [m], force (f,) [N]."""

    depth: Array
    grid: Array
    force: Array
    nodes: int
    status: str


def solved(poke: PlannedPoke, refinement: float, folder: Path) -> Solved:
    """Simulated, or read from where an earlier run kept it."""
    path = folder / f"poke-{poke.index:04d}-{refinement:g}.npz"
    if not path.exists():
        scene = replace(poke.scene, refinement=refinement)
        result = tisim.simulate([scene], workers=1)[0]
        points = grid_points(scene.block.size).reshape(-1, 3)
        at = interpolation(result.mesh.nodes, result.mesh.facet_sets["top"], points)
        with whole_file(path) as file:
            np.savez(
                file,
                allow_pickle=False,
                depth=result.load,
                grid=at(result.positions - result.mesh.nodes),
                force=np.linalg.norm(result.rod_force, axis=1),
                nodes=result.mesh.n_nodes,
                status=str(result.status),
            )
    with np.load(path) as kept:
        return Solved(kept["depth"], kept["grid"], kept["force"], int(kept["nodes"]), str(kept["status"]))


def compared(poke: PlannedPoke, one: Solved, other: Solved) -> Array:
    """A row a frame that both reached: mean, max [mm], tip [% of depth], force [%], rings [mm], mean
    displacement [mm]."""
    points = grid_points(poke.scene.block.size).reshape(SIZE * SIZE, 3)
    away = 1e3 * np.linalg.norm(points - first_touch(poke.scene), axis=1)
    rows = []
    for k in range(min(len(one.depth), len(other.depth))):
        if abs(one.depth[k] - other.depth[k]) > 1e-6:
            break
        apart = 1e3 * np.linalg.norm(one.grid[k] - other.grid[k], axis=1)
        ring = [
            apart[(away >= a) & (away < b)].mean() if ((away >= a) & (away < b)).any() else np.nan
            for a, b in pairwise(RINGS)
        ]
        tip = 100 * apart[np.argmin(away)] / (1e3 * one.depth[k])
        force = 100 * abs(other.force[k] / one.force[k] - 1)
        moved = 1e3 * np.linalg.norm(one.grid[k], axis=1).mean()
        rows.append([apart.mean(), apart.max(), tip, force, *ring, moved])
    return np.array(rows).reshape(-1, 5 + len(RINGS) - 1)


def chosen(pokes: Sequence[PlannedPoke], count: int) -> list[PlannedPoke]:
    """`count` pokes at even steps through the plan, which is ordered by shape, level and contact point."""
    at = np.unique(np.linspace(0, len(pokes) - 1, count).round().astype(int))
    return [pokes[i] for i in at]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--recipe", default="surrogate")
    parser.add_argument("--model", default="ogden")
    parser.add_argument("--pokes", type=int, default=22)
    parser.add_argument("--refinements", type=float, nargs="+", default=[1.0, 0.9, 1.1])
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    pokes = chosen(make_plan(load_recipe(given.recipe), given.model).pokes, given.pokes)
    began = time.process_time()
    runs = [
        {r: solved(p, r, given.out) for r in given.refinements}
        for p in track(pokes, description="re-meshed pokes")
    ]
    first, *others = given.refinements
    console = Console(width=160)
    table = Table(title=f"{len(pokes)} pokes against themselves at refinement {first:g}")
    rings = [f"{a:g}-{b:g} mm" for a, b in pairwise(RINGS)]
    names = ["mean mm", "max mm", "tip %", "force %", *rings, "moved mm"]
    for name in ("refinement", "nodes", "frames", *names, "ended early"):
        table.add_column(name, justify="right")
    for r in others:
        rows = np.vstack([compared(p, run[first], run[r]) for p, run in zip(pokes, runs, strict=True)])
        early = sum(run[r].status != "converged" for run in runs)
        nodes = np.mean([run[r].nodes for run in runs])
        means = np.nanmean(rows, axis=0)
        table.add_row(f"{r:g}", f"{nodes:.0f}", str(len(rows)), *(f"{v:.4f}" for v in means), str(early))
    console.print(table)
    signed = [
        100 * (run[r].force[k] / run[first].force[k] - 1)
        for run in runs
        for r in others
        for k in (min(len(run[r].force), len(run[first].force)) - 1,)
    ]
    console.print(f"force of the last frame: {np.mean(signed):+.2f} % on average, sd {np.std(signed):.2f} %")
    console.print(f"{time.process_time() - began:.0f} s of CPU in this run")


if __name__ == "__main__":
    main()
