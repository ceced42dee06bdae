"""Where a poked block's surface is, beside the reference of references/surface.json, by radius at rest.

    python -m benchmarks.deep_surface                           # some 30 core s
    python -m benchmarks.deep_surface --law ogden --refinement 1.5
    python -m benchmarks.deep_surface --disc                    # on the reference's body

Flat rod at 0 degrees, friction 0.6, K/mu 20. Distance [mm] of our surface, at 36 points a facet, from the
place that the reference has for the same radius at rest: mean over the area (largest) in rings; the same of
the reference's second level from its third, which says what the reference's own elements are worth. The
reference's body is a disc of 50 mm radius, ours a block of 100 mm: --disc moves the block's outer nodes onto
that disc, so that what remains is the solver's error.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tisim
from benchmarks.deep_pokes import LAWS
from benchmarks.references.poke import BULK, MU
from benchmarks.references.surface import FILE, FRICTION
from tisim.discretisation.quadrature import facet_areas
from tisim.mesh.indentation import poke_mesh
from tisim.problems.indentation.solve import solve_poke

Array = NDArray[np.float64]
RINGS = (0.0, 1.5, 3.0, 5.0, 10.0, 25.0, 45.0)  # mm
FINEST, COARSER = "3", "2"  # levels of the reference
DISC, SAME_WITHIN = 0.050, 0.020  # radius of the reference's disc; nodes nearer to the axis stay [m]


def on_disc(mesh: tisim.Mesh) -> tisim.Mesh:
    """The block's mesh with its sides moved onto the disc, along the rays from the axis."""
    x, y, z = mesh.nodes.T
    radius = np.hypot(x, y)
    side = DISC * radius / np.maximum(np.maximum(np.abs(x), np.abs(y)), 1e-12)  # of the block, on its ray
    beyond = np.maximum(radius - SAME_WITHIN, 0.0)
    moved = np.where(beyond > 0.0, SAME_WITHIN + beyond * (DISC - SAME_WITHIN) / (side - SAME_WITHIN), radius)
    factor = np.divide(moved, radius, out=np.ones_like(radius), where=radius > 0.0)
    return replace(mesh, nodes=np.column_stack([factor * x, factor * y, z]))


def ours(result: tisim.Result, frame: int) -> Array:
    """Radius at rest, displacements outwards and up [mm] and area [m2] of many points of the top, (n, 4)."""
    facets = result.mesh.facet_sets["top"]
    shape, area = facet_areas(result.mesh.nodes, facets, 6)

    def at_points(values: Array) -> Array:
        return np.einsum("qa,fai->fqi", shape, values[facets]).reshape(-1, 3)

    rest = at_points(result.mesh.nodes)
    moved = at_points(result.positions[frame] - result.mesh.nodes)
    radius = np.hypot(rest[:, 0], rest[:, 1])
    outwards = (moved[:, :2] * rest[:, :2]).sum(axis=1) / radius
    return np.column_stack([1e3 * radius, 1e3 * outwards, 1e3 * moved[:, 2], area.ravel()])


def theirs(surface: dict[str, list[float]]) -> Array:
    """The same of the reference, areas in another unit."""
    radius = np.array(surface["radius"])
    return np.column_stack([radius, surface["outwards"], surface["up"], radius * np.gradient(radius)])


def apart(surface: Array, known: Array) -> Array:
    """Distance of each point from where `known` has its radius at rest (n,) [mm]."""
    there = np.column_stack([np.interp(surface[:, 0], known[:, 0], known[:, k]) for k in (1, 2)])
    return np.linalg.norm(surface[:, 1:3] - there, axis=1)


def distances(surface: Array, known: Array) -> str:
    """Mean (largest) distance in each ring, and within the outermost."""
    radius, area, off = surface[:, 0], surface[:, 3], apart(surface, known)
    parts = []
    for low, high in (*pairwise(RINGS), (RINGS[0], RINGS[-1])):
        within = (radius >= low) & (radius < high)
        parts.append(f"{np.average(off[within], weights=area[within]):.3f} ({off[within].max():.3f})")
    return " | ".join(parts)


def reference_poke(law: str, *, depth: float, refinement: float = 1.0, disc: bool = False) -> tisim.Poke:
    """The reference's poke to a depth [m], in a block or, with `disc`, in the reference's body."""
    poke = tisim.Poke(
        material=tisim.material_from_moduli(LAWS[law], shear_modulus=MU, bulk_modulus=BULK),
        friction=FRICTION,
        depth=depth,
        refinement=refinement,
    )
    if not disc:
        return poke
    mesh = poke_mesh(block=poke.block, site=poke.site, rod=poke.rod, friction=FRICTION, refinement=refinement)
    return replace(poke, mesh=on_disc(mesh))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--law", choices=sorted(LAWS), default="neo_hookean")
    parser.add_argument("--depth", type=float, default=20.0, help="mm")
    parser.add_argument("--refinement", type=float, default=1.0)
    parser.add_argument("--disc", action="store_true", help="a disc as the reference's in place of a block")
    args = parser.parse_args()
    levels: dict[str, Any] = json.loads(FILE.read_text())["values"][args.law]
    poke = reference_poke(args.law, depth=1e-3 * args.depth, refinement=args.refinement, disc=args.disc)
    result = solve_poke(poke)
    print("| depth | | " + " | ".join(f"{low:g}-{high:g}" for low, high in pairwise(RINGS)) + " | all |")
    for depth, surface in levels[FINEST].items():
        known = theirs(surface)
        frame = np.flatnonzero(np.abs(1e3 * result.load - float(depth)) < 1e-3)
        if len(frame):
            print(f"| {depth} mm | ours | {distances(ours(result, int(frame[0])), known)} |", flush=True)
        if depth in levels[COARSER]:
            print(f"| | level {COARSER} | {distances(theirs(levels[COARSER][depth]), known)} |", flush=True)


if __name__ == "__main__":
    main()
