"""Trained networks that come with the package: to predict with, and to be adapted to bodies of one's own.

Each is the folder of a run: `best.pt`, `intervals.json`, `dataset.npz` (the tables of its dataset, whose
displacement fields are not part of the package), and `card.md`, which states the data, the training, the
accuracy and the range of validity. The name of a network stands wherever the folder of a run does.
"""

from __future__ import annotations

import logging
from pathlib import Path

from learn.errors import InputError

_HERE = Path(__file__).parent
_CHECKPOINTS = ("best.pt", "last.pt")  # a folder with one of these holds a run
_log = logging.getLogger(__name__)


def names() -> list[str]:
    """Names of the networks."""
    return sorted(path.parent.name for path in _HERE.glob("*/best.pt"))


def folder_of(name: str | Path) -> Path:
    """Folder of a run: `name` itself, or of the network of this name.

    A folder with the name of a network is used if it holds a run, which is logged as a warning; any other,
    such as one of results, does not hide the network. InputError if there is neither folder nor network.
    """
    folder = _find(Path(name))
    if str(folder) in names():
        _log.warning(
            "%s: the run in this folder is used, not the network of this name that comes with tisim", folder
        )
    return folder


def _find(path: Path) -> Path:
    if str(path) in names() and not any((path / file).is_file() for file in _CHECKPOINTS):
        return _HERE / path
    if not path.exists():
        raise InputError(f"{path}: no such folder, expected that of a run, or one of {', '.join(names())}")
    if not path.is_dir():
        raise InputError(
            f"{path}: expected the folder of a run, or one of {', '.join(names())}; this is a file"
        )
    return path


def is_shipped(folder: Path) -> bool:
    """True for the folder of a network that comes with the package: nothing is written there."""
    return folder.resolve().parent == _HERE.resolve()


def results_of(run: Path, what: str) -> Path:
    """Default folder for results of a run: `what` in its folder, NAME-`what` here for a network NAME."""
    return Path(f"{run.name}-{what}") if is_shipped(_find(run)) else run / what
