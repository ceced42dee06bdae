"""Diagnose the blind beam experiments, and score the verdicts.

    python -m benchmarks.blind.beams.run --out FOLDER              # the whole set, each by the command line
    python -m benchmarks.blind.beams.run --out FOLDER --in-process --jobs 2 --workers 1 --given-cause \\
        --advice --control without-truth --control shuffled        # with all further scores
    python -m benchmarks.blind.beams.run --out FOLDER --score      # only score the verdicts in FOLDER

Each diagnosis is given the experiment in a temporary folder, never the truth. An interrupted run resumes:
each verdict is stored in OUT, in one file per kind, and is not computed again. Beams photographed in another
pose on advice are diagnosed in this process, since the command line accepts no pose.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.blind.beams.controls import (
    advice_goals,
    advice_table,
    asked,
    control_goals,
    control_table,
    follow,
    shuffle_materials,
    shuffled,
    without_truth,
)
from benchmarks.blind.beams.experiment import write_experiment
from benchmarks.blind.beams.held_out import gain_goals, gain_table, large
from benchmarks.blind.beams.scores import Goal, Scored, by_size, confusion, goals, scope_goals
from benchmarks.blind.beams.store import CASES, load_case, load_truth
from benchmarks.blind.under_test import Diagnoser, NotDiagnosedError, Verdict, VerdictFile, catalogue

CONTROLS = ("without-truth", "shuffled")
KINDS = ("verdicts", "given-cause", "advised", *CONTROLS)
Answer = tuple[str, Verdict | None, str, float]  # case, its diagnosis, why there is none, seconds


@dataclass(frozen=True, kw_only=True)
class Run:
    """A run of diagnoses over stored cases.

    Attributes
    ----------
    cases : folder of the cases.
    truth : entries of truth.json by case.
    finder : the diagnosis.
    kept : stored answers by kind of question.
    gain_from : size [sigma] from which the held-out gain is measured.
    jobs : number of cases diagnosed at once.
    """

    cases: Path
    truth: dict[str, Any]
    finder: Diagnoser
    kept: dict[str, VerdictFile]
    gain_from: float  # size in sigmas from which the held-out gain is measured
    jobs: int = 1  # cases at once

    def scored(self, wanted: Iterable[str]) -> dict[str, Scored]:
        known = self.kept["verdicts"].answers
        return {k: Scored(self.truth[k], known[k]) for k in wanted if k in known}

    def ask(self, key: str, kind: str, folder: Path) -> Verdict:
        """Answer to one kind of question about a case, whose experiment is written to `folder`."""
        case, edges = load_case(self.cases, int(key))
        write_experiment(case, edges, folder)
        effects = tuple(h.effect for h in case.hidden)
        if kind == "given-cause":
            others = [name for name in catalogue() if name not in effects]
            return self.finder(folder, without=others, gain=True)
        if kind == "advised":
            return follow(case, self.kept["verdicts"].answers[key], folder, self.finder)
        if kind == "without-truth":
            return self.finder(folder, without=effects)
        if kind == "shuffled":
            shuffle_materials(folder)
            return self.finder(folder)
        return self.finder(folder, gain=Scored(self.truth[key], {}).sigma >= self.gain_from)

    def answer(self, kind: str, key: str) -> Answer:
        """Diagnosis of a case, or the reason why there is none."""
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as place:
            try:
                diagnosis, problem = self.ask(key, kind, Path(place) / "experiment"), ""
            except (NotDiagnosedError, ValueError) as error:
                diagnosis, problem = None, str(error)
        return key, diagnosis, problem, time.monotonic() - began

    def answers(self, kind: str, keys: Sequence[str]) -> Iterator[Answer]:
        """Answers in order of completion; with several jobs, each case runs in a process."""
        if self.jobs == 1:
            yield from (self.answer(kind, key) for key in keys)
            return
        with ProcessPoolExecutor(self.jobs, mp_context=get_context("spawn")) as pool:
            yield from (
                done.result() for done in as_completed(pool.submit(self.answer, kind, k) for k in keys)
            )

    def fill(self, kind: str, keys: Iterable[str]) -> list[str]:
        """Ask the questions without a stored answer; return the cases that failed."""
        failed = []
        for key, diagnosis, problem, seconds in self.answers(
            kind, [k for k in keys if k not in self.kept[kind].answers]
        ):
            if diagnosis is None:
                failed.append(f"{key} ({kind})")
                print(f"{key} {kind}: not diagnosed: {problem}", flush=True)
            else:
                self.kept[kind].add(key, diagnosis)
                self.print_answer(key, kind, diagnosis, seconds)
        return sorted(failed)

    def print_answer(self, key: str, kind: str, diagnosis: Verdict, seconds: float) -> None:
        shown = diagnosis.get("diagnosis") if kind == "advised" else diagnosis
        case = Scored(self.truth[key], shown or {"verdict": "-", "causes": [], "alternatives": []})
        true = "+".join(case.effects) or self.truth[key]["category"]
        how = {"verdicts": "", "advised": f" after {diagnosis.get('advice')}"}.get(kind, f" {kind}")
        print(
            f"{key} {true} [{case.sigma:.1f}]{how}: {case.verdict} {'+'.join(case.named)}"
            f" {case.diagnosis['alternatives'][1:]} {seconds:.0f} s",
            flush=True,
        )

    def show(self, wanted: Iterable[str]) -> None:
        """Print the confusion matrix, tables and goals of the cases diagnosed so far."""
        cases = self.scored(wanted)
        true_cause, advised, without, mixed = (self.kept[kind].answers for kind in KINDS[1:])
        for table in (
            confusion(list(cases.values())),
            by_size(list(cases.values())),
            gain_table(cases, true_cause),
            advice_table(cases, advised),
            control_table(cases, without, mixed),
        ):
            print(f"{table}\n" if table else "", end="\n" if table else "")
        rows: list[Goal] = [
            *goals(list(cases.values())),
            *scope_goals(list(cases.values())),
            *gain_goals(cases, true_cause),
            *advice_goals(cases, advised),
            *control_goals(cases, without, mixed),
        ]
        for what, goal, count, of in rows:
            fraction = f"{100 * count / of:5.1f} %" if of else "      -"
            print(f"{what:66} goal {goal:>6}  {count:4} of {of:4}  {fraction}")


def asked_for(given: argparse.Namespace) -> list[tuple[str, Callable[[Scored], bool]]]:
    """Requested kinds of questions beyond the verdict, each with the condition on a scored case."""
    found: list[tuple[str, Callable[[Scored], bool]]] = []
    if given.given_cause:
        found.append(("given-cause", large))
    if given.advice:
        found.append(("advised", asked))
    choices = {"without-truth": without_truth, "shuffled": shuffled}
    found += [(name, choices[name]) for name in CONTROLS if name in given.control]
    return found


def parsed(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=Path, default=CASES)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default="", help="indices of cases, by commas")
    parser.add_argument("--in-process", action="store_true")
    parser.add_argument("--workers", type=int, default=None, help="processes of a diagnosis")
    parser.add_argument("--jobs", type=int, default=1, help="cases diagnosed at once")
    parser.add_argument("--no-gain", action="store_true", help="leave the held-out gain away (faster)")
    parser.add_argument(
        "--gain-from", type=float, default=0.0, help="held-out gain only of effects of so many sigmas"
    )
    parser.add_argument(
        "--given-cause", action="store_true", help="effects of 10 sigmas and above once more, no other in"
        "\nthe catalogue: what their held-out error is compared with"
    )  # fmt: skip
    parser.add_argument("--advice", action="store_true", help="make what is advised in ambiguous cases")
    parser.add_argument(
        "--control", action="append", default=[], choices=CONTROLS, help="negative controls (several times)"
    )
    parser.add_argument("--score", action="store_true", help="score what stands")
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    given = parsed(arguments)
    truth = load_truth(given.cases)["cases"]
    wanted = [f"{int(k):03d}" for k in given.only.split(",") if k] or sorted(truth)
    unknown = [k for k in wanted if k not in truth]
    if unknown:
        print(f"{given.cases}: no case {unknown[0]}", file=sys.stderr)
        return 2
    given.out.mkdir(parents=True, exist_ok=True)
    run = Run(
        cases=given.cases,
        truth=truth,
        finder=Diagnoser(in_process=given.in_process, workers=given.workers),
        kept={kind: VerdictFile(given.out / f"{kind}.json") for kind in KINDS},
        jobs=given.jobs,
        gain_from=float("inf") if given.no_gain else given.gain_from,
    )
    failed: list[str] = []
    if not given.score:
        failed += run.fill("verdicts", wanted)
        for kind, fits in asked_for(given):
            failed += run.fill(kind, [key for key, case in run.scored(wanted).items() if fits(case)])
    run.show(wanted)
    if failed:
        print(f"\n{len(failed)} not diagnosed: {', '.join(failed)}")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
