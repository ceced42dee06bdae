"""Where a page came from: its data, and the command that makes it again."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from calibration.experiment.model import Experiment
from calibration.study.calibration import Calibration


def command(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> str:
    """The command line of these fits; seed and limits from the fits in `folder`, where they are still."""
    words = ["python", "-m", "calibration.fit", str(experiment.folder)]
    words += ["--model", ",".join(dict.fromkeys(r.law for r in results))]
    used = {t.material for t in experiment.trials}
    materials = dict.fromkeys(r.material for r in results)
    if set(materials) != used:
        words += ["--material", ",".join(materials)]
    terms = [r.label.removeprefix("ogden-") for r in results if r.label.startswith("ogden-")]
    if terms:
        words += ["--terms", terms[0]]
    header = _header(folder, results[0])
    for option in ("seed", "population", "generations", "restarts"):
        if header.get(option) is not None:
            words += [f"--{option}", str(header[option])]
    if header.get("polish") is False:
        words.append("--no-polish")
    elif _held_out_left_out(results):
        words.append("--no-held-out")
    return shlex.join([*words, "--out", str(folder)])


def _header(folder: Path, result: Calibration) -> dict[str, Any]:
    """Header of a fit on disk (`calibration.study._store`), {} where there is none."""
    whole = folder / "fits" / f"{result.material}-{result.label}.json"
    if whole.is_file():
        return dict(json.loads(whole.read_text(encoding="utf-8"))["header"])
    lines = whole.with_suffix(".jsonl")
    if lines.is_file():
        with lines.open(encoding="utf-8") as file:
            return dict(json.loads(file.readline()))
    return {}


def _held_out_left_out(results: Sequence[Calibration]) -> bool:
    polished = [r for r in results if r.estimates and r.rms is not None]
    return bool(polished) and not any(r.held_out or r.held_out_note for r in polished)
