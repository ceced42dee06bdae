"""How deep pokes with little or no friction go, and why the others end.

    python -m benchmarks.slippery_pokes                     # 10 pokes to 20 of 32 mm, some 15 core minutes
    python -m benchmarks.slippery_pokes --pokes 4 --seed 3

Law, K/mu, tip, coefficient of friction, angle and site are drawn; half of the pokes have no friction. Tissue
slides out from under such an indenter in snaps. One line a poke, then how many arrived.
"""

from __future__ import annotations

import argparse

import numpy as np

import tisim
from tisim.problems.indentation.solve import solve_poke

MU = 30e3  # shear modulus [Pa]
LAWS, RATIOS, TIPS = ("neo-hookean", "ogden"), (20.0, 300.0), ("flat", "hemisphere")
FRICTIONS = (0.0, 0.0, 0.02, 0.05)
STEEPEST, ASIDE = 45.0, 0.020  # angle [degrees]; largest coordinate of a site [m]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--pokes", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--depth", type=float, default=20.0, help="mm")
    args = parser.parse_args()
    rng = np.random.default_rng(args.seed)
    arrived = 0
    for _ in range(args.pokes):
        law, ratio, tip = LAWS[rng.integers(2)], RATIOS[rng.integers(2)], TIPS[rng.integers(2)]
        friction = FRICTIONS[rng.integers(4)]
        angle, azimuth = np.radians(rng.uniform(0.0, STEEPEST)), rng.uniform(0.0, 2.0 * np.pi)
        x, y = rng.uniform(-ASIDE, ASIDE, 2)
        across = float(np.sin(angle))
        result = solve_poke(
            tisim.Poke(
                material=tisim.material_from_moduli(law, shear_modulus=MU, bulk_modulus=ratio * MU),
                rod=tisim.Rod(tip=tip),
                friction=friction,
                depth=1e-3 * args.depth,
                site=(float(x), float(y)),
                direction=(
                    across * float(np.cos(azimuth)),
                    across * float(np.sin(azimuth)),
                    -float(np.cos(angle)),
                ),
            )
        )
        arrived += result.ok
        scene = f"{tip} | {law} | {ratio:g} | {friction:g} | {np.degrees(angle):.0f}"
        cost = f"{result.cost.newton_iterations} Newton, {result.cost.core_seconds:.0f} core s"
        print(f"| {scene} | {result.load[-1] * 1e3:.1f} mm | {cost} | {result.message} |", flush=True)
    print(f"{arrived} of {args.pokes} reached {args.depth:g} mm")


if __name__ == "__main__":
    main()
