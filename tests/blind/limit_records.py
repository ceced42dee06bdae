"""How often any finder could rank the truth first: `python tests/blind/limit_records.py coupons --seed 9`.

Each case of one effect is written once more without noise. How much worse the nearest rival then fits than
the truth is the squared distance d^2 between what the two predict, in standard deviations of the noise.
Where both were as likely before, no rule picks the right one of them more often than in a part Phi(d/2) of
experiments (Neyman and Pearson); further rivals make it fewer. Distances are those of the finder's model:
of pokes they hold what the two solvers differ by, which is printed as the chi-square of the truth.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import _blind_coupon_draw
import _blind_coupon_file
import _blind_poke_draw
import _blind_poke_file

from calibration.diagnosis import Diagnosable
from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.explanation import explain
from calibration.diagnosis.null import Null
from calibration.diagnosis.pokes import PokeModel
from calibration.diagnosis.screening import screen
from calibration.diagnosis.search import calibrated
from calibration.experiment import read

PROMISING = 12  # candidates of each case that are fitted, those of the truth beside

# cases of a count and a seed; what writes one; what is calibrated
KINDS: dict[str, tuple[Callable[[int, int], Any], Callable[..., None], Callable[[Path], Diagnosable]]] = {
    "coupons": (
        _blind_coupon_draw.draw_cases,
        _blind_coupon_file.write,
        lambda folder: CouponModel(read(folder)),
    ),
    "pokes": (
        _blind_poke_draw.draw_cases,
        _blind_poke_file.write,
        lambda folder: PokeModel(read(folder), workers=1),
    ),
}


def fits(kind: str, case: Any) -> dict[str, float]:
    """Least chi-square of each effect on the case's data without noise."""
    _, write, model_of = KINDS[kind]
    truth = case.hidden[0].name
    with tempfile.TemporaryDirectory() as place:
        write(case, Path(place) / "experiment", noise=0.0)
        model = model_of(Path(place) / "experiment")
    baseline = calibrated(model)
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    null = Null(len(linear.z), model.patterns(), seed=0)
    gains, amplitudes = screened.gains(linear.z), screened.amplitudes(linear.z)
    least: dict[str, float] = {}
    for rank, k in enumerate(sorted(range(len(gains)), key=lambda k: -gains[k])):
        candidate = model.candidates[k]
        if rank >= PROMISING and candidate.effect != truth:
            continue
        found = explain(model, baseline, (candidate,), [float(amplitudes[k])], null)
        if found is not None:
            least[candidate.effect] = min(found.fit.chi2, least.get(candidate.effect, math.inf))
    return least


def chance(nearest: float) -> float:
    """Part of experiments in which the truth outdoes a rival whose chi-square without noise is this much
    larger."""
    return 0.5 * (1.0 + math.erf(math.sqrt(max(nearest, 0.0) / 8.0)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=list(KINDS))
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--least", type=float, default=5.0, help="sigmas")
    given = parser.parse_args()
    chances = []
    for n, case in enumerate(KINDS[given.kind][0](given.cases, given.seed)):
        if case.kind != "one" or case.hidden[0].sigma < given.least:
            continue
        hidden = case.hidden[0]
        least = fits(given.kind, case)
        own = least.pop(hidden.name)
        near = sorted((chi2 - own, name) for name, chi2 in least.items())[:3]
        chances.append(chance(near[0][0]) if near else 1.0)
        rivals = ", ".join(f"{name} {d2:.2f}" for d2, name in near)
        print(
            f"{n:3d} {hidden.name} [{hidden.sigma:.1f}] chi-square {own:.1f}: {rivals};"
            f" first in {chances[-1]:.0%}",
            flush=True,
        )
    print(f"any finder: at most {sum(chances):.1f} of {len(chances)} first")


if __name__ == "__main__":
    main()
