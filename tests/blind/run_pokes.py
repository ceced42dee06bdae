"""Made poke experiments, handed to the diagnosis without their truth: `python tests/blind/run_pokes.py`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth never leaves this
process's memory.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

from _blind_poke_draw import draw_cases
from _blind_poke_maker import write
from _blind_poke_score import Pair, confusion, goals, named, true_names
from _blind_poke_verdict import verdict_on


def run(count: int, seed: int, *, only: slice = slice(None), tell: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    pairs: list[Pair] = []
    for n, case in list(enumerate(draw_cases(count, seed)))[only]:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(case, folder)
            began = time.process_time()
            said = verdict_on(folder)
            seconds = time.process_time() - began
        truth = case.truth()
        pairs.append((truth, said))
        if tell:
            sizes = ", ".join(f"{e['sigma']:.1f} {e['scope']}" for e in truth["effects"])
            print(
                f"{n:3d} {truth['kind']} {'+'.join(true_names(truth)) or '-'} [{sizes}]: {said['verdict']}"
                f" {'+'.join(c['label'] for c in said['causes'])} {said['alternatives'][1:]}"
                f" {seconds:.1f} core-s, {said['simulated']} pokes simulated",
                flush=True,
            )
            if named(said) != true_names(truth):
                print(f"      departure {said['departure']}, tried {said['tried'][:4]}", flush=True)
    return pairs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="case to begin with")
    parser.add_argument("--last", type=int, default=None, help="case to end before")
    parser.add_argument("--out", type=Path, help="JSON file for truths and verdicts")
    asked = parser.parse_args()
    pairs = run(asked.cases, asked.seed, only=slice(asked.first, asked.last))
    if asked.out:
        asked.out.write_text(json.dumps([{"truth": t, "verdict": v} for t, v in pairs], indent=1))
    print()
    print(confusion(pairs))
    print()
    for what, goal, reached in goals(pairs):
        print(f"{what:60} goal {goal:12} {reached}")


if __name__ == "__main__":
    main()
