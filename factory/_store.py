"""A finished store on disk, read without decoding its big arrays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

PROVENANCE = "provenance"  # a Zarr group, so that its files do not disturb who lists the arrays


def root_attributes(store: Path) -> dict[str, Any] | None:
    """Attributes of the store's root group; None where this is no store."""
    try:
        metadata = json.loads((store / "zarr.json").read_text(encoding="utf-8"))
        attributes: dict[str, Any] = metadata["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return attributes if "fingerprint" in attributes else None
