"""sha256 of every file of a store, written when it is complete."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from factory._store import PROVENANCE

MANIFEST = f"{PROVENANCE}/manifest.json"
LEDGER = f"{PROVENANCE}/ledger.jsonl"
_OUTSIDE = {MANIFEST, LEDGER}  # the ledger holds wall times: no two runs agree on them


def _sums(folder: Path) -> dict[str, str]:
    sums = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in _OUTSIDE:
            with path.open("rb") as file:
                sums[name] = hashlib.file_digest(file, "sha256").hexdigest()
    return sums


def write_manifest(folder: Path) -> None:
    """Writes provenance/manifest.json: {"sha256": {file: digest}}."""
    text = json.dumps({"sha256": _sums(folder)}, indent=1, sort_keys=True) + "\n"
    (folder / MANIFEST).write_text(text, encoding="utf-8")


def manifest_faults(folder: Path) -> list[str]:
    """What differs from the manifest: one line a file."""
    path = folder / MANIFEST
    try:
        expected = json.loads(path.read_text(encoding="utf-8"))["sha256"]
        assert isinstance(expected, dict)
    except (OSError, ValueError, KeyError, TypeError, AssertionError):
        return [f"{MANIFEST}: missing or unreadable"]
    found = _sums(folder)
    faults = [f"{name}: missing" for name in sorted(set(expected) - set(found))]
    faults += [f"{name}: not in the manifest" for name in sorted(set(found) - set(expected))]
    faults += [
        f"{name}: sha256 differs from the manifest"
        for name in sorted(set(expected) & set(found))
        if expected[name] != found[name]
    ]
    return faults
