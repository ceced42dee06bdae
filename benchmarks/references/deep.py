"""Reference force of normal pokes to 20 mm of 32, by the model of poke.py; writes deep.json beside this file.

    python -m benchmarks.references.deep "flat neo_hookean K/mu 20 friction 0.6"           # minutes each
    python -m benchmarks.references.deep --list

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Disc of radius 50 mm and height 32 mm, base fixed, side free, mu = 30 kPa; rod of 2.5 mm radius, flat with an
edge radius of 1 mm, or a hemisphere. Each case at levels 1 and 2, each with contact stiffnesses of 6e9, 1e10
and 2e10 Pa/m, as deep as each goes: through a soft contact the rod's edge sinks in. `poke.estimate` says what
they come to for a rigid contact, and the error of that.
"""

from __future__ import annotations

import argparse
import itertools
import json
from pathlib import Path
from typing import Any

import felupe as fe

from benchmarks.references.poke import MU, PENALTY, Case, estimate, poke
from benchmarks.whole import write_whole

FILE = Path(__file__).with_suffix(".json")
DEPTHS = (0.001, 0.002, 0.005, 0.010, 0.012, 0.015, 0.017, 0.019, 0.020)
RATIOS, FRICTIONS = (20.0, 300.0), (0.0, 0.3, 0.6)
BETWEEN = (0.15, 0.45)  # coefficients of friction of two more cases
RUNS = tuple(itertools.product((1, 2), (PENALTY, 1e10, 2e10)))  # level, contact stiffness [Pa/m]


def cases() -> dict[str, tuple[Case, float]]:
    """Case and friction of each name."""
    out = {}
    every = itertools.product(("flat", "hemisphere"), ("neo_hookean", "ogden"), RATIOS, FRICTIONS)
    for tip, law, ratio, friction in every:
        name = f"{tip} {law} K/mu {ratio:g} friction {friction:g}"
        out[name] = Case(tip=tip, law=law, bulk=ratio * MU, depths=DEPTHS), friction
    for friction in BETWEEN:
        out[f"flat neo_hookean K/mu 20 friction {friction:g}"] = Case(depths=DEPTHS), friction
    return out


def write(found: dict[str, Any]) -> None:
    """Write deep.json."""
    about = {
        "units": "m, N, Pa; depths in mm",
        "model": "benchmarks/references/poke.py",
        "felupe": fe.__version__,
        "values": "case: depth: rigid contact, estimated from the runs",
        "forces": "case: level[, contact stiffness]: depth: what was computed",
    }
    values = estimate(found, DEPTHS)
    write_whole(FILE, json.dumps({"about": about, "values": values, "forces": found}, indent=1) + "\n")


def main() -> None:
    """Solve the cases asked for that are not in deep.json yet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--list", action="store_true", help="print the names of all cases")
    args = parser.parse_args()
    known = cases()
    if args.list:
        print("\n".join(known))
        return
    for name in args.names:
        if name not in known:
            parser.error(f"unknown case {name!r}; --list prints them")
    for name, (level, penalty) in itertools.product(args.names, RUNS):
        case, friction = known[name]
        found: dict[str, Any] = json.loads(FILE.read_text())["forces"] if FILE.exists() else {}
        key = f"{level}" if penalty == PENALTY else f"{level}, penalty {penalty:g}"
        if key in found.get(name, {}):
            continue
        print(name, flush=True)
        run = poke(friction, level, penalty, case)
        found = json.loads(FILE.read_text())["forces"] if FILE.exists() else {}
        found.setdefault(name, {})[key] = run
        write(found)


if __name__ == "__main__":
    main()
