"""Made coupon experiments, handed to the diagnosis without their truth: `python tests/blind/run_coupons.py`.

Prints each case, the confusion matrix and the goals. Cases are drawn from --seed; the truth never leaves this
process's memory.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

from _blind_coupon_case import Case, Protocol
from _blind_coupon_curve import until_it_locks
from _blind_coupon_draw import draw_cases, make_coupon
from _blind_coupon_file import write
from _blind_coupon_verdict import verdict_on
from _blind_record_case import draw_several
from _blind_record_run import diagnosed, parser, show
from _blind_record_score import Pair, named, named_set, part, true_names

# each trial once more, in another way
SAME_TESTS = ("further", "twice", "to-the-end", "unload", "second-cycle", "faster")


def run(count: int, seed: int, *, tell: bool = True) -> list[Pair]:
    """(truth, verdict) of each case."""
    return diagnosed(enumerate(draw_cases(count, seed)), write, verdict_on, tell=tell)


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


def without_truth(pairs: list[Pair], cases: list[Case]) -> list[Pair]:
    """(truth with what was said of it, verdict without the true effect in the catalogue), cases of one."""
    found: list[Pair] = []
    for (truth, said), case in zip(pairs, cases, strict=True):
        if case.kind == "one":
            with tempfile.TemporaryDirectory() as place:
                write(case, Path(place) / "experiment")
                then = verdict_on(Path(place) / "experiment", without=true_names(truth))
            found.append(({**truth, "said": said}, then))
    return found


def show_without(pairs: list[Pair]) -> None:
    """How often what is not in the catalogue is unexplained, or said to be what it could not be told from."""
    right = [v["verdict"] == "unexplained" or named(v) in named_set(t["said"]) for t, v in pairs]
    alone = [v["verdict"] == "found" and not ok for (_, v), ok in zip(pairs, right, strict=True)]
    print(f"{'truth not in the library: unexplained or a listed rival':60} goal {'all':12} {part(right)}")
    print(f"{'truth not in the library: another name, alone':60} goal {'0':12} {part(alone)}")


def main() -> None:
    options = parser(__doc__)
    options.add_argument("--settle", action="store_true", help="simulate the experiments that are advised")
    options.add_argument("--without-truth", action="store_true", help="once more without the true effect")
    asked = options.parse_args()
    if asked.together:
        cases = draw_several(asked.cases, asked.seed, make_coupon, asked.together)
        show(diagnosed(enumerate(cases), write, verdict_on, tell=True), asked.out)
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
