"""How often any finder could rank the truth first: `python tests/blind/limit_records.py coupons --seed 9`.

Each case of one effect is written once more without noise. How much worse the nearest rival then fits than
the truth is the squared distance d^2 between what the two predict, in standard deviations of the noise.
Where both were as likely before, no rule picks the right one of them more often than in a part Phi(d/2) of
experiments (Neyman and Pearson); further rivals make it fewer. Distances are those of the finder's model:
of pokes they hold what the two solvers differ by, which is printed as the chi-square of the truth.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import _blind_coupon_draw
import _blind_coupon_file
import _blind_poke_draw
import _blind_poke_file
from _blind_limit import least_fits, told

from calibration.diagnosis import Diagnosable
from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.pokes import PokeModel
from calibration.experiment import read

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
    with tempfile.TemporaryDirectory() as place:
        write(case, Path(place) / "experiment", noise=0.0)
        model = model_of(Path(place) / "experiment")
    return least_fits(model, case.hidden[0].name)


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
        text, most = told(fits(given.kind, case), hidden.name)
        chances.append(most)
        print(f"{n:3d} {hidden.name} [{hidden.sigma:.1f}] {text}", flush=True)
    print(f"any finder: at most {sum(chances):.1f} of {len(chances)} first")


if __name__ == "__main__":
    main()
