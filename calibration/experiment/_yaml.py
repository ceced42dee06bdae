"""experiment.yaml into its strict model, with errors of one sentence."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from calibration.errors import InputError

M = TypeVar("M", bound=BaseModel)


class _Loader(yaml.SafeLoader):
    """Safe YAML that refuses a key written twice and takes 1e3 for a number."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue
            if key_node.value in seen:
                raise yaml.constructor.ConstructorError(
                    None,
                    None,
                    f"key {key_node.value} stands there twice, expected it once",
                    key_node.start_mark,
                )
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)


# YAML 1.1 reads 1e3 as text, which no one means
_Loader.yaml_implicit_resolvers = {key: list(value) for key, value in _Loader.yaml_implicit_resolvers.items()}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789")
)


def parse(text: bytes, path: Path, model: type[M]) -> M:
    """The file's content as `model`; InputError names the file, the key and what was expected."""
    try:
        data = yaml.load(text.decode("utf-8"), Loader=_Loader)
        data = _tuples(data)
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected UTF-8 text") from None
    except yaml.constructor.ConstructorError as error:
        raise InputError(f"{path}: {_line(error)}{error.problem}") from None
    except yaml.YAMLError as error:
        raise InputError(f"{path}: {_line(error)}expected valid YAML") from None
    except (RecursionError, ValueError):  # an alias within itself; a date that is none
        raise InputError(f"{path}: expected plain YAML values, without aliases of themselves") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: expected keys and values at the top level")
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{path}: {' '.join(_sentence(error, data).split())}") from None


def _line(error: yaml.YAMLError) -> str:
    mark = getattr(error, "problem_mark", None)
    return f"line {mark.line + 1}: " if mark is not None else ""


def _tuples(data: object) -> object:
    """YAML lists as tuples, the form that the frozen models hold."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    if isinstance(data, list):
        return tuple(_tuples(value) for value in data)
    return data


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


def _sentence(error: ValidationError, data: dict[Any, Any]) -> str:
    # an unknown key comes first: with it said, the key that is missing for its sake needs no words
    problems = sorted(error.errors(include_url=False), key=lambda e: e["type"] != "unknown_key")
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
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return f"{what} {where}: {reason}{got}{more}"


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _reason(kind: str, context: dict[str, Any], message: str) -> str:
    match kind:
        case "missing" | "union_tag_not_found":
            return "expected it here" if kind == "missing" else "expected beam, poke or coupon"
        case "union_tag_invalid":
            return "expected beam, poke or coupon"
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
