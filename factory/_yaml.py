"""YAML files into validated pydantic models, with errors of one sentence."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from factory.errors import InputError, describe_os_error


class Strict(BaseModel):
    """Base of everything read from YAML: unknown keys, NaN and infinity are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


M = TypeVar("M", bound=BaseModel)

# tuples are written as YAML lists, which strict mode would refuse: JSON mode accepts them
_KINDS = {"extra_forbidden": "unknown key", "missing": "this key is missing"}


def read_yaml(path: Path, model: type[M]) -> M:
    """The file as `model`; InputError names the file, the key and what was expected."""
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(describe_os_error(error, "cannot read")) from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected UTF-8 text") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" at line {mark.line + 1}" if mark is not None else ""
        raise InputError(f"{path}: not valid YAML{line}") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: expected keys and values at the top level")
    try:
        return model.model_validate(_tuples(data))
    except ValidationError as error:
        raise InputError(f"{path}: {_sentence(error)}") from None


def _tuples(data: object) -> object:
    """YAML lists as tuples, the form that the frozen models hold."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    if isinstance(data, list):
        return tuple(_tuples(value) for value in data)
    return data


def _sentence(error: ValidationError) -> str:
    problems = error.errors(include_url=False)
    first = problems[0]
    key = ".".join(str(part) for part in first["loc"]) or "top level"
    reason = _KINDS.get(first["type"], first["msg"].removeprefix("Value error, "))
    reason = reason[0].lower() + reason[1:]
    if first["type"] not in _KINDS and isinstance(first["input"], int | float | str | bool):
        reason += f", got {first['input']!r}"
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return f"key {key}: {reason}{more}"
