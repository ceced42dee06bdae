"""The log of a run: a line of JSON an epoch, and TensorBoard events where tensorboardX is installed."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

LOG = "log.jsonl"


class Log:
    """Appends to RUN/log.jsonl. On a resumed run, lines of epochs that will be trained again are dropped."""

    def __init__(self, folder: Path, *, epochs_done: int) -> None:
        self._path = folder / LOG
        kept = [line for line in read_log(folder) if line["epoch"] < epochs_done]
        text = "".join(json.dumps(line) + "\n" for line in kept)
        self._path.write_text(text, encoding="utf-8")
        try:
            module = importlib.import_module("tensorboardX")
        except ImportError:
            self._board: Any = None
        else:
            self._board = module.SummaryWriter(str(folder / "tensorboard"), purge_step=epochs_done)

    def add(self, line: dict[str, Any]) -> None:
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        if self._board is not None:
            for key, value in line.items():
                if key != "epoch":
                    self._board.add_scalar(key, value, line["epoch"])

    def close(self) -> None:
        if self._board is not None:
            self._board.close()


def read_log(folder: Path) -> list[dict[str, Any]]:
    """The log's whole lines."""
    path = folder / LOG
    if not path.is_file():
        return []
    lines = []
    for text in path.read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(text))
        except ValueError:  # a kill can cut the last line
            break
    return lines
