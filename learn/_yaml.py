"""Read YAML written by users: every fault is one sentence, and no file can exhaust time or memory."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import Field, ValidationError
from pydantic_core import ErrorDetails

from learn.errors import InputError

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]  # a number: no text, no true, no NaN
_BYTES, _EVENTS, _DEPTH = 1_000_000, 20_000, 30


class _Loader(yaml.SafeLoader):
    """Loader that refuses duplicate keys, reads numbers as YAML 1.2 does, and keeps dates as text."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise InputError(f"key {key.value}: stands twice (line {key.start_mark.line + 1})")
                seen.add(key.value)
        return super().construct_mapping(node, deep=deep)


# As in `tisim.io.bounded_yaml`, of which learn imports nothing. In YAML 1.1 a depth of 010 is octal (8), 1:30
# is of base 60 (90), and 1e-3 a text. What is no number here stays text, which a key for a number refuses.
_REPLACED = {f"tag:yaml.org,2002:{name}" for name in ("timestamp", "int", "float")}
_Loader.yaml_implicit_resolvers = {
    start: [(tag, pattern) for tag, pattern in entries if tag not in _REPLACED]
    for start, entries in _Loader.yaml_implicit_resolvers.items()
}
for _tag, _pattern in (
    ("int", r"^[-+]?(0|[1-9][0-9]*)$"),
    (
        "float",
        r"^[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))([eE][-+]?[0-9]+)?$|^[-+]?\.(inf|Inf|INF)$|^\.(nan|NaN|NAN)$",
    ),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(_pattern), list("-+.0123456789"))


def read_yaml(path: Path) -> dict[Any, Any]:
    """Read the keys and values of a YAML file. InputError for anything else.

    Refused: files beyond 1 MB, aliases (with which a small file can expand to gigabytes, or contain itself),
    nesting beyond 30 levels, more than 20,000 values, duplicate keys.
    """
    try:
        if path.stat().st_size > _BYTES:
            raise InputError(f"{path}: {path.stat().st_size} bytes, expected at most {_BYTES}")
        text = path.read_text(encoding="utf-8")
        _check_events(text)
        values = yaml.load(text, Loader=_Loader)
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(str(path)) else f"{path}: {error}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    # values such as a date of month 13 or an integer of 5,000 digits raise ValueError in their constructors
    except (yaml.YAMLError, UnicodeDecodeError, ValueError, TypeError, RecursionError) as error:
        raise InputError(f"{path}: not YAML ({' '.join(str(error).split())[:120]})") from None
    if not isinstance(values, dict):
        raise InputError(f"{path}: expected keys and values")
    return values


def _check_events(text: str) -> None:
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=yaml.SafeLoader)):
        line = event.start_mark.line + 1 if event.start_mark else 1
        if isinstance(event, yaml.AliasEvent):
            raise InputError(f"line {line}: expected no alias (*{event.anchor})")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > _DEPTH:
            raise InputError(f"line {line}: nested deeper than {_DEPTH} levels")
        if count > _EVENTS:
            raise InputError(f"more than {_EVENTS} values")


def first_fault(error: ValidationError, source: Mapping[str, Any] | None = None) -> str:
    """First fault of a validation error, as "key KEY: expectation".

    An unknown key comes before a missing one, which is named as well: it is usually the same key, misspelt.
    `source` is the validated input; models with a tagged union need it, since pydantic's path to a fault has
    the tag too.
    """
    faults = error.errors(include_url=False)
    faults.sort(key=lambda fault: fault["type"] not in ("extra_forbidden", "invalid_key"))
    first, *others = faults
    named = [first]
    if first["type"] == "extra_forbidden":
        named += [f for f in others if f["type"] == "missing" and f["loc"][:-1] == first["loc"][:-1]]
    said = []
    for fault in named:
        path, text = _in_words(fault)
        key = ".".join(_keys(path, source))
        said.append(f"key {key}: {text}" if key else text)
    left = len(faults) - len(named)
    return "; ".join(said) + (f" (and {left} more)" if left else "")


def _in_words(fault: ErrorDetails) -> tuple[tuple[Any, ...], str]:
    """The path to a fault, and what was expected there, in the words of a YAML file."""
    path, about, value = fault["loc"], fault.get("ctx", {}), fault["input"]
    chosen_by = str(about.get("discriminator")).strip("'")  # the key of a union's tag
    match fault["type"]:
        case "extra_forbidden" | "invalid_key":
            return path, "no such key"
        case "missing" if isinstance(path[-1], int):
            return path[:-1], f"expected more values, got {len(value)}"
        case "missing":
            return path, "this key is missing"
        case "union_tag_not_found":
            return (*path, chosen_by), "this key is missing"
        case "union_tag_invalid":
            return (*path, chosen_by), f"expected one of {about['expected_tags']}, got {about['tag']!r:.40}"
        case "too_long":
            return path, f"expected at most {about['max_length']} values, got {about['actual_length']}"
        case "tuple_type" | "list_type":
            return path, f"expected a list, got {value!r:.40}"
        case "model_type" | "model_attributes_type" | "dict_type":
            return path, f"expected keys and values, got {value!r:.40}"
    text = str(fault["msg"]).removeprefix("Value error, ")
    if text.startswith("Input should be "):  # of the type of a value, or a bound
        return path, f"expected {text.removeprefix('Input should be ')}, got {value!r:.40}"
    return path, f"{text}, got {value!r:.40}" if fault["type"].startswith("string") else text


def _keys(path: tuple[Any, ...], source: Any) -> list[str]:
    """The keys on the path to a fault, without the tag of a union, which is not a key of the source."""
    kept = []
    for part in path[:-1]:
        if isinstance(source, Mapping) and part not in source:
            continue
        kept.append(str(part))
        source = source[part] if isinstance(source, Mapping | list) else None
    return [*kept, *map(str, path[-1:])]
