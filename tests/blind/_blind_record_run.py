"""Made experiments handed to a diagnosis without their truth, one after the other, and what came of it."""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Protocol, TypeVar

from _blind_record_case import SEVERAL
from _blind_record_score import Pair, confusion, goals, named, true_names


class Made(Protocol):
    """A case."""

    def truth(self) -> dict[str, Any]: ...


C = TypeVar("C", bound=Made)


def diagnosed(
    cases: Iterable[tuple[int, C]],
    write: Callable[[C, Path], None],
    verdict_on: Callable[[Path], dict[str, Any]],
    *,
    tell: bool,
) -> list[Pair]:
    """(truth, verdict) of each numbered case; only `write` is given the case."""
    pairs: list[Pair] = []
    for n, case in cases:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(case, folder)
            began = time.process_time()
            said = verdict_on(folder)
            seconds = time.process_time() - began
        truth = case.truth()
        pairs.append((truth, said))
        if tell:
            _tell(n, truth, said, seconds)
    return pairs


def _tell(n: int, truth: dict[str, Any], said: dict[str, Any], seconds: float) -> None:
    sizes = ", ".join(f"{e['sigma']:.1f} {e['scope']}" for e in truth["effects"])
    cost = f", {said['simulated']} pokes simulated" if "simulated" in said else ""
    print(
        f"{n:3d} {truth['kind']} {'+'.join(true_names(truth)) or '-'} [{sizes}]: {said['verdict']}"
        f" {'+'.join(c['label'] for c in said['causes'])} {said['alternatives'][1:]}"
        f" {seconds:.1f} core-s{cost}",
        flush=True,
    )
    if named(said) != true_names(truth):
        print(f"      departure {said['departure']}, tried {said['tried'][:4]}", flush=True)


def parser(about: str | None) -> argparse.ArgumentParser:
    found = argparse.ArgumentParser(description=about)
    found.add_argument("--cases", type=int, default=40)
    found.add_argument("--seed", type=int, default=1)
    found.add_argument("--out", type=Path, help="JSON file for truths and verdicts")
    found.add_argument("--together", choices=list(SEVERAL), help="so many causes at once, in all cases")
    return found


def show(pairs: list[Pair], out: Path | None) -> None:
    """Confusion matrix and goals; pairs to a file where one is asked for."""
    if out:
        out.write_text(json.dumps([{"truth": t, "verdict": v} for t, v in pairs], indent=1))
    print()
    print(confusion(pairs))
    print()
    for what, goal, reached in goals(pairs):
        print(f"{what:60} goal {goal:12} {reached}")
