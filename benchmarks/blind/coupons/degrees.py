"""Controls of verdicts in degrees, on made coupons: `python -m benchmarks.blind.coupons.degrees`.

smooth: nothing is hidden, but each record has a smooth error that nobody states; nothing may be named.
half: one cause of the library and one outside it, equally large; the one inside is to be named (or to come
nearest), and the interval of its share is to hold the true one.
without: one cause of the library, taken out of the catalogue; a stand-in may be named in part, and said so.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.coupons.cases import _hidden, make_coupon, write
from benchmarks.blind.coupons.model import LIBRARY, OUTSIDE, Case, Hidden, curve, errors
from benchmarks.blind.record_scores import named, named_set, part
from benchmarks.blind.under_test import diagnose_coupons

Array = NDArray[np.float64]

SMOOTH = (0.003, 0.01)  # of full scale: rms of an error that nobody states
SIZE = 25.0  # standard deviations of a cause
WAVES = 4


def smooth_error(folder: Path, seed: int) -> None:
    """Give each record of an experiment a smooth error of its own, and take the stated errors out."""
    rng = np.random.default_rng([seed, 7])
    size = float(np.exp(rng.uniform(*np.log(SMOOTH))))
    path = folder / "experiment.yaml"
    content = yaml.safe_load(path.read_text())
    for trial in content["trials"]:
        trial.pop("stress_sd_kPa", None)
        record = folder / trial["record"]
        head, *rows = record.read_text().splitlines()
        table = np.array([[float(x) for x in row.split(",")] for row in rows])
        x = np.linspace(0.0, 1.0, len(table))
        wave = sum(
            rng.standard_normal() * np.cos(np.pi * (k * x + rng.random())) for k in range(1, WAVES + 1)
        )
        wave *= size * np.abs(table[:, 1]).max() / float(np.sqrt(np.mean(wave**2)))
        table[:, 1] += wave
        record.write_text("\n".join([head, *(",".join(f"{v:.9g}" for v in row) for row in table)]) + "\n")
    path.write_text(yaml.safe_dump(content, sort_keys=False))


def half(seed: int) -> Case | None:
    """One cause of each sort in one experiment; None where the protocols cannot show both so large."""
    rng = np.random.default_rng([seed, 8])
    case = make_coupon(seed, "one", str(rng.choice(LIBRARY)), target=SIZE)
    for name in rng.permutation(OUTSIDE):
        other = _hidden(rng, str(name), case.protocols, SIZE)
        if other.sigma > 0.8 * SIZE:
            return replace(case, hidden=(*case.hidden, other))
    return None


def true_share(case: Case) -> float:
    """Of the explainable misfit, that the cause inside the library takes, to first order."""
    inside, outside = case.hidden
    free: dict[str, Array] = {}
    sizes = [len(p.path()[0]) for p in case.protocols]
    columns: dict[Hidden | None, list[Array]] = {inside: [], outside: []}
    first = 0
    for p, size in zip(case.protocols, sizes, strict=True):
        base, sd = curve(p, ()), errors(p)
        for h, parts in columns.items():
            assert h is not None
            parts.append((curve(p, (h,)) - base) / sd)
        free.setdefault(p.specimen or p.material, np.zeros(sum(sizes)))[first : first + size] = base / sd
        first += size
    moduli = np.column_stack(list(free.values()))
    one, other = (np.concatenate(parts) for parts in columns.values())
    whole = _left(moduli, one + other)
    rest = _left(np.column_stack([moduli, one]), other)
    return 1.0 - rest / whole


def _left(columns: Array, z: Array) -> float:
    q, _ = np.linalg.qr(columns)
    return float(z @ z - (q.T @ z) @ (q.T @ z))


def verdicts(control: str, count: int, seed: int) -> Iterator[tuple[Case, dict[str, Any]]]:
    made = number = 0
    while made < count:
        number += 1
        own = 1000 * seed + number
        case: Case | None
        if control == "smooth":
            case = make_coupon(own, "clean")
        elif control == "half":
            case = half(own)
        else:
            case = make_coupon(own, "one", target=SIZE)
        if case is None:
            continue
        made += 1
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(case, folder)
            if control == "smooth":
                smooth_error(folder, own)
            without = tuple(h.name for h in case.hidden) if control == "without" else ()
            yield case, diagnose_coupons(folder, without=without)


def survey(control: str, count: int, seed: int) -> None:
    """Print each verdict, and how often it is as it should be."""
    said: list[str] = []
    right, covered, alone = [], [], []
    for case, v in verdicts(control, count, seed):
        hidden = "+".join(h.name for h in case.hidden) or "-"
        nearest = v["nearest"] or {"causes": [], "share": None}
        shown = "+".join(named(v)) or "(" + "+".join(c["effect"] for c in nearest["causes"]) + ")"
        share = v["share"] or nearest["share"]
        print(f"  {case.seed} {hidden}: {v['verdict']} {shown} {v['alternatives'][1:]} {share}", flush=True)
        said.append(v["verdict"])
        alone.append(v["verdict"] == "found" and control == "without")
        if control == "half":
            sets = named_set(v) if v["causes"] else [tuple(c["effect"] for c in nearest["causes"])]
            right.append(any(case.hidden[0].name in s for s in sets))
            if right[-1] and share and share["low"] is not None and len(sets[0]) == 1:
                covered.append(share["low"] <= true_share(case) <= share["high"])
    print(f"{control}: {dict(Counter(said))}")
    if control == "smooth":
        print(f"  nothing named: goal 95 %, {part([s in ('none', 'unexplained') for s in said])}")
    if control == "half":
        print(f"  the cause inside named or nearest: {part(right)}; share in its interval: {part(covered)}")
    if control == "without":
        print(f"  a wrong name, alone and without 'partly': goal at most 5 %, {part(alone)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--control", choices=("smooth", "half", "without"), action="append")
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    for control in given.control or ("smooth", "half", "without"):
        survey(control, given.cases, given.seed)


if __name__ == "__main__":
    main()
