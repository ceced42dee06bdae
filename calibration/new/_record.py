"""The columns of a machine's record that a trial needs, in SI, with their units and signs settled."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment._files import MOST_LINES, MOST_LOST, longest_growing
from calibration.lab_files import (
    DIMENSIONS,
    Column,
    LabTest,
    Quantity,
    name_and_unit,
    plain,
    pulls,
    read_lab_file,
    unit,
)
from calibration.new._answers import CouponAnswers, PokeAnswers, fits
from calibration.new._asking import above_zero, any_number, one_of, some_text
from calibration.new._trial import Array, Work

_PUSHED = re.compile(r"compress|druck|indent|stauch", re.IGNORECASE)
_PULLED = re.compile(r"\b(tensi|pull|traction|zug)", re.IGNORECASE)  # neither "extension" nor "pretension"
# dimensions of the machine, and of more than what is stretched
_NOT_THE_SPECIMEN = re.compile(r"\b(platen|jaw|indenter|probe|punch|overall|total|final|speed|rates?)\b")
_USUAL: dict[str, str] = {"time": "s", "length": "mm", "force": "N", "ratio": "1 or %", "stress": "kPa"}


@dataclass(kw_only=True)
class Record:
    """A test of a file, for one trial."""

    work: Work
    entry: CouponAnswers | PokeAnswers
    test: LabTest
    kept: NDArray[np.intp] | None = None  # rows, where some were left out

    @property
    def where(self) -> str:
        return self.entry.id

    def column(self, quantity: Quantity) -> Column | None:
        """The column of a quantity: the one that the answers name, or the only one; None where there is none.

        Raises
        ------
        InputError
            The named one is not there, or several are and nobody says which.
        """
        named = self.entry.columns.get(quantity)
        if named is not None:
            if named.lower() == "none":
                return None
            bare, given = name_and_unit(named)
            fitting = [c for c in self.test.columns if c.header in (named, bare)]
            if fitting:  # with the unit that is named, where several have the name
                return next((c for c in fitting if c.unit == given), fitting[0])
            known = ", ".join(c.header for c in self.test.columns if c.header)
            raise self.error(f"expected a column {named!r} (columns.{quantity}), there are {known}")
        found = self.test.with_quantity(quantity)
        if len(found) < 2:
            return found[0] if found else None
        headers = [c.header for c in found]
        if len(set(headers)) < len(headers):
            headers = [f"{c.header} ({c.unit.text})" if c.unit else c.header for c in found]
        name = self.work.settle(
            self.where,
            f"columns.{quantity}",
            None,
            f"which column holds the {quantity}: {' | '.join(headers)}",
            one_of(headers),
        )
        return found[headers.index(name)]

    def si(self, column: Column, quantity: Quantity) -> Array:
        """A column's numbers in SI."""
        dimension = DIMENSIONS[quantity]
        stated = self.entry.units.get(column.header)
        if stated is not None and not fits(quantity, stated):
            raise self.error(f"units.{column.header}: expected a unit of {dimension}, got {stated}")
        if stated is None and column.unit is not None:
            if column.unit.dimension != dimension:
                raise self.error(
                    f"column {column.header}: expected a unit of {dimension} for the {quantity}, the file"
                    f" says {column.unit.text}"
                )
            return self._numbers(column) * column.unit.factor
        if stated is not None and column.unit is not None and column.unit.text != stated:
            self.work.defaults.append(
                f"{self.where}: column {column.header} taken in {stated}, the file says {column.unit.text}"
            )
        text = self.work.settle(
            self.where,
            f"units.{column.header}",
            stated,
            f"the unit of the column {column.header} ({_USUAL[dimension]}), the file states none",
            _unit_of(quantity),
        )
        known = unit(text)
        assert known is not None
        return self._numbers(column) * known.factor

    def _numbers(self, column: Column) -> Array:
        values = self.test.numbers(column, self.entry.decimals)
        return values if self.kept is None else values[self.kept]

    def time(self, *, needed: bool) -> Array | None:
        """Time of each row [s], growing and from 0 on; asked for before other columns.

        Where the answers say so, the fewest rows against which the clock runs are left out, of all columns.

        Raises
        ------
        InputError
            It is needed and missing, or it stands still or runs backwards.
        """
        column = self.column("time")
        if column is None:
            if needed:
                raise self.error("expected a column of time")
            if self.entry.leave_out_rows:
                raise self.error("leave_out_rows: expected a column of time, against which rows would stand")
            return None
        time = self.si(column, "time")
        without = "" if needed else "; columns: {time: none} goes on without the time"
        if time[0] < 0:
            raise self.line(0, f"column {column.header}: expected 0 s or more, got {time[0]:g}{without}")
        bad = np.flatnonzero(np.diff(time) <= 0)
        if bad.size and self.entry.leave_out_rows:
            self.kept = np.array(longest_growing(time), dtype=np.intp)
            lost = sorted(set(range(len(time))) - set(self.kept.tolist()))
            if len(lost) > MOST_LOST * len(time):
                raise self.error(
                    f"column {column.header}: expected that it grows, but {len(lost)} of {len(time)} rows"
                    " stand against it"
                )
            lines = ", ".join(str(self.test.rows[k]) for k in lost[:MOST_LINES])
            more = f" and {len(lost) - MOST_LINES} more" if len(lost) > MOST_LINES else ""
            self.work.defaults.append(
                f"{self.where}: the clock runs backwards in lines {lines}{more}, left out"
            )
            return time[self.kept]
        if bad.size:
            at = int(bad[0]) + 1
            raise self.line(
                at,
                f"column {column.header}: expected more than {time[at - 1]:g} s before it, got {time[at]:g}"
                f"; leave_out_rows: true goes on without such rows{without.replace(' goes on', '')}",
            )
        return time

    def towards_tension(self, column: Column, values: Array) -> float:
        """1 where positive values are a pull, -1 where they are a push.

        Taken from the column's name where that says it and the file says nothing against it; asked otherwise.
        """
        given = self.entry.displacement_positive
        if given is None:
            named = pulls(column.header)
            texts = [*self.test.parameters.values(), *self.test.parameters]
            about = " ".join([self.test.name, *texts, *(c.header for c in self.test.columns)])
            rises = float(values.max()) > -float(values.min())
            pushed = bool(_PUSHED.search(about)) and not _PULLED.search(about)
            # a column of strain that rises in a compression test has the push positive, against its name
            if named is True and rises and (pushed or isinstance(self.entry, PokeAnswers)):
                named = None
            if named is False and not rises and isinstance(self.entry, CouponAnswers):
                named = None
            if named is not None:
                word = "tension" if named else "compression"
                self.work.defaults.append(
                    f"{self.where}.displacement_positive {word} (by the name of the column {column.header})"
                )
                return 1.0 if named else -1.0
        found = self.work.settle(
            self.where,
            "displacement_positive",
            given,
            f"tension or compression: what positive values of the column {column.header} mean",
            one_of(("tension", "compression")),
        )
        return 1.0 if found == "tension" else -1.0

    def zeroed(self, column: Column, values: Array, what: str) -> Array:
        """Displacement from where the test begins [m]: the first row's, unless the answers say another."""
        first = float(values[0]) * 1e3
        if self.entry.displacement_zero_mm is None and abs(first) < 1e-9:
            return values
        zero = self.work.settle(
            self.where,
            "displacement_zero_mm",
            self.entry.displacement_zero_mm,
            f"reading of the column {column.header} {what} [mm]",
            any_number,
            default=first,
            why="the record's first row",
        )
        return values - float(zero) * 1e-3

    def force_sign(self, force: Array, along: Array) -> float:
        """1 or -1, so that the force grows with the displacement along it, as any specimen's does.

        Parameters
        ----------
        force, along : array, shape (k,)
            As recorded, and the displacement or strain with its sign settled.
        """
        if self.entry.force_positive is not None:
            return 1.0 if self.entry.force_positive == "tension" else -1.0
        if float(np.sum((force - force[0]) * (along - along[0]))) >= 0:
            return 1.0
        self.work.defaults.append(f"{self.where}: the force turned round, to grow with the displacement")
        return -1.0

    def length(self, key: str, pattern: str, text: str) -> float:
        """A length of the specimen [m]: the answers', the file header's (not for an empty pattern), or
        asked."""
        given = getattr(self.entry, key)
        header = None if given is not None or not pattern else self.stated(pattern, "length")
        value = self.work.settle(
            self.where,
            key,
            given,
            text,
            above_zero,
            default=None if header is None else round(header * 1e3, 9),
            why="" if header is None else f"read from the header of {self.test.file.path.name}",
        )
        return float(value) * 1e-3

    @property
    def entry_area(self) -> float | None:
        """Rest area by the answers [m2], without asking."""
        entry = self.entry
        assert isinstance(entry, CouponAnswers)
        if entry.area_mm2 is not None:
            return entry.area_mm2 * 1e-6
        if entry.diameter_mm is not None:
            return math.pi / 4 * (entry.diameter_mm * 1e-3) ** 2
        if entry.width_mm is not None and entry.thickness_mm is not None:
            return entry.width_mm * entry.thickness_mm * 1e-6
        return None

    def area(self, *, sheared: bool = False) -> float:
        """Rest area that bears the force [m2]: by the answers, or the file's header, or asked.

        sheared : in simple shear it is no section that a header states.
        """
        entry = self.entry
        assert isinstance(entry, CouponAnswers)
        if self.entry_area is not None:
            return self.entry_area
        if entry.width_mm is not None or entry.thickness_mm is not None:
            width = self.length("width_mm", "width|breite", "the specimen's width at rest [mm]")
            return width * self.length(
                "thickness_mm", "thickness|dicke", "the specimen's thickness at rest [mm]"
            )
        header = None if sheared else self.header_area()
        text = "the sheared area, along which the force acts [mm2]"
        if not sheared:
            others = "(or diameter_mm, or width_mm and thickness_mm)"
            text = f"the area of the specimen's section at rest [mm2] {others}"
        value = self.work.settle(
            self.where,
            "area_mm2",
            None,
            text,
            above_zero,
            default=None if header is None else round(header * 1e6, 9),
            why="" if header is None else f"read from the header of {self.test.file.path.name}",
        )
        return float(value) * 1e-6

    def header_area(self) -> float | None:
        """Rest area by the file's header [m2]; None where it states none, or several that differ."""
        area = self.stated("cross.?section|area|querschnitt|flache", "area")
        diameter = self.stated("diameter|durchmesser", "length")
        width, thickness = self.stated("width|breite", "length"), self.stated("thickness|dicke", "length")
        found = [] if area is None else [area]
        found += [] if diameter is None else [math.pi / 4 * diameter**2]
        found += [] if width is None or thickness is None else [width * thickness]
        return found[0] if found and max(found) <= 1.02 * min(found) else None

    def stated(self, pattern: str, dimension: str) -> float | None:
        """A parameter above the table by its name, in SI.

        None where there is none with a unit, or several that differ: which of them is meant is asked.
        InputError where its decimals cannot be told from thousands.
        """
        found: list[float] = []
        for name, text in self.test.parameters.items():
            if _NOT_THE_SPECIMEN.search(plain(name)) or not re.search(pattern, plain(name)):
                continue
            own, in_name = name_and_unit(name)
            value = re.match(r'"?([-+]?\d+(?:[.,]\d+)*)"?\s*(\S*)', text)
            given = in_name if value and not value[2] else unit(value[2]) if value else None
            if value and given is not None and given.dimension == dimension and own:
                size = self.test.number_above(value[1], self.entry.decimals)
                found += [] if size is None else [size * given.factor]
        found = [value for value in found if value > 0]
        return found[0] if found and max(found) <= (1 + 1e-6) * min(found) else None

    def error(self, text: str) -> InputError:
        """An error of this test as a whole."""
        test = f" test {self.test.name}:" if self.test.name else ""
        return InputError(f"{self.test.file.path}:{test} {text}")

    def line(self, row: int, text: str) -> InputError:
        """An error at one of its rows, counted among those that are kept."""
        at = row if self.kept is None else int(self.kept[row])
        return self.test.file.error(text, self.test.rows[at], sheet=self.test.sheet)


def open_record(work: Work, entry: CouponAnswers | PokeAnswers) -> Record:
    """The test of a file that a trial names.

    Raises
    ------
    InputError
        The file cannot be read, or holds several tests and nobody says which.
    """
    path = work.source(entry.file, f"{entry.id}.file")
    _, tests = read_lab_file(path, format=entry.format)
    work.copy(path, "source")
    record = _chosen(work, entry, path, tests)
    headers = [c.header for c in record.test.columns]
    for name in entry.units:
        if name not in headers:
            raise record.error(
                f"units.{name}: expected a column of this name, there are {', '.join(headers)}"
            )
    return record


def _chosen(work: Work, entry: CouponAnswers | PokeAnswers, path: Path, tests: tuple[LabTest, ...]) -> Record:
    names = [t.name or f"test {k}" for k, t in enumerate(tests, 1)]
    if entry.test is None and len(tests) == 1:
        return Record(work=work, entry=entry, test=tests[0])
    wanted = work.settle(
        entry.id,
        "test",
        entry.test,
        f"which test of {path.name}, by name or number: {' | '.join(names)[:500]}",
        some_text,
    )
    if isinstance(wanted, int) or (isinstance(wanted, str) and wanted.isdigit() and wanted not in names):
        number = int(wanted)
        if not 1 <= number <= len(tests):
            raise InputError(f"{path}: key {entry.id}.test: expected 1 to {len(tests)}, got {number}")
        return Record(work=work, entry=entry, test=tests[number - 1])
    if names.count(wanted) != 1:
        raise InputError(
            f"{path}: key {entry.id}.test: expected one of {', '.join(names)[:300]}, got {wanted!r}"
        )
    return Record(work=work, entry=entry, test=tests[names.index(wanted)])


def _unit_of(quantity: Quantity) -> Callable[[str], str]:
    def reader(text: str) -> str:
        if not fits(quantity, text):
            raise ValueError(f"expected a unit of {DIMENSIONS[quantity]}, got {text!r}")
        return text

    return reader
