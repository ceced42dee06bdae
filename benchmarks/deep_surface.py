"""Where a poked block's surface is, beside the reference of references/poke.py, by radius at rest.

    python -m benchmarks.deep_surface --depths 5 10 15 20              # some 60 core s, of which FElupe 20
    python -m benchmarks.deep_surface --depths 10 --refinement 1.5

Scene of pokes.py at 0 degrees, friction 0.6. Distance [mm] of our surface, at 36 points a facet, from the
place that the reference's has for the same radius at rest: mean (largest) in rings. Far off, the reference's
disc of 50 mm radius and our block of 100 mm differ as bodies.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tisim
from benchmarks.pokes import poke
from benchmarks.references import poke as model
from tisim.discretisation.quadrature import facet_quadrature
from tisim.problems.indentation.solve import solve_poke

Array = NDArray[np.float64]
RINGS = (0.0, 1.5, 3.0, 5.0, 10.0, 25.0, 45.0)  # mm


def reference(depths: list[float], level: int = 1) -> dict[float, tuple[Array, Array]]:
    """FElupe's: radii at rest (n,) and displacements (n, 2), outwards and up, at each depth reached [m]."""
    found: dict[float, tuple[Array, Array]] = {}

    class Watched(model.FlatRod):
        def accept(self, u: Array, factor: float) -> None:
            super().accept(u, factor)
            top = np.flatnonzero(self.rest[:, 0] > model.HEIGHT - 1e-9)
            top = top[np.argsort(self.rest[top, 1])]
            for depth in depths:
                if abs(factor - depth) < 1e-9:
                    found[depth] = self.rest[top, 1], u[top][:, ::-1].copy()

    model.FlatRod = Watched  # type: ignore[misc]
    model.poke(0.6, level, case=model.Case(depths=tuple(depths)))
    return found


def ours(result: tisim.Result, frame: int) -> tuple[Array, Array]:
    """The same of a result."""
    facets = result.mesh.facet_sets["top"]
    shape = facet_quadrature(facets.shape[1], 6)[0]

    def at_points(values: Array) -> Array:
        return np.einsum("qa,fai->fqi", shape, values[facets]).reshape(-1, 3)

    rest = at_points(result.mesh.nodes)
    moved = at_points(result.positions[frame] - result.mesh.nodes)
    radius = np.hypot(rest[:, 0], rest[:, 1])
    outwards = (moved[:, :2] * rest[:, :2]).sum(axis=1) / radius
    return radius, np.stack([outwards, moved[:, 2]], axis=1)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--depths", type=float, nargs="+", default=[5.0, 10.0], help="mm, whole ones")
    parser.add_argument("--refinement", type=float, default=1.0)
    args = parser.parse_args()
    depths = sorted(1e-3 * d for d in args.depths)
    known: dict[float, Any] = reference(depths)
    result = solve_poke(poke(0.0, depths[-1], args.refinement))
    for depth in depths:
        frame = np.flatnonzero(np.abs(result.load - depth) < 1e-6)
        if not len(frame) or depth not in known:
            continue
        radius, moved = ours(result, int(frame[0]))
        there = np.stack([np.interp(radius, known[depth][0], known[depth][1][:, k]) for k in (0, 1)], axis=1)
        off = 1e3 * np.linalg.norm(moved - there, axis=1)
        parts = []
        for low, high in pairwise(RINGS):
            within = off[(radius >= 1e-3 * low) & (radius < 1e-3 * high)]
            parts.append(f"{low:g}-{high:g}: {within.mean():.3f} ({within.max():.3f})")
        print(f"{1e3 * depth:4.1f} mm | " + " | ".join(parts), flush=True)


if __name__ == "__main__":
    main()
