"""Diagnose synthetic compression tests and count the verdicts: `python -m benchmarks.blind.compression.run`.

Noise is 0.1 to 0.6 % of the largest stress; bonded data are FElupe's. Seeds are fixed. 12 cases of each kind
take a core-minute.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.blind.compression.cases import KINDS, SHEAR_MODULI, draw, write
from benchmarks.blind.under_test import diagnose_compression


def survey(kind: str, cases: int) -> tuple[Counter[str], float]:
    """Counts of the verdicts, and the largest relative error of a shear modulus."""
    counts: Counter[str] = Counter()
    largest = 0.0
    for number in range(cases):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(draw(kind, number), folder)
            found = diagnose_compression(folder)
        named = " or ".join(" + ".join(names) for names in found["alternatives"])
        counts[f"{found['verdict']} {named}".strip()] += 1
        moduli = (found["extended"] or found["baseline"])["shear_modulus_Pa"]
        largest = max(largest, *(abs(g / SHEAR_MODULI[m] - 1.0) for m, g in moduli.items()))
    return counts, largest


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=12, help="of each kind")
    parser.add_argument("--kind", choices=list(KINDS), action="append", help="only this (several times)")
    given = parser.parse_args()
    for kind in given.kind or KINDS:
        counts, largest = survey(kind, given.cases)
        print(
            f"{kind} ({KINDS[kind][0]}):",
            dict(counts),
            f"moduli off by {100 * largest:.1f} % at most",
            flush=True,
        )


if __name__ == "__main__":
    main()
