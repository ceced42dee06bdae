"""Fits on disk: generations as JSON lines while a fit runs, its result as JSON when it ends, under a lock."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from calibration._files import whole_name, write_whole
from calibration.errors import InputError
from calibration.inference import Generation
from calibration.parameters import part_entry
from calibration.study.calibration import Calibration
from tisim.parts import decode

_NOT_COMPARED = {"rig_file", "start"}  # paths: "rig" and "card" are the contents
# of fits that can stand in one table
_ALIKE = ("format", "data", "trials", "objective", "rig")
_ANEW = "--overwrite starts anew, --out writes elsewhere"


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder of fits, which is made; the system frees it whatever ends the process.

    Raises
    ------
    InputError
        Another process holds it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT, 0o644)
    try:
        if not _take(handle):
            raise InputError(
                f"{folder}: another calibration is at work here; wait for it, or write elsewhere with --out"
            )
        yield
    finally:
        os.close(handle)


def finished(folder: Path, like: Mapping[str, Any], *, without: Collection[str]) -> list[Calibration]:
    """Fits that earlier runs have finished in a folder, to the same data with the same corrections.

    Parameters
    ----------
    folder : Path
    like : mapping
        Header of a fit that they are compared with.
    without : collection of str
        Names of fits to leave out.

    Returns
    -------
    list of Calibration
        By name; without those among which another fit has chosen.
    """
    found: dict[str, Calibration] = {}
    passed_over = set(without)
    for path in sorted(folder.glob("*.json")):
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
            if all(data["header"].get(key) == like.get(key) for key in _ALIKE):
                found[path.stem] = Calibration.from_json(data["calibration"])
                passed_over |= set(data.get("chosen_from", ()))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            continue  # it is none of this run, which says so of its own (`FitStore.result`)
    return [fit for name, fit in found.items() if name not in passed_over]


def remove_fits(folder: Path, names: Collection[str]) -> None:
    """Remove the fits of these names in a folder, whole or damaged, and nothing else.

    InputError where another process is at work there.
    """
    with locked(folder):
        for path in folder.iterdir():
            if path.is_file() and path.name.partition(".json")[0] in names and _is_fit(path):
                path.unlink()


def _is_fit(path: Path) -> bool:
    """True for a file that a fit wrote, or that has a fit's name but cannot be read."""
    suffix = Path(whole_name(path.name)).suffix
    if suffix not in (".json", ".jsonl"):
        return False
    try:
        text = path.read_text(encoding="utf-8")
        found = json.loads(text.partition("\n")[0] if suffix == ".jsonl" else text)
    except (ValueError, RecursionError):
        return True
    return isinstance(found, dict) and ("format" if suffix == ".jsonl" else "header") in found


def _stated(key: str, value: Any) -> Any:
    """A header's value to be compared: a card's parts are the same with and without units behind keys."""
    if key != "card" or not isinstance(value, dict):
        return value
    try:
        return {field: part_entry(decode(field, entry)) for field, entry in value.items()}
    except ValueError:
        return value


def _take(handle: int) -> bool:
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        except OSError:
            return False
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


class FitStore:
    """One fit in a folder: `NAME.jsonl` (its generations) and `NAME.json` (its result).

    Parameters
    ----------
    folder : Path
    name : str
        MATERIAL-LAW.
    header : dict
        Must be the same to go on with a fit.
    """

    def __init__(self, folder: Path, name: str, header: dict[str, Any]) -> None:
        self.history_path = folder / f"{name}.jsonl"
        self.result_path = folder / f"{name}.json"
        self.header = header

    def result(self) -> Calibration | None:
        """The finished fit, if it is there. InputError where it is damaged, or of another header."""
        if not self.result_path.exists():
            return None
        try:
            data = json.loads(self.result_path.read_text(encoding="utf-8"))
            header, calibration = data["header"], data["calibration"]
            found = Calibration.from_json(calibration)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise InputError(
                f"{self.result_path}: damaged, expected a fit that calibration.fit wrote ({_ANEW})"
            ) from None
        self._check(header, self.result_path)
        return found

    def history(self) -> list[Generation]:
        """Generations of an unfinished fit; a line cut short by a kill is dropped from the file.

        InputError where the file is damaged, or of another header.
        """
        if not self.history_path.exists():
            return []
        try:
            text = self.history_path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise self._damaged(1) from None
        whole: list[str] = []
        for line in text.splitlines(keepends=True):
            if not line.endswith("\n"):
                break
            whole.append(line)
        if not whole:
            self.history_path.unlink()
            return []
        try:
            header = json.loads(whole[0])
        except (ValueError, RecursionError):
            raise self._damaged(1) from None
        self._check(header, self.history_path)
        found = [self._generation(line, number) for number, line in enumerate(whole[1:], 2)]
        if len(whole) < len(text.splitlines()):
            write_whole(self.history_path, "".join(whole))
        return found

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

    def finish(self, calibration: Calibration, *, chosen_from: Sequence[str] = ()) -> None:
        """Write the result, in one piece; chosen_from : names of the fits among which the data chose."""
        data: dict[str, Any] = {"header": self.header, "calibration": calibration.to_json()}
        if chosen_from:
            data["chosen_from"] = list(chosen_from)
        write_whole(self.result_path, json.dumps(data, indent=1) + "\n")

    def _check(self, found: object, path: Path) -> None:
        if not isinstance(found, dict):
            raise InputError(f"{path}: damaged, expected the header of a fit ({_ANEW})")
        compared = {**self.header, **found}.keys() - _NOT_COMPARED
        other = sorted(k for k in compared if _stated(k, found.get(k)) != _stated(k, self.header.get(k)))
        if other:
            raise InputError(
                f"{path}: made with another {' and '.join(other)}; expected the same to go on ({_ANEW})"
            )

    def _generation(self, line: str, number: int) -> Generation:
        try:
            data = json.loads(line)
            candidates = np.array(data["candidates"], dtype=float)
            costs = np.array([np.inf if c is None else float(c) for c in data["costs"]])
            found = Generation(
                restart=int(data["restart"]),
                index=int(data["index"]),
                candidates=candidates,
                costs=costs,
                replayed=True,
            )
        except (ValueError, KeyError, TypeError, RecursionError):
            raise self._damaged(number) from None
        sound = candidates.ndim == 2 and costs.shape == candidates.shape[:1] and len(costs)
        if not sound or not np.isfinite(candidates).all() or np.isnan(costs).any():
            raise self._damaged(number)
        return found

    def _damaged(self, line: int) -> InputError:
        return InputError(
            f"{self.history_path}: line {line}: damaged, expected a generation of a search ({_ANEW})"
        )
