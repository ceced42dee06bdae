"""Files of one experiment: each is read once and goes into the digest; CSV files become checked tables."""

from __future__ import annotations

import csv
import hashlib
import io
import math
from bisect import bisect_left
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calibration.errors import InputError
from calibration.experiment.model import Array

MAIN = "experiment.yaml"


class Files:
    """Reads files by the names that experiment.yaml gives them; refuses those that lie outside the folder.

    leave_out_rows : go on without rows at which a clock runs backwards, in place of an error.
    """

    def __init__(self, folder: Path, *, leave_out_rows: bool = False) -> None:
        self.folder = folder
        self.leave_out_rows = leave_out_rows
        self.left_out: list[str] = []  # a sentence for each file of which rows were left out
        self._sums: dict[str, str] = {}
        if not folder.is_dir():
            raise InputError(f"{folder}: expected a folder that holds {MAIN}")

    @property
    def main(self) -> Path:
        return self.folder / MAIN

    def error(self, key: str, text: str) -> InputError:
        """An error at a key of experiment.yaml, as one sentence."""
        return InputError(f"{self.main}: key {key}: {text}" if key else f"{self.main}: {text}")

    def need_smaller_sd(self, key: str, sd: float | None, values: Array, what: str) -> None:
        """InputError where a standard deviation is as large as all of the values, as one of another unit is.

        what : the largest value in words, with its unit.
        """
        largest = float(np.abs(values).max())
        if sd is not None and 0.0 < largest <= sd:
            raise self.error(
                key, f"expected less than {what}, {largest:g}, got {sd:g}; has one of them another unit?"
            )

    def read(self, name: str, key: str) -> bytes:
        """Content of the file that `key` names; InputError where it is missing or leads out of the folder."""
        path = self.folder / name
        try:
            real = path.resolve(strict=True)
            if not real.is_relative_to(self.folder.resolve()) or real.suffix != path.suffix:
                raise self.error(
                    key, f"expected a file inside the experiment's folder, {name} leads elsewhere"
                )
            if not real.is_file():
                raise self.error(key, f"expected a file, {name} is none")
            content = real.read_bytes()
        except FileNotFoundError:
            if name == MAIN:
                raise InputError(f"{path}: missing, expected it in the experiment's folder") from None
            raise self.error(
                key, f"expected the file {name} in the experiment's folder, it is missing"
            ) from None
        except (OSError, RuntimeError) as error:  # RuntimeError: links in a circle
            reason = getattr(error, "strerror", None) or "links in a circle"
            raise self.error(key, f"expected that {path} can be read ({reason})") from None
        self._sums[name] = hashlib.sha256(content).hexdigest()
        return content

    def digest(self) -> str:
        """sha256 over the names and contents of all that was read, sorted by name."""
        total = hashlib.sha256()
        for name, content in sorted(self._sums.items()):
            total.update(f"{name}\0{content}\n".encode())
        return total.hexdigest()


MOST_LINES = 8  # that a message names
MOST_LOST = 0.25  # part of its rows that a table may lose


def longest_growing(values: Array) -> list[int]:
    """Indices of a longest strictly growing run of values (k,), in order; others may lie between them."""
    ends: list[float] = []  # least last value of a run of each length
    last: list[int] = []
    before = [-1] * len(values)
    for k, value in enumerate(values):
        at = bisect_left(ends, float(value))
        before[k] = last[at - 1] if at else -1
        if at == len(ends):
            ends.append(float(value))
            last.append(k)
        else:
            ends[at], last[at] = float(value), k
    found, k = [], last[-1] if last else -1
    while k >= 0:
        found.append(k)
        k = before[k]
    return found[::-1]


_LARGEST = 1e9  # beyond it a number is damage, not a measurement


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Columns of a CSV file: numbers and texts by name, each (k,); lines: where each row stands."""

    path: Path
    numbers: dict[str, Array]
    texts: dict[str, list[str]]
    lines: list[int]

    def __len__(self) -> int:
        return len(self.lines)

    def __contains__(self, name: str) -> bool:
        return name in self.numbers

    def columns(self, *names: str) -> Array:
        """(k, len(names))."""
        return np.column_stack([self.numbers[name] for name in names])

    def error(self, row: int, text: str) -> InputError:
        return InputError(f"{self.path}: line {self.lines[row]}: {text}")

    def need_rows(self, least: int) -> None:
        if len(self) < least:
            raise InputError(f"{self.path}: expected at least {least} rows below the header, got {len(self)}")

    def need_clock(self, rows: list[int] | None = None, of: str = "") -> None:
        """Refuses a column time_s that does not grow from row to row (of `rows`, where given), or has a time
        before 0."""
        chosen = list(range(len(self))) if rows is None else rows
        self._need_times_from_0(chosen)
        values = self.numbers["time_s"][chosen]
        bad = np.flatnonzero(np.diff(values) <= 0)
        if bad.size:
            at = int(bad[0]) + 1
            raise self.error(
                chosen[at],
                f"column time_s: expected more than {values[at - 1]:g} s{of} before it, got {values[at]:g}"
                + self._also([chosen[int(k) + 1] for k in bad[1:]]),
            )

    def _need_times_from_0(self, rows: list[int]) -> None:
        # a test's course begins at 0 or later: what a lab recorded before is no part of it
        values = self.numbers["time_s"]
        bad = [r for r in rows if values[r] < 0.0]
        if bad:
            raise self.error(
                bad[0], f"column time_s: expected 0 s or more, got {values[bad[0]]:g}{self._also(bad[1:])}"
            )

    def _also(self, rows: list[int]) -> str:
        """Further rows with the same fault, for a message."""
        if not rows:
            return ""
        first = ", ".join(str(self.lines[r]) for r in rows[:MOST_LINES])
        more = f" and {len(rows) - MOST_LINES} more" if len(rows) > MOST_LINES else ""
        return f"; the same in line{'s' if len(rows) > 1 else ''} {first}{more}"

    def clock(self, files: Files) -> Table:
        """The rows in which the column time_s grows: all, or else those of the longest run through the table
        that does, where `files` may leave rows out. InputError otherwise, where more than MOST_LOST of them
        would go, and for a time before 0."""
        self._need_times_from_0(list(range(len(self))))
        kept = longest_growing(self.numbers["time_s"])
        lost = sorted(set(range(len(self))) - set(kept))
        if not lost:
            return self
        if not files.leave_out_rows:
            self.need_clock()
        if len(lost) > MOST_LOST * len(self):
            raise InputError(
                f"{self.path}: column time_s: expected that it grows from row to row, but {len(lost)} of"
                f" {len(self)} rows stand against it"
            )
        lines = ", ".join(str(self.lines[r]) for r in lost[:MOST_LINES])
        more = f" and {len(lost) - MOST_LINES} more" if len(lost) > MOST_LINES else ""
        files.left_out.append(f"{self.path.name}: time_s does not grow in lines {lines}{more}, left out")
        return Table(
            path=self.path,
            numbers={n: values[kept] for n, values in self.numbers.items()},
            texts={n: [values[k] for k in kept] for n, values in self.texts.items()},
            lines=[self.lines[k] for k in kept],
        )

    def need_within(self, name: str, limit: float, why: str) -> None:
        """Refuses values beyond +-limit."""
        bad = np.flatnonzero(np.abs(self.numbers[name]) > limit)
        if bad.size:
            row = int(bad[0])
            raise self.error(
                row, f"column {name}: expected at most {limit:g} ({why}), got {self.numbers[name][row]:g}"
            )


def parse_table(
    content: bytes,
    path: Path,
    *,
    numbers: tuple[str, ...],
    texts: tuple[str, ...] = (),
    optional: tuple[str, ...] = (),
) -> Table:
    """Comma-separated columns under one header line, in any order; blank lines are passed over.

    optional: number columns that may be left out. InputError names the file, the line and what was expected.
    """
    try:
        rows = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""), strict=True)
        above = (row for row in rows if any(cell.strip() for cell in row))
        header = [name.strip() for name in next(above, [])]
        _check_header(header, path, required=(*texts, *numbers), optional=optional)
        found: dict[str, list[str]] = {name: [] for name in header}
        lines = []
        for row in rows:
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(header):
                commas = len(row) == 2 * len(header)
                raise InputError(
                    f"{path}: line {rows.line_num}: expected {len(header)} values "
                    f"({','.join(header)}), got {len(row)}"
                    + ("; are its decimals written with commas? expected points" if commas else "")
                )
            lines.append(rows.line_num)
            for name, cell in zip(header, row, strict=True):
                found[name].append(cell.strip())
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected UTF-8 text") from None
    except csv.Error as error:
        raise InputError(f"{path}: line {rows.line_num}: expected comma-separated values ({error})") from None
    values = {
        name: np.array(
            [_number(c, path, line, name) for c, line in zip(cells, lines, strict=True)], dtype=float
        )
        for name, cells in found.items()
        if name not in texts
    }
    return Table(path=path, numbers=values, texts={name: found[name] for name in texts}, lines=lines)


def _check_header(
    header: list[str], path: Path, *, required: tuple[str, ...], optional: tuple[str, ...]
) -> None:
    whole = ",".join(required) + (f" (and, where known, {','.join(optional)})" if optional else "")
    for mark, name in ((";", "semicolons"), ("\t", "tabs"), ("|", "bars")):
        if len(header) == 1 and mark in header[0]:
            raise InputError(
                f"{path}: line 1: its columns are separated by {name}, expected commas between columns and"
                f" points in decimals: {whole}"
            )
    for name in header:
        if name not in (*required, *optional):
            raise InputError(f"{path}: line 1: unknown column {name!r}, expected {whole}")
        if header.count(name) > 1:
            raise InputError(f"{path}: line 1: column {name} stands there twice, expected it once")
    for name in required:
        if name not in header:
            raise InputError(f"{path}: line 1: missing column {name}, expected {whole}")


def _number(cell: str, path: Path, line: int, name: str) -> float:
    try:
        value = float(cell) if "_" not in cell else math.nan
    except ValueError:
        value = math.nan
    if not abs(value) <= _LARGEST:  # NaN too
        comma = " (decimals with points, not commas)" if "," in cell else ""
        raise InputError(
            f"{path}: line {line}: column {name}: expected a finite number{comma}, got {cell[:60]!r}"
        )
    return value
