"""A trial of the example in datasets/lab-files with its file or its answers damaged."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml
from typer.testing import CliRunner

from calibration.new import app

SAMPLES = Path(__file__).resolve().parents[3] / "datasets" / "lab-files"

Change = Callable[[str], str | bytes]


def swap(old: str, new: str) -> Change:
    """Replace the first occurrence, which must exist."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


def lines(start: int, end: int, *instead: str) -> Change:
    """Replace lines `start` to `end`, counted from 1, both included."""

    def change(text: str) -> str:
        rows = text.split("\n")
        return "\n".join([*rows[: start - 1], *instead, *rows[end:]])

    return change


def same(text: str) -> str:
    return text


def lab(folder: Path, trial: str, change: Change, keys: dict[str, Any]) -> Path:
    """Write a copy of one trial of the example with its file and answers changed; return the answers file."""
    answers = yaml.safe_load((SAMPLES / "answers.yaml").read_text(encoding="utf-8"))
    (own,) = (t for t in answers["trials"] if t["id"] == trial)
    if own["kind"] != "beam":
        changed = change((SAMPLES / own["file"]).read_text(encoding="utf-8"))
        (folder / own["file"]).write_bytes(changed if isinstance(changed, bytes) else changed.encode())
    else:
        outline = SAMPLES / own["captures"][0]["outline"]
        own["captures"][0]["outline"] = "outline.csv"
        shutil.copyfile(outline, folder / "outline.csv")
    for key, value in keys.items():
        if value is None:
            own.pop(key, None)
        else:
            own[key] = value
    answers["trials"] = [own]
    path = folder / "answers.yaml"
    path.write_text(yaml.safe_dump(answers, allow_unicode=True), encoding="utf-8")
    return path


# trial of datasets/lab-files/answers.yaml, change of its file, change of its answers, location and message
Case = tuple[str, Change, dict[str, Any], str, str]


def check_refused(case: Case, folder: Path) -> None:
    """The command says one sentence on a case, ends with exit code 2, and writes nothing."""
    trial, change, keys, place, said = case
    path = lab(folder, trial, change, keys)
    before = sorted(p.name for p in folder.iterdir())
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(folder / "lab")])
    assert done.exit_code == 2, (done.output, done.exception)
    (sentence,) = done.stderr.strip().splitlines()
    assert place in sentence, sentence
    assert said in sentence, sentence
    # a format's name stands in no file
    assert sentence.startswith((f"error: {folder}", "error: format ")), sentence
    assert done.stdout == ""
    assert sorted(p.name for p in folder.iterdir()) == before
