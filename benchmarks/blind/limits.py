"""Upper bound on correct ranking by any diagnosis: `python -m benchmarks.blind.limits coupons --seed 9`.

Each case of one effect is written again without noise. The excess of chi-square of the nearest alternative
over the truth is the squared distance d^2 between their predictions, in standard deviations of the noise. If
both have the same prior probability, no rule selects the right one of them in more than a fraction Phi(d/2)
of experiments (Neyman and Pearson); further alternatives reduce it. Distances are those of the diagnosis'
model: for indentations they contain the difference of the two solvers, which is printed as the chi-square of
the truth.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks.blind import coupons, indentation
from benchmarks.blind.under_test import noise_free_fits

# function that draws cases by count and seed, and function that writes one
KINDS: dict[str, tuple[Callable[[int, int], Any], Callable[..., None]]] = {
    "coupons": (coupons.draw_cases, coupons.write),
    "indentation": (indentation.draw_cases, indentation.write),
}


def fits(kind: str, case: Any) -> dict[str, float]:
    """Minimum chi-square of each effect on the case's data without noise."""
    _, write = KINDS[kind]
    with tempfile.TemporaryDirectory() as place:
        write(case, Path(place) / "experiment", noise=0.0)
        return noise_free_fits(kind, Path(place) / "experiment", case.hidden[0].name)


def summary(least: dict[str, float], truth: str) -> tuple[str, float]:
    """Nearest alternatives as text, and the largest fraction of correct first ranks under any rule."""
    own = least[truth]
    near = sorted((chi2 - own, name) for name, chi2 in least.items() if name != truth)[:3]
    most = largest_fraction(near[0][0]) if near else 1.0
    others = ", ".join(f"{name} {d2:.2f}" for d2, name in near)
    return f"chi-square {own:.1f}: {others}; first in {most:.0%}", most


def largest_fraction(nearest: float) -> float:
    """Phi(d/2) for d^2 = `nearest`, the excess of the nearest alternative's noise-free chi-square."""
    return 0.5 * (1.0 + math.erf(math.sqrt(max(nearest, 0.0) / 8.0)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=list(KINDS))
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--least", type=float, default=5.0, help="sigmas")
    given = parser.parse_args()
    fractions = []
    for n, case in enumerate(KINDS[given.kind][0](given.cases, given.seed)):
        if case.kind != "one" or case.hidden[0].sigma < given.least:
            continue
        hidden = case.hidden[0]
        text, most = summary(fits(given.kind, case), hidden.name)
        fractions.append(most)
        print(f"{n:3d} {hidden.name} [{hidden.sigma:.1f}] {text}", flush=True)
    print(f"any diagnosis: at most {sum(fractions):.1f} of {len(fractions)} first")


if __name__ == "__main__":
    main()
