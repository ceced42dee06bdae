"""Size of a hidden effect in the diagnosis under test if the photographs have no noise.

    python -m benchmarks.blind.beams.noise_free --only 1,4,8,40      # some 10 core-s a case
    python -m benchmarks.blind.beams.noise_free --alternatives --only 82   # fits them too, 60 core-s

Contour and registration noise are omitted from the photographs, but not from the statistical model of the
diagnosis: the output is the effect itself and the difference of the two solvers, in standard deviations of
the diagnosis.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.blind.beams.experiment import write_experiment
from benchmarks.blind.beams.store import CASES, load_case, load_truth
from benchmarks.blind.limits import summary
from benchmarks.blind.under_test import noise_free_fits, screen_beams


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=Path, default=CASES)
    parser.add_argument("--only", required=True, help="indices of cases, by commas")
    parser.add_argument("--alternatives", action="store_true", help="fit the nearest alternatives too")
    given = parser.parse_args()
    truth = load_truth(given.cases)["cases"]
    for index in map(int, given.only.split(",")):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write_experiment(*load_case(given.cases, index), folder, noise=False)
            _show(index, truth[f"{index:03d}"], folder, alternatives=given.alternatives)


def _show(index: int, truth: dict[str, Any], folder: Path, *, alternatives: bool) -> None:
    if alternatives:
        effect = truth["hidden"][0]["effect"]
        print(
            f"{index:03d} {effect} {summary(noise_free_fits('beams', folder, effect), effect)[0]}", flush=True
        )
        return
    found = screen_beams(folder)
    label, size = found.best
    print(f"{index:03d} chi-square {found.chi2:.1f}; most: {label} {size:.1f}", flush=True)
    for hidden in truth["hidden"]:
        name, scope = hidden["effect"], hidden["scope"]
        if own := [s for effect, at, s in found.sizes if effect == name and scope in (at, "bridges")]:
            blind = truth["sigma"][name]
            print(f"    {name} of {scope}: {max(own):.1f} sigmas, blind count {blind}")


if __name__ == "__main__":
    main()
