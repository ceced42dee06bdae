"""experiment.yaml into its strict model, with errors of one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from calibration.errors import InputError
from tisim.io import bounded_yaml
from tisim.io.bounded_yaml import Limits, Problem, YamlError, as_tuples

M = TypeVar("M", bound=BaseModel)

_NAMED = 8  # further problems that a sentence names

_LARGEST_FILE = 20_000_000  # bytes
_LIMITS = Limits(depth=50, values=1_000_000)
_PLAIN = f"expected plain YAML values, nested {_LIMITS.depth} deep at most and without aliases of themselves"
_EXPECTED: dict[Problem, str] = {  # of "tag", which names the tag: the loader's own sentence
    "syntax": "expected valid YAML",
    "text": "expected UTF-8 text",
    "key": "expected a plain key, found a list or a map in its place",
    "depth": _PLAIN,
    "cycle": _PLAIN,
    "values": f"expected at most {_LIMITS.values:,} values, its aliases stand for more",
    "number": "expected a number of usual size",
    "value": _PLAIN,
}


def load(text: bytes, path: Path) -> Any:
    """The values of a YAML file, with limits on its size, depth and aliases.

    Raises
    ------
    InputError
        The file is no plain YAML; one sentence that names it and the line.
    """
    if len(text) > _LARGEST_FILE:
        raise InputError(
            f"{path}: expected at most {_LARGEST_FILE / 1e6:.0f} MB, got {len(text) / 1e6:.0f} MB"
        )
    try:
        return bounded_yaml.load(text, _LIMITS)
    except YamlError as error:
        line = "" if error.line is None else f"line {error.line}: "
        expected = _EXPECTED.get(error.problem, error.text)
        if error.problem == "twice":
            expected = f"key {error.key} stands there twice, expected it once"
        raise InputError(f"{path}: {line}{expected}") from None


def top_level(text: bytes, path: Path) -> dict[Any, Any]:
    """The keys and values of a YAML file. InputError as `load`, or if it is a list or a single value."""
    data = load(text, path)
    if not isinstance(data, dict):
        raise InputError(f"{path}: expected keys and values at the top level")
    return data


def parse(text: bytes, path: Path, model: type[M]) -> M:
    """The file's content as `model`.

    Parameters
    ----------
    text : bytes
        Content of the file.
    path : Path
        File that messages name.
    model : type
        pydantic model.

    Raises
    ------
    InputError
        One sentence that names the file, the key and what was expected.
    """
    data: Any = as_tuples(top_level(text, path))
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{path}: {sentence(error, data)}") from None


def key_path(parts: Sequence[str | int], data: object) -> str:
    """trials[NAME].captures[#2].time_s: trials by their id, other lists counted from 1."""
    text = ""
    for part in parts:
        if isinstance(part, int) and isinstance(data, tuple) and part < len(data):
            data = data[part]
            own = data.get("id") if isinstance(data, dict) else None
            text += f"[{own}]" if isinstance(own, str) and len(own) <= 100 else f"[#{part + 1}]"
        elif isinstance(data, dict) and part in data:
            data = data[part]
            text += f".{part}"
        else:  # the tag of a kind of trial, which pydantic puts into the place, or a key that is not there
            if part not in ("beam", "poke", "coupon", "[key]"):
                text += f"[#{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".")


def first_reason(error: ValidationError) -> tuple[tuple[str | int, ...], str]:
    """Place of the first of a model's problems, and what was expected there."""
    first = error.errors(include_url=False)[0]
    return first["loc"], " ".join(_reason(first["type"], first.get("ctx", {}), first["msg"]).split())


def sentence(error: ValidationError, data: dict[Any, Any]) -> str:
    """The problems of a model in one sentence: the key of the first, what was expected, places of the others.

    Parameters
    ----------
    error : ValidationError
    data : dict
        What the model was made of.
    """
    return " ".join(_sentence(error, data).split())


def _sentence(error: ValidationError, data: dict[Any, Any]) -> str:
    # an unknown key comes first: it explains the key that is missing in its place
    problems = sorted(problems_of(error), key=lambda e: e["type"] != "unknown_key")
    first = problems[0]
    context: dict[str, Any] = first.get("ctx", {})
    own = [int(p) if p.isdigit() else p for p in str(context["key"]).split(".")] if "key" in context else []
    parts: list[str | int] = [*first["loc"], *own]
    if first["type"] == "unknown_key":
        parts = [*first["loc"], context["key"]]
    kind, given = first["type"], first["input"]
    if kind == "missing" and isinstance(parts[-1], int):  # a number of a list such as gravity_m_s2
        parts.pop()
        kind, reason = "too_short", "expected more numbers"
    else:
        reason = _reason(kind, context, first["msg"])
    if kind.startswith("union_tag"):
        parts.append("kind")
        given = context.get("tag")
        if kind == "union_tag_not_found":
            kind = "missing"
    plain = isinstance(given, int | float | str | bool) and kind not in ("own_check", "path", "missing")
    got = f", got {_brief(given)}" if plain else ""
    where = key_path(parts, data) or "top level"
    what = "unknown key" if kind == "unknown_key" else "missing key" if kind == "missing" else "key"
    return f"{what} {where}: {reason}{got}{context.get('also', '')}{_others(problems[1:], data)}"


def problems_of(error: ValidationError) -> list[Any]:
    """A model's problems, without lists said to be too short since pydantic counts right entries alone."""
    return [
        e
        for e in error.errors(include_url=False)
        if e["type"] != "too_short" or len(e["input"]) < e["ctx"]["min_length"]
    ]


def _others(problems: Sequence[Any], data: dict[Any, Any]) -> str:
    """The further problems by the place of each: missing keys, unknown ones, then the others."""
    groups: dict[str, list[str]] = {"missing": [], "unknown": [], "wrong": []}
    for problem in problems:
        own = problem.get("ctx", {}).get("key")
        where = key_path([*problem["loc"], *([] if own is None else [str(own)])], data) or "top level"
        kind = {"missing": "missing", "unknown_key": "unknown"}.get(problem["type"], "wrong")
        groups[kind].append(where)
    text = ""
    for kind, places in groups.items():
        if places:
            rest = len(places) - _NAMED
            text += f"; also {kind}: {', '.join(places[:_NAMED])}" + (f" and {rest} more" if rest > 0 else "")
    return text


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _reason(kind: str, context: dict[str, Any], message: str) -> str:
    match kind:
        case "missing" | "union_tag_not_found":
            return "expected it here" if kind == "missing" else "expected beam, poke or coupon"
        case "union_tag_invalid":
            return "expected beam, poke or coupon"
        case "extra_forbidden":  # of models that do not look for a key that was meant
            return "expected no such key"
        case "greater_than":
            return f"expected more than {context['gt']:g}"
        case "greater_than_equal":
            return f"expected {context['ge']:g} or more"
        case "less_than_equal":
            return f"expected at most {context['le']:g}"
        case "literal_error":
            return f"expected {context['expected']}"
        case "finite_number":
            return "expected a finite number"
        case "float_type":
            return "expected a number"
        case "int_type":
            return "expected a whole number"
        case "int_parsing_size":
            return "expected a number of usual size"
        case "string_type":
            return "expected text"
        case "tuple_type":
            return "expected a list"
        case "too_short" | "too_long":
            least = context.get("min_length", context.get("max_length"))
            return f"expected {'at least' if kind == 'too_short' else 'at most'} {least}, got " + str(
                context["actual_length"]
            )
        case "dict_type" | "model_type" | "model_attributes_type":
            return "expected keys and values"
        case "string_pattern_mismatch":
            return "expected a name of letters, digits and . , + - _ ( ) %"
        case "string_too_short":
            return "expected some text"
        case "string_too_long":
            return f"expected at most {context['max_length']} characters"
        case _:
            return message
