"""How deep pokes go where the block leaves room for it, and why the others end.

    python -m benchmarks.crushed_pokes                      # 12 pokes to 30 of 32 mm, some 20 core minutes
    python -m benchmarks.crushed_pokes --pokes 6 --seed 3

Sites, directions, shapes and moduli are drawn from the pokes of the recipe `paper`, whose own depth is 20 mm:
those that keep a millimetre of tissue between the indenter and what is rigid to the depth asked for (nine of
ten to 30 mm). One line a poke, then how many arrived.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from factory.plan import make_plan
from factory.recipe import load_recipe
from tisim.problems.indentation.first_touch import plane_contact
from tisim.problems.indentation.rod import tissue_left
from tisim.problems.indentation.solve import solve_poke
from tisim.scene import Poke

ROOM = 1e-3  # tissue that is left at least at the depth asked for [m]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--pokes", type=int, default=12)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--depth", type=float, default=30.0, help="mm")
    args = parser.parse_args()
    depth = 1e-3 * args.depth
    plan = make_plan(load_recipe("paper"), "ogden")
    once = {
        (repr(one.scene.block), one.scene.site, one.scene.direction): k for k, one in enumerate(plan.pokes)
    }
    possible = [k for k in once.values() if room(plan.pokes[k].scene, depth) > ROOM]
    print(f"{len(possible)} of {len(once)} sites and directions leave room to {args.depth:g} mm")
    arrived = 0
    chosen = np.random.default_rng(args.seed).permutation(possible)[: args.pokes]
    for k in chosen:
        scene = replace(plan.pokes[k].scene, depth=depth, frame_spacing=1e-3)
        result = solve_poke(scene)
        arrived += result.ok
        angle = np.degrees(np.arccos(-scene.direction[2] / np.linalg.norm(scene.direction)))
        cost = f"{result.cost.newton_iterations} Newton, {result.cost.core_seconds:.0f} core s"
        print(
            f"| {k} | {angle:.0f} degrees | {result.load[-1] * 1e3:.1f} mm | {cost} | {result.message} |",
            flush=True,
        )
    print(f"{arrived} of {len(chosen)} reached {args.depth:g} mm")


def room(scene: Poke, depth: float) -> float:
    """Smallest distance of the indenter from what is rigid on its way to a depth [m]."""
    way = np.asarray(scene.direction) / np.linalg.norm(scene.direction)
    touch = plane_contact(scene.rod, scene.site, scene.block.size[2], way)
    return min(tissue_left(scene, touch + at * way, way)[0] for at in np.linspace(0.0, depth, 31))


if __name__ == "__main__":
    main()
