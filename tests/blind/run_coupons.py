"""Made coupon experiments, handed to the diagnosis without their truth: `python tests/blind/run_coupons.py`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth never leaves this
process's memory.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from _blind_coupon_draw import draw_cases
from _blind_coupon_maker import Case, Protocol, until_it_locks, write
from _blind_coupon_score import Pair, confusion, goals, named, part, true_names
from _blind_coupon_verdict import verdict_on

SAME_TESTS = (
    "further",
    "twice",
    "to-the-end",
    "unload",
    "second-cycle",
    "faster",
)  # each trial once more, in another way


def run(count: int, seed: int, *, tell: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    pairs: list[Pair] = []
    for n, case in enumerate(draw_cases(count, seed)):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(case, folder)
            began = time.perf_counter()
            said = verdict_on(folder)
            seconds = time.perf_counter() - began
        truth = case.truth()
        pairs.append((truth, said))
        if tell:
            sizes = ", ".join(f"{e['sigma']:.1f}" for e in truth["effects"])
            print(
                f"{n:3d} {'+'.join(true_names(truth)) or 'clean'} [{sizes}]: {said['verdict']}"
                f" {'+'.join(named(said))} {said['alternatives'][1:]} {seconds:.1f} s",
                flush=True,
            )
    return pairs


def settle(pairs: list[Pair], cases: list[Case]) -> list[tuple[str, str, bool | None]]:
    """(cause, advised experiment, whether it settled the case) of the ambiguous cases of one cause: the
    experiment is made of the same specimens, and the diagnosis told of old and new trials. None: what is
    advised is a direct measurement, which no coupon file can hold."""
    found: list[tuple[str, str, bool | None]] = []
    for (truth, said), case in zip(pairs, cases, strict=True):
        if case.kind != "one" or said["verdict"] != "ambiguous":
            continue
        cause = "+".join(true_names(truth))
        name = str(said["next"])
        new: dict[str, Protocol] = {}
        for p in case.protocols:
            if (made := p.again(name)) is not None:
                made = until_it_locks(made, case.hidden)
                new.setdefault(made.id if name in SAME_TESTS else f"{p.specimen or p.material}", made)
        if not new:
            found.append((cause, name, None))
            continue
        both = replace(case, protocols=(*case.protocols, *new.values()))
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(both, folder)
            then = verdict_on(folder)
        right = named(then) == true_names(truth) and then["verdict"] == "found"
        found.append((cause, name, right))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="JSON file for truths and verdicts")
    parser.add_argument("--settle", action="store_true", help="simulate the experiments that are advised")
    asked = parser.parse_args()
    pairs = run(asked.cases, asked.seed)
    if asked.out:
        asked.out.write_text(json.dumps([{"truth": t, "verdict": v} for t, v in pairs], indent=1))
    print()
    print(confusion(pairs))
    print()
    for what, goal, reached in goals(pairs):
        print(f"{what:60} goal {goal:12} {reached}")
    if asked.settle:
        settled = settle(pairs, draw_cases(asked.cases, asked.seed))
        for cause, name, right in settled:
            print(f"  {cause}: {name}: {'direct measurement' if right is None else right}")
        made = [right for _, _, right in settled if right is not None]
        print(f"{'advised tests that settle an ambiguous case':60} goal {'90 %':12} {part(made)}")


if __name__ == "__main__":
    main()
