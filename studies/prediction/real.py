"""Real trials that were not used, predicted: prints the rows of the table of real data.

    TISIM_MEASURED=FOLDER python -m studies.prediction.real [NAME ...] [--given] [--out DIR]

Names: treloar, meunier (fit in tension, predict the other modes), ecoflex (fit to three repeats of
a cylinder, predict the next two). The data are not in the repository. With --given the cause
is stated, the one that sources name for such data, and not searched for.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import calibration
from studies.measured import real

CASES = {
    "treloar": (
        ("rubber-multiaxial", "treloar-1944"),
        "mode=uniaxial",
        "mode=planar,mode=equibiaxial",
        "limited-extensibility",
    ),
    "meunier": (
        ("rubber-multiaxial", "meunier-2008-silicone"),
        "mode=uniaxial",
        "mode=planar,mode=equibiaxial",
        "limited-extensibility",
    ),
    "ecoflex": (
        ("silicone-compression", "experiment"),
        "EF30-0T-A1,EF30-0T-A2,EF30-0T-A3",
        "EF30-0T-A4,EF30-0T-A5",
        "platen-bonding",
    ),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", default=list(CASES), metavar="NAME")
    parser.add_argument("--given", action="store_true")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    for name in given.names:
        where, fitted, wanted, cause = CASES[name]
        found = calibration.predict(
            real(*where),
            calibrate=fitted,
            predict=wanted,
            extend=(cause,) if given.given else (),
            workers=1,
            on_progress=lambda p: print(p, flush=True),
        )
        if given.out:
            found.write(given.out / name)
        print(name, found, *found.prediction.notes, sep="\n", flush=True)


if __name__ == "__main__":
    main()
