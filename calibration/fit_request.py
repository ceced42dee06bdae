"""Options of a fit in addition to its experiment, with the defaults of `calibration.fit` and of its command.

Apart from `calibration.fit_plan`, since the command shows the defaults without loading numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class FitRequest:
    """Options of a fit, not checked (`calibration.fit_plan.plan_fit`).

    Attributes
    ----------
    out : path
        Folder that keeps the fits.
    others
        Parameters of `calibration.fit`, which documents them.
    """

    out: str | Path
    model: str | Sequence[str] = "all"
    materials: str | Sequence[str] | None = None
    terms: int = 1
    time: str | None = None
    damage: str | None = None
    fibres: bool = False
    objective: str = "likelihood"
    free_bulk_ratio: bool = False
    rig: str | Path | None = None
    start: str | Path | None = None
    seed: int = 1
    population: int | None = None
    generations: int = 60
    restarts: int = 0
    polish: bool = True
    held_out: bool = True
    workers: int | None = None
    overwrite: bool = False
