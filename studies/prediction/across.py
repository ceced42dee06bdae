"""Relaxation found in one kind of measurement predicts the creep of beams: made data of another solver.

    python -m studies.prediction.across together --seeds 1 2 --out DIR              # coupons -> beams
    python -m studies.prediction.across pushed-and-hung --seeds 15 20 --out DIR     # indentation -> beams

Experiments are those of `benchmarks.blind.timed` (beams of its own finite elements, photographed at eight
times from 0.3 to 1000 s; indentation by FElupe). The trials of the first kind are diagnosed, what is named is
handed on as a card, and the card predicts the photographs of the beams, beside the elastic baseline of the
same fit.
A row a seed: rms of the registered outlines in mm, all photographs together.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import calibration
from benchmarks.blind.timed.cases import KINDS, write

FITTED = {"together": "relaxation,shear", "pushed-and-hung": "ball,thick"}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kind", choices=list(FITTED))
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    for seed in given.seeds:
        folder = given.out / f"{given.kind}-{seed}"
        if not folder.exists():
            write(KINDS[given.kind](seed), folder)
        found = calibration.predict(
            folder,
            calibrate=FITTED[given.kind],
            predict="cantilever*,bridge*",
            workers=1,
            on_progress=lambda p: print(p, flush=True),
        )
        found.write(given.out / f"{given.kind}-{seed}.prediction")
        print(found, *found.prediction.notes, sep="\n", flush=True)


if __name__ == "__main__":
    main()
