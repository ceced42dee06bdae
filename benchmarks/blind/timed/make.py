"""Write synthetic experiments on time-dependent materials, each with its truth beside it.

    python -m benchmarks.blind.timed.make coupons --seeds 1 2 3 --out DIR
    python -m benchmarks.blind.timed.make coupons --parts fibres prony --seeds 4 --out DIR
    python -m benchmarks.blind.timed.make beams --seeds 1 --out DIR          # some 20 s of CPU an experiment
    python -m benchmarks.blind.timed.make indentation --seeds 1 --out DIR    # stored forces

An experiment is a folder `DIR/KIND-SEED` (docs/reference/experiment-format.md). No command under test reads
its `truth.yaml`, which holds the material's law and parts in SI units, and the true sizes of beams. The
forces of indentations are computed by `benchmarks.blind.timed.solve_indentation`, which needs FElupe, and
stored in `indentation.json`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.blind.timed.cases import KINDS, PARTS, Case, draw_coupons, write


def drawn(kind: str, seed: int, parts: Sequence[str] | None) -> Case:
    """Case of a seed; `parts` applies to coupons only."""
    return draw_coupons(seed, parts) if kind == "coupons" and parts is not None else KINDS[kind](seed)


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=list(KINDS))
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--parts", nargs="*", choices=PARTS, help="of coupons: default prony mullins")
    parser.add_argument("--noise", type=float, default=1.0, help="part of the stated noise")
    given = parser.parse_args(argv)
    if given.parts is not None and given.kind != "coupons":
        parser.error("--parts: expected with coupons only")
    for seed in given.seeds:
        folder = given.out / f"{given.kind}-{seed}"
        if folder.exists():
            print(f"{folder}: expected no such folder; remove it to make it anew", file=sys.stderr)
            return 2
        try:
            write(drawn(given.kind, seed, given.parts), folder, noise=given.noise)
        except KeyError as error:
            print(error.args[0], file=sys.stderr)
            return 2
        print(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
