"""Where the studies find measurements: made ones in the repository, real ones where TISIM_MEASURED says."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MADE = ROOT / "datasets" / "measured"


def real(*parts: str) -> Path:
    """A path below `real/`; SystemExit with one sentence where the environment names no such folder."""
    given = os.environ.get("TISIM_MEASURED")
    if not given:
        raise SystemExit("TISIM_MEASURED: expected a folder that holds real/, the measurements of this study")
    path = Path(given, "real", *parts)
    if not path.exists():
        raise SystemExit(f"TISIM_MEASURED: expected {path}")
    return path
