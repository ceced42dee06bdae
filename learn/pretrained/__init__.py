"""Trained networks that come with the package, to be adapted to bodies of one's own (`learn.adapt`).

Each is the folder of a run: `best.pt`, `intervals.json`, and `card.md`, which states the data, the training,
the accuracy and the range of validity. Their datasets are not part of the package, so that they are not asked
themselves.
"""

from __future__ import annotations

from pathlib import Path

from learn.errors import InputError

_HERE = Path(__file__).parent


def names() -> list[str]:
    """Names of the networks."""
    return sorted(path.parent.name for path in _HERE.glob("*/best.pt"))


def folder_of(name: str | Path) -> Path:
    """Folder of a run: `name` itself, or of the network of this name if there is no such folder.

    InputError if there is neither.
    """
    path = Path(name)
    if path.exists():
        return path
    if str(path) not in names():
        raise InputError(f"{path}: no such folder, expected that of a run, or one of {', '.join(names())}")
    return _HERE / path
