"""Force of normal pokes to 20 mm of 32 against references/deep.json.

    python -m benchmarks.deep_pokes                                      # all 26 cases, some 8 core minutes
    python -m benchmarks.deep_pokes "flat ogden K/mu 20 friction 0.6" --refinement 1.5

The reference is a disc of 50 mm radius under a rigid rod, ours the default block of 100 mm, its contact by a
penalty (0.5 to 1 % softer: studies/depth). One line a case, forces between two frames interpolated;
what the reference does not have is left out.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

import tisim
from benchmarks.references.deep import DEPTHS, FILE, cases
from benchmarks.references.poke import MU
from tisim.problems.indentation.solve import solve_poke

LAWS = {"neo_hookean": "neo-hookean", "ogden": "ogden"}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="CASE", help="of references/deep.py --list; default: all")
    parser.add_argument("--refinement", type=float, default=1.0)
    parser.add_argument("--depth", type=float, default=20.0, help="mm")
    args = parser.parse_args()
    known = cases()
    for name in args.names:
        if name not in known:
            parser.error(f"unknown case {name!r}: python -m benchmarks.references.deep --list prints them")
    values = json.loads(Path(FILE).read_text())["values"]
    for name in args.names or known:
        case, friction = known[name]
        poke = tisim.Poke(
            material=tisim.material_from_moduli(LAWS[case.law], shear_modulus=MU, bulk_modulus=case.bulk),
            rod=tisim.Rod(tip="flat" if case.tip == "flat" else "hemisphere"),
            friction=friction,
            depth=1e-3 * args.depth,
            refinement=args.refinement,
        )
        result = solve_poke(poke)
        force = np.linalg.norm(result.rod_force, axis=1)
        parts = []
        for depth in DEPTHS:
            known_there = values.get(name, {}).get(f"{depth * 1e3:g}")
            if depth < result.load[-1] + 1e-6 and known_there is not None:
                # a frame that met the tolerance of a step alone stands a little deeper
                wrong = 100.0 * (np.interp(depth, result.load, force) / known_there["force"] - 1.0)
                parts.append(f"{wrong:+.1f} (±{known_there['error_percent']:.1f})")
            else:
                parts.append("")
        cost = f"{result.cost.core_seconds:.0f} core s, {result.cost.newton_iterations} Newton"
        print(f"| {name} | {' | '.join(parts)} | {1e3 * result.load[-1]:.1f} mm | {cost} |", flush=True)


if __name__ == "__main__":
    main()
