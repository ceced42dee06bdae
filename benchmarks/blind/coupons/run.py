"""Diagnose synthetic homogeneous material tests and score them: `python -m benchmarks.blind.coupons.run`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth stays in memory
until all cases are diagnosed.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

from benchmarks.blind.coupons.cases import draw_cases, make_coupon, write
from benchmarks.blind.coupons.model import Case, Protocol, until_it_locks
from benchmarks.blind.record_scores import Pair, diagnosed, named, named_set, parser, part, show, true_names
from benchmarks.blind.records import draw_several
from benchmarks.blind.under_test import diagnose_coupons

# tests that repeat each trial with another protocol
SAME_TESTS = ("further", "twice", "to-the-end", "unload", "second-cycle", "faster")


def run(count: int, seed: int, *, show_each: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    return diagnosed(enumerate(draw_cases(count, seed)), write, diagnose_coupons, show_each=show_each)


def settle(pairs: list[Pair], cases: list[Case]) -> list[tuple[str, str, bool | None]]:
    """(cause, advised experiment, True if it settled the case) of the ambiguous cases of one cause.

    The experiment is simulated with the same specimens; old and new trials are diagnosed together. The last
    entry is None if the advice is a direct measurement, which no coupon file can contain.
    """
    found: list[tuple[str, str, bool | None]] = []
    for (truth, diagnosis), case in zip(pairs, cases, strict=True):
        if case.kind != "one" or diagnosis["verdict"] != "ambiguous":
            continue
        cause = "+".join(true_names(truth))
        name = str(diagnosis["next"])
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
            then = diagnose_coupons(folder)
        right = named(then) == true_names(truth) and then["verdict"] == "found"
        found.append((cause, name, right))
    return found


def without_truth(pairs: list[Pair], cases: list[Case]) -> list[Pair]:
    """Pairs of truth (with its diagnosis) and verdict without the true effect, for cases of one cause."""
    found: list[Pair] = []
    for (truth, diagnosis), case in zip(pairs, cases, strict=True):
        if case.kind == "one":
            with tempfile.TemporaryDirectory() as place:
                write(case, Path(place) / "experiment")
                then = diagnose_coupons(Path(place) / "experiment", without=true_names(truth))
            found.append(({**truth, "diagnosis": diagnosis}, then))
    return found


def show_without(pairs: list[Pair]) -> None:
    """Print how often a cause outside the catalogue is unexplained, or named as one of its equivalents."""
    right = [
        v["verdict"] in ("unexplained", "partly explained") or named(v) in named_set(t["diagnosis"])
        for t, v in pairs
    ]
    stand_in = [v["verdict"] == "partly explained" for _, v in pairs]
    alone = [v["verdict"] == "found" and not ok for (_, v), ok in zip(pairs, right, strict=True)]
    what = "truth not in the library: unexplained, in part, or a listed alternative"
    print(f"{what:60} goal {'all':12} {part(right)}")
    print(f"{'truth not in the library: partly explained by a stand-in':60} goal {'-':12} {part(stand_in)}")
    print(f"{'truth not in the library: another name, alone':60} goal {'0':12} {part(alone)}")


def main() -> None:
    options = parser(__doc__)
    options.add_argument("--settle", action="store_true", help="simulate the experiments that are advised")
    options.add_argument("--without-truth", action="store_true", help="once more without the true effect")
    asked = options.parse_args()
    if asked.together:
        cases = draw_several(asked.cases, asked.seed, make_coupon, asked.together)
        show(diagnosed(enumerate(cases), write, diagnose_coupons, show_each=True), asked.out)
        return
    pairs = run(asked.cases, asked.seed)
    show(pairs, asked.out)
    if asked.without_truth:
        show_without(without_truth(pairs, draw_cases(asked.cases, asked.seed)))
    if asked.settle:
        settled = settle(pairs, draw_cases(asked.cases, asked.seed))
        for cause, name, right in settled:
            print(f"  {cause}: {name}: {'direct measurement' if right is None else right}")
        made = [right for _, _, right in settled if right is not None]
        print(f"{'advised tests that settle an ambiguous case':60} goal {'90 %':12} {part(made)}")


if __name__ == "__main__":
    main()
