"""Trained networks that come with the package: to predict with, and to be adapted to bodies of one's own.

Each is the folder of a run: `best.pt`, `intervals.json`, `dataset.npz` (the tables of its dataset, whose
displacement fields are not part of the package), and `card.md`, which states the data, the training, the
accuracy and the range of validity. The name of a network stands wherever the folder of a run does.
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


def is_shipped(folder: Path) -> bool:
    """True for the folder of a network that comes with the package: nothing is written there."""
    return folder.resolve().parent == _HERE.resolve()


def results_of(run: Path, what: str) -> Path:
    """Default folder for results of a run: `what` in its folder, NAME-`what` here for a network NAME."""
    return Path(f"{run.name}-{what}") if is_shipped(folder_of(run)) else run / what
