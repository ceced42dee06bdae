"""One trial while it is made: its answers, the source of further ones, and the defaults that were taken."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration._files import on_any_disk
from calibration.errors import InputError
from calibration.new._asking import SD, Asker, Question, zero_or_more

Array = NDArray[np.float64]
NO_FILE = "."  # stands in for the name of a file that the answers lack


@dataclass(kw_only=True)
class Work:
    """The experiment as it grows.

    Attributes
    ----------
    base : Path
        Folder that the answers' paths are relative to.
    asker : Asker
    defaults : list of str
        What was taken by default or from a file's header, for the written file.
    tables : dict
        CSV text by name in the experiment's folder.
    copies : dict
        Files to copy, by their name in the experiment's folder.
    """

    base: Path
    asker: Asker
    defaults: list[str] = field(default_factory=list)
    tables: dict[str, str] = field(default_factory=dict)
    copies: dict[str, Path] = field(default_factory=dict)

    def source(self, name: str, where: str) -> Path:
        """The path of a file that the answers name.

        Raises
        ------
        InputError
            There is no such file.
        """
        path = self.base / name
        if not path.is_file() and not (name == NO_FILE and self.asker.lacks):
            raise InputError(f"{path}: key {where}: expected a file, there is none")
        return path

    def copy(self, path: Path, folder: str) -> str:
        """Name under which a file will be copied into a folder of the experiment."""
        stem = "".join(c if c.isalnum() or c in " ._-+" else "_" for c in path.stem).strip() or "file"
        for number in range(1, 10_000):
            name = f"{folder}/{stem}{'' if number == 1 else f'-{number}'}{path.suffix.lower()}"
            same = next((n for n in self.copies if on_any_disk(n) == on_any_disk(name)), name)
            if self.copies.setdefault(same, path) == path:
                return same
        raise InputError(f"{path}: expected fewer files of one name")

    def settle(
        self,
        where: str,
        key: str,
        given: Any,
        text: str,
        read: Callable[[str], Any],
        *,
        default: Any = None,
        why: str = "",
        help: str = "",
    ) -> Any:
        """The answer for a key; asked for, or taken by default, if the answers leave it open.

        Parameters
        ----------
        where, key
            The trial's id (and what is inside it), and the key there.
        given
            The answer, None where it is left open.
        text, read, default, why, help
            As in `Question`.
        """
        if given is not None:
            return given
        value, by_default = self.asker.ask(
            where, Question(key=key, text=text, read=read, default=default, why=why, help=help)
        )
        if by_default:
            self.defaults.append(f"{where}.{key} {_brief(value)} ({why})")
        return value

    def settle_sd(self, where: str, key: str, given: Any, of: str, default: float, why: str) -> float:
        """A standard deviation."""
        return float(
            self.settle(
                where,
                key,
                given,
                f"standard deviation of {of}",
                zero_or_more,
                default=default,
                why=f"proposed, not measured: {why}",
                help=SD,
            )
        )


def _brief(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def csv_text(columns: dict[str, Array]) -> str:
    """A table in the experiment's format."""
    rows = [",".join(columns)]
    digits = [12 if name == "time_s" else 9 for name in columns]  # a clock may have run for days
    for row in np.column_stack(list(columns.values())):
        rows.append(",".join(f"{value:.{n}g}" for value, n in zip(row, digits, strict=True)))
    return "\n".join(rows) + "\n"
