"""Who is asked what an answers file leaves open: the lab at its terminal, or nobody."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import typer

from calibration.errors import InputError

SD = (
    "A standard deviation (sd) says how far a repeated measurement falls from its mean: two of three lie"
    " within one sd. Measure the same thing five times and take the spread, or half a division of the scale."
    " 0 means exact. One that is too small makes the result surer than the lab is."
)


@dataclass(frozen=True, kw_only=True)
class Question:
    """One question about an experiment.

    Attributes
    ----------
    key : str
        Key in the answers file.
    text : str
        The quantity, with its unit.
    read : callable
        Text to value; ValueError says what was expected.
    default : object
        Value if nobody answers; None for none.
    why : str
        Origin of the default, for the written file.
    help : str
        Explanation for whoever answers.
    kept : bool
        True if it is a key of an answers file; False if it follows from other answers.
    """

    key: str
    text: str
    read: Callable[[str], Any]
    default: Any = None
    why: str = ""
    help: str = ""
    kept: bool = True


class Asker(Protocol):
    """Source of answers: a prompt or a file."""

    @property
    def place(self) -> str:
        """Name of the source, for messages."""
        ...

    def ask(self, where: str, question: Question) -> tuple[Any, bool]:
        """The answer, and whether it is the default."""
        ...

    def confirm(self, where: str, name: str, sentence: str) -> bool:
        """True if something implausible is meant; name: of the check."""
        ...

    @property
    def lacks(self) -> bool:
        """True if an answer is missing, and another value stands in for it."""
        ...

    def complete(self) -> None:
        """Raise InputError if an answer is missing."""
        ...


# text of a value that any question takes: for keys that are missing, so that those behind them are found too
_STAND_INS = ("1", "1, 1", "1, 1, 1", "m: 1, 1, 1", "s", "mm", "N", "kPa")


@dataclass(frozen=True)
class Nobody:
    """An answers file that has to say everything that has no default.

    Attributes
    ----------
    path : Path
    missing : dict
        Text of the question by the key that is missing.
    behind : set of str
        Keys that hang on a missing answer, and beginnings of such: which of them are asked is not known yet.
    """

    path: Path
    missing: dict[str, str] = field(default_factory=dict)
    behind: set[str] = field(default_factory=set)

    @property
    def place(self) -> str:
        return str(self.path)

    @property
    def lacks(self) -> bool:
        return bool(self.missing)

    def ask(self, where: str, question: Question) -> tuple[Any, bool]:
        if question.default is not None:
            return question.default, True
        key = f"{where}.{question.key}"
        value = _stand_in(question)
        if not any(key == k or key.startswith(f"{k}.") for k in self.behind):
            self.missing[key] = question.text
        self.behind.add(key)
        if question.key.startswith("columns."):
            self.behind.add(f"{where}.units.{value}")
        elif question.key == "material":
            self.behind.add(f"materials.{value}")
        return value, False

    def lack(self, key: str, text: str, *, behind: str) -> None:
        """Take up a key that is missing, and the beginning of the keys that hang on it."""
        self.missing[key] = text
        self.behind.add(behind)

    def confirm(self, where: str, name: str, sentence: str) -> bool:
        raise InputError(f"{self.path}: key {where}: {sentence} (if it is right, say so: accept: [{name}])")

    def complete(self) -> None:
        if not self.missing:
            return
        keys: dict[str, list[str]] = {}
        for key, text in self.missing.items():  # trials that lack the same are named together
            keys.setdefault(text, []).append(key)
        if len(keys) == 1:
            ((text, own),) = keys.items()
            said = f"{', '.join(own)}: expected {text}"
        else:
            said = ", ".join(f"{', '.join(own)} (expected {text})" for text, own in keys.items())
        raise InputError(f"{self.path}: missing key{'s' * (len(self.missing) > 1)} {said}")


def _stand_in(question: Question) -> Any:
    """A value that stands in for a missing answer while further ones are looked for."""
    for text in _STAND_INS:
        with contextlib.suppress(ValueError):
            return question.read(text)
    raise ValueError(f"no value stands in for {question.key}")


@dataclass
class Terminal:
    """The lab, by prompts; what it says goes into `raw`, the answers file that says the same."""

    raw: dict[str, Any]
    explained: set[str] = field(default_factory=set)

    @property
    def place(self) -> str:
        return "answers"

    def ask(self, where: str, question: Question) -> tuple[Any, bool]:
        if question.help and question.help not in self.explained:
            typer.echo(f"  {question.help}")
            self.explained.add(question.help)
        default = None if question.default is None else shown(question.default)
        label = f"{where}: {question.text}" + (f" ({question.why})" if question.why else "")
        while True:
            text = prompted(label, default)
            if default is not None and text == default:
                return question.default, True
            try:
                value = question.read(text)
            except ValueError as error:
                typer.echo(f"  {error}")
                continue
            if question.kept:
                note(self.raw, where, question.key, value)
            return value, False

    def confirm(self, where: str, name: str, sentence: str) -> bool:
        if prompted(f"{where}: {sentence} Is that right? y or n", "n").lower() not in ("y", "yes"):
            raise InputError(f"{where}: {sentence}")
        _place(self.raw, where).setdefault("accept", []).append(name)
        return True

    @property
    def lacks(self) -> bool:
        return False

    def complete(self) -> None:
        pass


def prompted(label: str, default: str | None = None) -> str:
    """Text typed at a prompt, stripped; the end of the input stops the command."""
    try:
        return str(typer.prompt(label, default=default, show_default=default is not None)).strip()
    except typer.Abort:
        raise KeyboardInterrupt from None


def note(raw: dict[str, Any], where: str, key: str, value: Any) -> None:
    """Put an answer where an answers file has it.

    Parameters
    ----------
    raw : dict
        The answers; its trials are there already.
    where : str
        id of a trial, which "captures[#2]" may follow, "materials." and a name, or "photographs".
    key : str
        Its parts are separated by dots; a column's name behind "units." may hold some.
    """
    node = _place(raw, where)
    *path, last = key.split(".", 1) if key.startswith("units.") else key.split(".")
    for part in path:
        node = node.setdefault(part, {})
    node[last] = value


def _place(raw: dict[str, Any], where: str) -> dict[str, Any]:
    if where.startswith("materials."):
        found: dict[str, Any] = raw["materials"].setdefault(where.removeprefix("materials."), {})
        return found
    for trial in raw["trials"]:
        name = str(trial["id"])
        if where == name:
            own: dict[str, Any] = trial
            return own
        if where.startswith(f"{name}.captures[#"):
            capture: dict[str, Any] = trial["captures"][int(where[len(name) + 11 : -1]) - 1]
            return capture
    if where == "photographs":
        board: dict[str, Any] = raw.setdefault(where, {})
        return board
    raise ValueError(where)


def shown(value: Any) -> str:
    """A value as one types it."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(shown(v) for v in value)
    return str(value)


def above_zero(text: str) -> float:
    """A number above 0."""
    value = _number(text)
    if value <= 0:
        raise ValueError(f"expected a number above 0, got {text!r}")
    return value


def zero_or_more(text: str) -> float:
    """A number of 0 or more."""
    value = _number(text)
    if value < 0:
        raise ValueError(f"expected 0 or more, got {text!r}")
    return value


def any_number(text: str) -> float:
    """A number."""
    return _number(text)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise ValueError(f"expected a number, got {text!r}") from None
    if not abs(value) < 1e9:
        raise ValueError(f"expected a number of usual size, got {text!r}")
    return value


def numbers(count: int, read: Callable[[str], float] = any_number) -> Callable[[str], list[float]]:
    """Reader of some numbers, separated by commas or blanks."""

    def reader(text: str) -> list[float]:
        parts = text.replace(",", " ").replace("x", " ").split()
        if len(parts) != count:
            raise ValueError(f"expected {count} numbers, got {text!r}")
        return [read(part) for part in parts]

    return reader


def one_of(choices: Sequence[str] | Mapping[str, str]) -> Callable[[str], str]:
    """Reader of one of some words, or its number from 1 on."""
    words = list(choices)

    def reader(text: str) -> str:
        if text in words:
            return text
        if text.isdigit() and 1 <= int(text) <= len(words):
            return words[int(text) - 1]
        raise ValueError(f"expected one of {', '.join(words)}, got {text!r}")

    return reader


def some_text(text: str) -> str:
    """Text that is not empty."""
    if not text:
        raise ValueError("expected some text")
    return text
