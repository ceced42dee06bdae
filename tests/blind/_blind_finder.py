"""The diagnosis under test, called on an experiment's folder that holds no truth; its verdicts on disk."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Said = dict[str, Any]  # diagnosis.json


class NotDiagnosedError(RuntimeError):
    """The command ended without a verdict."""


@dataclass(frozen=True, kw_only=True)
class Finder:
    """in_process: called here instead of by its command line, `command`. workers: processes a diagnosis
    (None: all cores)."""

    in_process: bool = False
    command: tuple[str, ...] = (sys.executable, "-m", "calibration.diagnose")
    workers: int | None = None

    def __call__(
        self,
        folder: Path,
        *,
        without: Iterable[str] = (),
        gain: bool = False,
        pose: Callable[[Any, Any], Any] | None = None,
    ) -> Said:
        """diagnosis.json's content. without: effects taken out of the catalogue. pose: what was done to the
        beams of which trials, as the diagnosis' own model takes it: the command line does not."""
        left_out = tuple(without)
        if self.in_process or pose is not None:
            return self._called(folder, left_out, gain, pose)
        with tempfile.TemporaryDirectory() as place:
            out = Path(place) / "found"
            command = [*self.command, str(folder), "--out", str(out)]
            command += ["--workers", str(self.workers)] if self.workers else []
            command += ["--without", ",".join(left_out)] if left_out else []
            command += [] if gain else ["--no-gain"]
            ended = subprocess.run(command, capture_output=True, text=True, check=False)
            path = out / "diagnosis.json"
            if not path.exists():
                problem = (ended.stderr or ended.stdout).strip()[-300:]
                raise NotDiagnosedError(f"exit code {ended.returncode}: {problem}")
            found: Said = json.loads(path.read_text(encoding="utf-8"))
            return found

    def _called(
        self, folder: Path, without: tuple[str, ...], gain: bool, pose: Callable[[Any, Any], Any] | None
    ) -> Said:
        from calibration.diagnosis import diagnose, model_of
        from calibration.diagnosis.beams.model import BeamModel
        from calibration.experiment import read

        data = read(folder)
        if pose is None:
            return diagnose(model_of(data, without=without, workers=self.workers), gain=gain).to_json()
        model = BeamModel(data, without=without, workers=self.workers, pose=pose)
        return diagnose(model, gain=gain).to_json()


def catalogue() -> tuple[str, ...]:
    """Names of the effects on beams that the diagnosis knows."""
    from calibration.diagnosis import KINDS

    return KINDS["beams"].effects


class Kept:
    """What was said of each case, in one JSON file: read where it is there, written anew after each."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.said: dict[str, Said] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def add(self, key: str, said: Said) -> None:
        self.said[key] = said
        part = self.path.with_suffix(".part")
        part.write_text(json.dumps(self.said), encoding="utf-8")
        part.replace(self.path)
