"""Intervals of a run, or of runs together, as a file in the (first) run's folder."""

from __future__ import annotations

import json
from pathlib import Path

from learn.errors import InputError
from learn.evaluation.intervals import Intervals
from learn.training import Run


def save_intervals(run: Run, intervals: Intervals) -> Path:
    """Writes them."""
    path = _path(run)
    content = {"members": _members(run), **intervals.as_dict()}
    path.write_text(json.dumps(content) + "\n", encoding="utf-8")
    return path


def load_intervals(run: Run) -> Intervals | None:
    """None where there are none; InputError where the file is damaged or of other members."""
    path = _path(run)
    if not path.is_file():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        members = content.pop("members")
        intervals = Intervals(**content)
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(f"{path}: not readable; learn.evaluate writes it again") from None
    if members != _members(run):
        raise InputError(f"{path}: is of {', '.join(members)}; learn.evaluate --ensemble writes it again")
    return intervals


def _path(run: Run) -> Path:
    return run.folder / ("intervals-together.json" if run.members else "intervals.json")


def _members(run: Run) -> list[str]:
    return [folder.resolve().name for folder in run.members]
