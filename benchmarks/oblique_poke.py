"""An oblique poke to 10 mm beside references/oblique.json: force, and where the surface is.

    python -m benchmarks.oblique_poke                    # 10 core s
    python -m benchmarks.oblique_poke --refinement 1.5

45 degrees from the normal, both with the same penalty contact (6e9 Pa/m). One line a depth for each level of
the reference, and for each of its levels beside the finest. Force: its part along the rod and its two
components [N]. Surface: distance [mm] of ours from the reference's at its nodes, mean (largest), by distance
at rest from the middle of the top, where the rod's axis meets it.
"""

from __future__ import annotations

import argparse
import json
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

import tisim
from benchmarks.pokes import poke
from benchmarks.references.oblique import ANGLE, FILE
from tisim.discretisation.quadrature import facet_quadrature
from tisim.problems.indentation.solve import solve_poke

Array = NDArray[np.float64]
RINGS = (0.0, 3.0, 6.0, 12.0)  # mm


def surface(result: tisim.Result, frame: int, points: Array) -> Array:
    """Displacement [mm] of points (n, 2) [mm] of the top."""
    facets = result.mesh.facet_sets["top"]
    shape = facet_quadrature(facets.shape[1], 6)[0]
    rest, moved = (
        1e3 * np.einsum("qa,fai->fqi", shape, values[facets]).reshape(-1, 3)
        for values in (result.mesh.nodes, result.positions[frame] - result.mesh.nodes)
    )
    return np.asarray(LinearNDInterpolator(rest[:, :2], moved)(points))


def compared(force: Array, moved: Array, run: dict[str, Any], depth: str) -> str:
    """One line: errors of a force (3,) [N] and of displacements (n, 3) [mm] at the run's points."""
    there, tilt = run["depths"][depth], np.radians(ANGLE)
    along = float(force @ [-np.sin(tilt), 0.0, np.cos(tilt)])
    points = np.array(run["points"])
    off = np.linalg.norm(moved - there["surface"], axis=1)
    away = np.linalg.norm(points, axis=1)
    parts = [f"{along:.4f} ({100 * (along / there['along'] - 1):+.1f} %)"]
    parts += [f"{force[k]:.4f} ({100 * (force[k] / there['force'][k] - 1):+.1f} %)" for k in (0, 2)]
    for low, high in pairwise(RINGS):
        ring = off[(away >= low) & (away < high)]
        parts.append(f"{np.nanmean(ring):.3f} ({np.nanmax(ring):.3f})")
    return " | ".join(parts)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--refinement", type=float, default=1.0)
    args = parser.parse_args()
    runs = json.loads(FILE.read_text())["runs"]
    result = solve_poke(poke(ANGLE, 0.010, args.refinement))
    assert result.rod_force is not None
    print(f"ours: {len(result.mesh.nodes)} nodes, {result.cost.core_seconds:.1f} core s")
    rings = " | ".join(f"{a:g}-{b:g} mm" for a, b in pairwise(RINGS))
    print(f"| of | depth | along | x | z | {rings} |")
    plain = [key for key in runs if "," not in key]
    finest = max(plain, key=float)
    for key, run in runs.items():
        points = np.array(run["points"])
        for depth in run["depths"]:
            frame = np.flatnonzero(np.abs(1e3 * result.load - float(depth)) < 1e-6)
            if len(frame):
                line = compared(
                    result.rod_force[frame[0]], surface(result, int(frame[0]), points), run, depth
                )
                print(f"| ours, of level {key} | {depth} mm | {line} |")
    for key, run in runs.items():
        if key == finest:
            continue
        at, best = np.array(runs[finest]["points"]), runs[finest]["depths"]
        for depth in run["depths"]:
            if depth in best:
                moved = LinearNDInterpolator(
                    np.array(run["points"]), np.array(run["depths"][depth]["surface"])
                )
                line = compared(np.array(run["depths"][depth]["force"]), moved(at), runs[finest], depth)
                print(f"| level {key}, of level {finest} | {depth} mm | {line} |")


if __name__ == "__main__":
    main()
