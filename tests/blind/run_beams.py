"""Diagnose the blind beam experiments, and score the verdicts.

    python tests/blind/run_beams.py --out FOLDER              # the whole set, each by the command line
    python tests/blind/run_beams.py --out FOLDER --in-process --workers 1
    python tests/blind/run_beams.py --out FOLDER --score      # what stands, without diagnosing

Each diagnosis is given the experiment in a temporary folder, never the truth. A run that was stopped goes
on where it ended; OUT/verdicts.json holds each verdict.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from _blind_lab import write_experiment
from _blind_score import Scored, by_size, confusion, goals
from _blind_store import load_case, load_truth


def verdict_on(
    cases: Path,
    index: int,
    place: Path,
    *,
    in_process: bool,
    workers: int | None,
    without: tuple[str, ...] = (),
    gain: bool = True,
) -> dict[str, Any]:
    """diagnosis.json's content for a case whose experiment is written to place/experiment."""
    folder = place / "experiment"
    write_experiment(*load_case(cases, index), folder)
    if in_process:
        from calibration.diagnosis import diagnose, model_of
        from calibration.experiment import read

        model = model_of(read(folder), without=without, workers=workers)
        return diagnose(model, gain=gain).to_json()
    command = [sys.executable, "-m", "calibration.diagnose", str(folder), "--out", str(place / "found")]
    command += ["--workers", str(workers)] if workers else []
    command += ["--without", ",".join(without)] if without else []
    command += [] if gain else ["--no-gain"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    path = place / "found" / "diagnosis.json"
    if not path.exists():
        raise RuntimeError(f"exit code {ended.returncode}: {(ended.stderr or ended.stdout).strip()[-300:]}")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def show(scored: list[Scored]) -> None:
    """Confusion matrix and goals of what has been diagnosed."""
    print(confusion(scored))
    print()
    print(by_size(scored))
    print()
    for what, goal, count, of in goals(scored):
        share = f"{100 * count / of:5.1f} %" if of else "      -"
        print(f"{what:64} goal {goal:>6}  {count:4} of {of:4}  {share}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=Path, default=Path(__file__).parent / "beams")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", default="", help="indices of cases, by commas")
    parser.add_argument("--in-process", action="store_true")
    parser.add_argument("--workers", type=int, default=None)
    parser.add_argument("--no-gain", action="store_true", help="leave the held-out gain away (faster)")
    parser.add_argument("--score", action="store_true", help="score what stands")
    given = parser.parse_args()
    truth = load_truth(given.cases)["cases"]
    path = given.out / "verdicts.json"
    verdicts: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    wanted = [f"{int(k):03d}" for k in given.only.split(",") if k] or sorted(truth)
    unknown = [k for k in wanted if k not in truth]
    if unknown:
        print(f"{given.cases}: no case {unknown[0]}", file=sys.stderr)
        return 2
    given.out.mkdir(parents=True, exist_ok=True)
    failed = []
    for key in () if given.score else wanted:
        if key in verdicts:
            continue
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as place:
            try:
                said = verdict_on(
                    given.cases,
                    int(key),
                    Path(place),
                    in_process=given.in_process,
                    workers=given.workers,
                    gain=not given.no_gain,
                )
            except (RuntimeError, ValueError) as error:
                failed.append(key)
                print(f"{key}: not diagnosed: {error}", flush=True)
                continue
        verdicts[key] = said
        part = path.with_suffix(".part")
        part.write_text(json.dumps(verdicts), encoding="utf-8")
        part.replace(path)
        case = Scored(truth[key], said)
        true = "+".join(case.effects) or truth[key]["category"]
        print(
            f"{key} {true} [{case.sigma:.1f}]: {case.verdict} {'+'.join(case.named)}"
            f" {said['alternatives'][1:]} {time.monotonic() - began:.0f} s",
            flush=True,
        )
    show([Scored(truth[key], verdicts[key]) for key in wanted if key in verdicts])
    if failed:
        print(f"\n{len(failed)} not diagnosed: {', '.join(failed)}")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
