"""Where the surface under a flat rod is, and how it is pressed, by radius at rest; beside the reference.

    python -m benchmarks.contact_profile --depths 5 6 7 8 10                   # 10 core s
    python -m benchmarks.contact_profile --depths 5 6 7 8 10 --reference       # FElupe, level 1: 15 core s
    python -m benchmarks.contact_profile --depths 10 --refinement 1.4

Scene of pokes.py at 0 degrees. Of the top's nodes at each radius at rest [mm]: how far they slid outwards
[mm], and the pressure that their overlap with the rod stands for [kPa]. In the reference the tissue under the
flat stays where it is, and pressure rises smoothly to the edge.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tisim
from benchmarks.pokes import force_at, poke
from tisim.problems.indentation.solve import solve_poke

Array = NDArray[np.float64]
HEIGHT, ROD, EDGE, STIFFNESS = 0.032, 0.0025, 0.001, 6e9  # m, and Pa/m: that of both contacts
OUTERMOST = 0.0033
APART = 0.05e-3  # radii at rest nearer than this are one


def table(radius: Array, r: Array, z: Array, depth: float) -> str:
    """One line; radius at rest and place of nodes (n,) [m], z from the rest surface, depth [m]."""
    out, height = np.maximum(r - (ROD - EDGE), 0.0), np.maximum(EDGE - (z + depth), 0.0)
    overlap = np.maximum(EDGE - np.hypot(out, height), 0.0)
    key = np.round(radius / APART).astype(int)
    parts = []
    for k in np.unique(key[radius < OUTERMOST]):
        at = key == k
        slid, pressure = np.mean(r[at] - radius[at]), STIFFNESS * np.mean(overlap[at])
        parts.append(f"{1e3 * radius[at].mean():.2f}: {1e3 * slid:+.3f} {1e-3 * pressure:.0f}")
    return f"{1e3 * depth:4.1f} mm | " + " | ".join(parts)


def reference(depths: list[float]) -> None:
    """FElupe's, by the model of references/poke.py."""
    from benchmarks.references import poke as model

    rods: list[Any] = []

    class Watched(model.FlatRod):
        def accept(self, u: Array, factor: float) -> None:
            super().accept(u, factor)
            nodes = np.unique(self.nodes)
            X, x = self.rest[nodes], (self.rest + u)[nodes]
            if any(abs(factor - d) < 1e-9 for d in depths):
                rods.append(table(X[:, 1], x[:, 1], x[:, 0] - HEIGHT, factor))

    model.FlatRod = Watched  # type: ignore[misc]
    model.poke(0.6, 1, case=model.Case(depths=tuple(depths)))
    print("\n".join(rods))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--depths", type=float, nargs="+", default=[5.0, 10.0], help="mm, whole ones")
    parser.add_argument("--refinement", type=float, default=1.0)
    parser.add_argument("--reference", action="store_true", help="FElupe's in place of ours")
    args = parser.parse_args()
    depths = [1e-3 * d for d in args.depths]
    if args.reference:
        reference(depths)
        return
    result: tisim.Result = solve_poke(poke(0.0, max(depths), args.refinement))
    top = result.mesh.node_sets["top"]
    rest = result.mesh.nodes[top]
    for depth in depths:
        at = np.flatnonzero(np.abs(result.load - depth) < 1e-6)
        if len(at):
            x = result.positions[at[0]][top]
            radii = np.linalg.norm(rest[:, :2], axis=1), np.linalg.norm(x[:, :2], axis=1)
            print(f"{force_at(result, depth):7.4f} N, {table(*radii, x[:, 2] - HEIGHT, depth)}")


if __name__ == "__main__":
    main()
