"""A fit on disk: its generations as JSON lines while it runs, its result as JSON when it ends."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from calibration.errors import InputError
from calibration.search import Generation
from calibration.study.calibration import Calibration


class FitStore:
    """`folder/MATERIAL-LABEL.jsonl` and `.json`. header: what must be the same to go on with a fit."""

    def __init__(self, folder: Path, name: str, header: dict[str, Any]) -> None:
        self.history_path = folder / f"{name}.jsonl"
        self.result_path = folder / f"{name}.json"
        self.header = header

    def result(self) -> Calibration | None:
        """The finished fit, if it is there and of the same header."""
        if not self.result_path.exists():
            return None
        data = json.loads(self.result_path.read_text(encoding="utf-8"))
        self._check(data["header"], self.result_path)
        return Calibration.from_json(data["calibration"])

    def history(self) -> list[Generation]:
        """Generations of an unfinished fit; a line cut short by a kill is dropped from the file."""
        if not self.history_path.exists():
            return []
        whole: list[str] = []
        for line in self.history_path.read_text(encoding="utf-8").splitlines(keepends=True):
            if not line.endswith("\n"):
                break
            whole.append(line)
        if not whole:
            self.history_path.unlink()
            return []
        self._check(json.loads(whole[0]), self.history_path)
        self.history_path.write_text("".join(whole), encoding="utf-8")
        return [_generation(json.loads(line)) for line in whole[1:]]

    def append(self, generation: Generation) -> None:
        """Write one generation down, at once."""
        new = not self.history_path.exists()
        with self.history_path.open("a", encoding="utf-8") as file:
            if new:
                file.write(json.dumps(self.header) + "\n")
            file.write(
                json.dumps(
                    {
                        "restart": generation.restart,
                        "index": generation.index,
                        "candidates": generation.candidates.tolist(),
                        "costs": [None if np.isinf(c) else float(c) for c in generation.costs],
                    }
                )
                + "\n"
            )

    def finish(self, calibration: Calibration) -> None:
        """Write the result, in one piece."""
        data = {"header": self.header, "calibration": calibration.to_json()}
        part = self.result_path.with_suffix(".json.part")
        part.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        part.replace(self.result_path)

    def _check(self, found: dict[str, Any], path: Path) -> None:
        other = [k for k in self.header if found.get(k) != self.header[k]]
        if other:
            raise InputError(
                f"{path}: made with another {' and '.join(other)}; expected the same to go on"
                " (--overwrite starts anew, --out writes elsewhere)"
            )


def _generation(data: dict[str, Any]) -> Generation:
    return Generation(
        restart=data["restart"],
        index=data["index"],
        candidates=np.array(data["candidates"], dtype=float),
        costs=np.array([np.inf if c is None else c for c in data["costs"]]),
        replayed=True,
    )
