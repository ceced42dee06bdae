"""Intervals in a run's folder: written by `learn.evaluate`, read for predictions.

Those of an ensemble are in the folder of one of its members, whichever is named first.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from learn._yaml import Finite, first_fault
from learn.errors import InputError
from learn.evaluation.intervals import N_FEATURES, Intervals
from learn.metrics import RING_EDGES_MM
from learn.quantities import COVARIATES
from learn.training import Run
from learn.training.run_folder import write_whole


def save_intervals(run: Run, intervals: Intervals) -> Path:
    """Write intervals to the run's folder, an ensemble's in place of its own or to its first run's."""
    try:
        kept = _kept(run)
    except InputError:  # damaged, or of other weights: they are overwritten
        kept = None
    path = _paths(run)[0] if kept is None else kept[0]
    content = {"members": _members(run), "weights": sorted(run.weights), **intervals.as_dict()}
    write_whole(path, (json.dumps(content) + "\n").encode())
    return path


def replaced_text(run: Run, intervals: Intervals) -> str | None:
    """Warning if these intervals replace some that were calibrated on more pokes; else None.

    A run that is evaluated without the other folds is calibrated on its own validation part alone.
    """
    try:
        kept = load_intervals(run)
    except InputError:  # damaged: it is overwritten
        return None
    if kept is None or kept.pokes <= intervals.pokes:
        return None
    return (
        f"{run.folder}: its intervals, calibrated on {kept.pokes} pokes, are replaced by intervals from "
        f"{intervals.pokes}: evaluate it with the other folds to have those again"
    )


def load_intervals(run: Run) -> Intervals | None:
    """Read a run's intervals, None if there are none; InputError if damaged or of other members."""
    kept = _kept(run)
    return None if kept is None else kept[1]


def _kept(run: Run) -> tuple[Path, Intervals] | None:
    """A run's intervals with their file; the fault of the first file if there are only others'."""
    faults = []
    for path in _paths(run):
        if path.is_file():
            try:
                return path, _read(path, run)
            except InputError as error:
                faults.append(error)
    if faults:
        raise faults[0]
    return None


def _read(path: Path, run: Run) -> Intervals:
    try:
        content = _File.model_validate(json.loads(path.read_text(encoding="utf-8"))).model_dump()
    except ValidationError as error:
        raise InputError(
            f"{path}: not readable ({first_fault(error)}); learn.evaluate writes it again"
        ) from None
    except (ValueError, RecursionError):
        raise InputError(f"{path}: not readable; learn.evaluate writes it again") from None
    members, weights = content.pop("members"), content.pop("weights")
    if weights is None and members != _members(run):
        raise InputError(
            f"{path}: belongs to {', '.join(members)}; learn.evaluate --ensemble writes it again"
        )
    if weights is not None and weights != sorted(run.weights):
        raise InputError(
            f"{path}: belongs to other weights (trained further, or other members: "
            f"{', '.join(members) or run.folder.name}); learn.evaluate"
            f"{' --ensemble' if run.members else ''} writes it again"
        )
    return Intervals(**content)


_Positive = Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)]
_Growth = Annotated[tuple[Finite, ...], Field(min_length=len(COVARIATES), max_length=len(COVARIATES))]


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")
    members: list[str]
    weights: list[str] | None = None  # not in files from before 2026-11-27
    level: _Positive
    promised: _Positive
    pokes: Annotated[int, Field(strict=True, ge=1)]
    scale: Annotated[list[Finite], Field(min_length=N_FEATURES, max_length=N_FEATURES)]
    factors: Annotated[
        list[_Positive], Field(min_length=len(RING_EDGES_MM) - 1, max_length=len(RING_EDGES_MM) - 1)
    ]
    force_scale: _Positive
    force: _Positive
    growth: _Growth
    force_growth: _Growth

    @model_validator(mode="before")
    @classmethod
    def _of_before(cls, values: Any) -> Any:
        """Refuse files without the gap: too narrow where the indenter comes near what is rigid.

        Files of 2026-11-28 have `size_gap` and `force_size_gap`: their errors do not depend on the angle.
        """
        if not isinstance(values, dict) or "scale" not in values or "growth" in values:
            return values
        if "size_gap" not in values:
            raise ValueError("intervals of before 2026-11-28, which do not know the gap to what is rigid")
        names = {"size_gap": "growth", "force_size_gap": "force_growth"}
        new = {name: [*values[old], 0.0] for old, name in names.items() if isinstance(values.get(old), list)}
        return {key: value for key, value in values.items() if key not in names} | new


def _paths(run: Run) -> list[Path]:
    """The files in which a run's intervals can be."""
    if not run.members:
        return [run.folder / "intervals.json"]
    return [folder / "intervals-together.json" for folder in run.members]


def _members(run: Run) -> list[str]:
    return [folder.resolve().name for folder in run.members]
