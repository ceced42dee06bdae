"""The diagnosis of pokes under test, and what it cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from _blind_record_verdict import told

from calibration.diagnosis.pokes import PokeModel
from calibration.experiment import read


def verdict_on(folder: Path, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """As `told`; with the pokes that were simulated, and their time on a core [s]."""
    model = PokeModel(read(folder), without=without, workers=1)
    _, found = told(model)
    return found | {"simulated": model.curves.simulated, "core_seconds": model.curves.core_seconds}
