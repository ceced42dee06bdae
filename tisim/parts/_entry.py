"""Parts as plain values: their entries in material cards and other files.

    viscosity: {kind: prony, fractions: [0.2, 0.1], times_s: [1, 30], modulus: long-time}
    softening: {kind: ogden-roxburgh, r: 2, m_J_per_m3: 2000, beta: 0.1}
    fibres: {kind: holzapfel-gasser-ogden, direction: [1, 0, 0], k1_Pa: 5000, k2: 1}

`kind` is the part's registered name; the other keys are its parameters (SI), with or without the unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields
from typing import Any, Literal

from tisim.parts import _registry
from tisim.parts._part import FIELDS, Part

UNITS = ("s", "per_s", "Pa", "J_per_m3")  # behind keys of parameters whose part states no unit
_LONGEST = 200  # characters of another library's error


@dataclass(frozen=True, kw_only=True)
class EntryProblem:
    """One fault of an entry.

    Attributes
    ----------
    what : "missing", "unknown" or "value"
        A key that is missing, a key that is not known, or a value that cannot be used.
    key : str
        Key in the entry; empty if the fault is of the entry as a whole.
    text : str
        The expected value; empty for a key that is missing or not known.
    value : object
        The value found; None if the text contains it.
    """

    what: Literal["missing", "unknown", "value"]
    key: str
    text: str = ""
    value: object = None


class EntryError(ValueError):
    """An entry that is no part; its text is one sentence on all faults.

    Attributes
    ----------
    field : str
        Field of `tisim.Material`.
    problems : tuple of EntryProblem
        The faults, at least one.
    """

    def __init__(self, field: str, problems: tuple[EntryProblem, ...]) -> None:
        super().__init__(field, problems)
        self.field, self.problems = field, problems

    def __str__(self) -> str:
        return "; ".join(self._sentence(problem) for problem in self.problems)

    def _sentence(self, problem: EntryProblem) -> str:
        text = {"missing": "this key is missing", "unknown": "unknown key"}.get(problem.what, problem.text)
        value = repr(problem.value)
        got = "" if problem.value is None else f", got {value if len(value) <= 80 else value[:77] + '...'}"
        return f"key {self.field}{'.' if problem.key else ''}{problem.key}: {text}{got}"


def encode(part: Part, *, digits: int | None = None) -> dict[str, Any]:
    """A part as plain numbers, lists and words, keys with units.

    Parameters
    ----------
    part : Part
    digits : int, optional
        Significant digits of its numbers; default: all.
    """

    def number(value: Any) -> float:
        return float(value) if digits is None else float(f"{value:.{digits}g}")

    def plain(value: Any) -> Any:
        if isinstance(value, str):
            return value
        return [number(v) for v in value] if hasattr(value, "__iter__") else number(value)

    return {
        "kind": part.name,
        **{_written(part, f.name): plain(getattr(part, f.name)) for f in fields(part) if f.init},
    }


def decode(field: str, entry: object) -> Part:
    """The part that an entry states.

    Parameters
    ----------
    field : str
        One of `FIELDS`: only its kinds of parts are accepted.
    entry : mapping
        Key "kind" and the parameters, each with or without its unit, lists as lists or tuples.

    Raises
    ------
    EntryError
        If the entry is no mapping, has an unknown kind, missing, unknown or doubled keys, or invalid values.
    """
    if field not in FIELDS:
        raise ValueError(f"field: expected one of {', '.join(FIELDS)}, got {field!r}")
    if not isinstance(entry, Mapping) or not all(isinstance(key, str) for key in entry):
        raise _fault(field, "", "expected the key kind and the parameters of that kind", entry)
    kind = _kind(field, entry)
    keys = _keys(field, kind, entry)
    values = {name: entry[key] for name, key in keys.items()}
    for name, key in keys.items():
        if not _sound(values[name]):
            raise _fault(field, key, "expected a number, a word or a list of numbers", values[name])
    try:
        part = kind(**{n: tuple(v) if isinstance(v, list) else v for n, v in values.items()})
        part.check()
    except ValueError as error:  # its text begins with the parameter
        name, _, text = _one_line(error).partition(": ")
        key = keys.get(name, "")
        raise _fault(field, key, text if key else _one_line(error)) from None
    except Exception as error:  # a part from outside may raise anything
        raise _fault(field, "", f"{kind.name}: {type(error).__name__}: {_one_line(error)}") from None
    return part


def _kind(field: str, entry: Mapping[str, object]) -> type[Part]:
    known = [n for n in _registry.names() if issubclass(_registry.get(n), FIELDS[field])]
    if "kind" not in entry:
        raise EntryError(field, (EntryProblem(what="missing", key="kind"),))
    if entry["kind"] not in known:
        raise _fault(field, "kind", f"expected one of {', '.join(known)}", entry["kind"])
    return _registry.get(str(entry["kind"]))


def _keys(field: str, kind: type[Part], entry: Mapping[str, object]) -> dict[str, str]:
    """Key of each given parameter; unknown, doubled and missing keys are refused."""
    known = {f.name: f for f in fields(kind) if f.init}
    names = {key: name for name in known for key in _suffixed(kind, name)} | {name: name for name in known}
    found: dict[str, str] = {}
    problems: list[EntryProblem] = []
    for key in entry:
        if key == "kind":
            continue
        name = names.get(key)
        if name is None:
            problems.append(EntryProblem(what="unknown", key=key))
        elif name in found:
            text = f"states the same as {found[name]}: expected one of them"
            problems.append(EntryProblem(what="value", key=key, text=text))
        else:
            found[name] = key
    lacking = [name for name, own in known.items() if name not in found and not _has_default(own)]
    problems += [EntryProblem(what="missing", key=name) for name in lacking]
    if problems:
        raise EntryError(field, tuple(problems))
    return found


def _written(part: Part, name: str) -> str:
    unit = part.units.get(name)
    return f"{name}_{unit}" if unit else name


def _suffixed(kind: type[Part], name: str) -> list[str]:
    """Keys with units for a parameter: with another than its own, rates would be read as times."""
    return [f"{name}_{unit}" for unit in ((kind.units[name],) if name in kind.units else UNITS)]


def _has_default(own: Field[Any]) -> bool:
    return own.default is not MISSING or own.default_factory is not MISSING


def _sound(value: object) -> bool:
    if isinstance(value, tuple | list):
        return all(isinstance(v, int | float) and not isinstance(v, bool) for v in value)
    return isinstance(value, int | float | str) and not isinstance(value, bool)


def _one_line(error: BaseException) -> str:
    return (" ".join(str(error).split()) or type(error).__name__)[:_LONGEST]


def _fault(field: str, key: str, text: str, value: object = None) -> EntryError:
    return EntryError(field, (EntryProblem(what="value", key=key, text=text, value=value),))
