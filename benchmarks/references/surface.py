"""Reference surface beside a normal poke to 20 mm of 32, by the model of poke.py; writes surface.json.

    python -m benchmarks.references.surface --laws neo_hookean ogden --levels 2 3      # 3 and 5 minutes each

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Flat rod, friction 0.6, K/mu 20. The surface beside the rod asks for more than the force: a contact of 2e10
Pa/m, since a soft friction spring lets the surface rise (6e9: by 0.1 mm at 10 mm); short steps, since a
point sticks from the end of the step in which it touches; and level 3, since level 1 is 0.1 mm too low
(studies/depth).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.poke import Case, poke
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]
FILE = Path(__file__).with_suffix(".json")
DEPTHS = (0.001, 0.002, 0.005, 0.010, 0.015, 0.020)
LAWS, FRICTION, PENALTY = ("neo_hookean", "ogden"), 0.6, 2e10
STEPS = {1: 5e-5, 2: 5e-5, 3: 1e-4}  # by level [m]; with 1e-4, level 2 ends at 15 mm
FARTHEST = 0.047  # radius at rest [m]


def surface(law: str, level: int) -> dict[str, dict[str, list[float]]]:
    """By depth [mm]: radii at rest, displacements outwards and up [mm, to the nearest 0.01 um]."""
    found: dict[str, dict[str, list[float]]] = {}

    def see(depth: float, radius: Array, moved: Array) -> None:
        near = radius < FARTHEST
        columns = 1e3 * np.column_stack([radius[near], moved[near]])
        names = ("radius", "outwards", "up")
        found[f"{depth * 1e3:g}"] = {
            name: np.round(column, 5).tolist() for name, column in zip(names, columns.T, strict=True)
        }

    poke(FRICTION, level, PENALTY, Case(law=law, depths=DEPTHS), largest_step=STEPS[level] * level, see=see)
    return found


def write(found: dict[str, Any]) -> None:
    """Write surface.json."""
    about = {
        "units": "mm",
        "model": "benchmarks/references/poke.py",
        "felupe": fe.__version__,
        "values": "law: level: depth: radius at rest, displacement outwards and up",
    }
    write_whole(FILE, json.dumps({"about": about, "values": found}) + "\n")


def main() -> None:
    """Solve what is asked for and is not in surface.json yet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--laws", nargs="+", choices=LAWS, default=list(LAWS))
    parser.add_argument("--levels", type=int, nargs="+", choices=sorted(STEPS), default=[2, 3])
    args = parser.parse_args()
    for law in args.laws:
        for level in args.levels:
            found: dict[str, Any] = json.loads(FILE.read_text())["values"] if FILE.exists() else {}
            if str(level) in found.get(law, {}):
                continue
            made = surface(law, level)
            found = json.loads(FILE.read_text())["values"] if FILE.exists() else {}
            found.setdefault(law, {})[str(level)] = made
            write(found)


if __name__ == "__main__":
    main()
