"""How often any diagnosis could rank the truth first: `python -m benchmarks.blind.limits coupons --seed 9`.

Each case of one effect is written once more without noise. How much worse the nearest alternative then fits
than the truth is the squared distance d^2 between their predictions, in standard deviations of the noise.
Where both were as likely before, no rule picks the right one of them in more than a fraction Phi(d/2) of
experiments (Neyman and Pearson); further alternatives make it fewer. Distances are those of the diagnosis'
model: of indentations they contain the difference of the two solvers, which is printed as the chi-square of
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

# cases of a count and a seed, and the function that writes one
KINDS: dict[str, tuple[Callable[[int, int], Any], Callable[..., None]]] = {
    "coupons": (coupons.draw_cases, coupons.write),
    "indentation": (indentation.draw_cases, indentation.write),
}


def fits(kind: str, case: Any) -> dict[str, float]:
    """Least chi-square of each effect on the case's data without noise."""
    _, write = KINDS[kind]
    with tempfile.TemporaryDirectory() as place:
        write(case, Path(place) / "experiment", noise=0.0)
        return noise_free_fits(kind, Path(place) / "experiment", case.hidden[0].name)


def summary(least: dict[str, float], truth: str) -> tuple[str, float]:
    """The nearest alternatives as text, and the largest fraction of experiments in which any rule ranks the
    truth first."""
    own = least[truth]
    near = sorted((chi2 - own, name) for name, chi2 in least.items() if name != truth)[:3]
    most = largest_fraction(near[0][0]) if near else 1.0
    others = ", ".join(f"{name} {d2:.2f}" for d2, name in near)
    return f"chi-square {own:.1f}: {others}; first in {most:.0%}", most


def largest_fraction(nearest: float) -> float:
    """Fraction of experiments in which the truth outdoes an alternative whose noise-free chi-square is larger
    by `nearest`."""
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
