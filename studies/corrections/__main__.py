"""What the corrections are worth: the modulus error that each shortcut alone causes (README.md beside it).

python -m studies.corrections            (all of it: about a quarter of an hour of one core)
python -m studies.corrections default linear faceted stop picture     (those parts)

The made experiment is datasets/measured/bench/clean. Its truth.yaml
is read for the percentages alone. Tables go into README.md between their markers, and the picture
is drawn from what stands there.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

from studies.corrections.page import picture, write_table
from studies.corrections.parts import default, faceted, linear
from studies.corrections.stopping import stop

FIT_HEAD = ("mixture", "simulated with", "error [%]", "rms [mm]")
STOP_HEAD = ("mixture", "damping [1/s] / [s]", "least squares: error [%]", "50 mm alone", "100 mm", "150 mm",
             "rms [mm]")  # fmt: skip
PARTS: dict[str, tuple[Sequence[str], Callable[[], list[list[str]]]]] = {
    "default": (FIT_HEAD, default),
    "linear": (FIT_HEAD, linear),
    "faceted": (FIT_HEAD, faceted),
    "stop": (STOP_HEAD, stop),
}


def main() -> None:
    wanted = sys.argv[1:] or [*PARTS, "picture"]
    if unknown := [name for name in wanted if name not in (*PARTS, "picture")]:
        raise SystemExit(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}, picture")
    for name in wanted:
        if name == "picture":
            picture()
            continue
        head, make = PARTS[name]
        write_table(name, head, make())


if __name__ == "__main__":
    main()
