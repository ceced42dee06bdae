"""YAML files written by users, read into validated models."""

from __future__ import annotations

import difflib
import stat
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import PydanticCustomError

from factory.errors import InputError, describe_os_error
from tisim.io.bounded_yaml import Limits, YamlError, as_tuples, load

MAX_BYTES = 1_000_000  # of a YAML file
LIMITS = Limits(depth=40, values=50_000)


class Strict(BaseModel):
    """Base of all models read from YAML: unknown keys, NaN and infinity are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


M = TypeVar("M", bound=BaseModel)


def read_yaml(path: Path, model: type[M]) -> M:
    """Read a YAML file into a model.

    Raises
    ------
    InputError
        If the file is not valid; one sentence names the file, the key and the expected value.
    """
    try:
        return model.model_validate(as_tuples(read_mapping(path)))
    except ValidationError as error:
        raise InputError(f"{path}: {validation_sentence(error)}") from None


def read_mapping(path: Path) -> dict[Any, Any]:
    """Read the keys and values of a YAML file, within limits on size, depth, aliases and numbers.

    Raises
    ------
    InputError
        If the file cannot be read, is not YAML, repeats a key, or exceeds a limit.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"cannot read {path}: expected a file")
        if status.st_size > MAX_BYTES:
            raise InputError(f"{path}: expected at most {MAX_BYTES} bytes, got {status.st_size}")
        data = load(path.read_bytes(), LIMITS)
    except OSError as error:
        raise InputError(describe_os_error(error, "cannot read")) from None
    except YamlError as error:
        if error.problem not in ("syntax", "tag"):
            raise InputError(f"{path}: {error}") from None
        line = "" if error.line is None else f" at line {error.line}"
        raise InputError(f"{path}: not valid YAML{line}{': ' if error.text else ''}{error.text}") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: expected keys and values at the top level")
    return data


def validation_sentence(error: ValidationError) -> str:
    """One sentence on invalid input: all missing and unknown keys, and the first other fault."""
    problems = _flat(error.errors(include_url=False))
    missing = [_key(p["loc"]) for p in problems if p["type"] == "missing"]
    unknown = [_key(p["loc"]) for p in problems if p["type"] == "extra_forbidden"]
    others = [p for p in problems if p["type"] not in ("missing", "extra_forbidden")]
    found = []
    if missing:
        found.append(_keys(missing, "is missing", "are missing"))
    for key in unknown:
        near = difflib.get_close_matches(key, missing, n=1)
        found.append(f"key {key}: unknown key" + (f" (did you mean {near[0]}?)" if near else ""))
    if others:
        more = f" (and {len(others) - 1} more)" if len(others) > 1 else ""
        found.append(_fault(others[0]) + more)
    return "; ".join(found)


def nested_problems(error: ValidationError, *, under: tuple[int | str, ...] = ()) -> PydanticCustomError:
    """Error that a validator raises for a nested model, so that its problems appear under the outer key.

    `under` holds the keys between the outer key and the problems.
    """
    problems = [{**problem, "loc": (*under, *problem["loc"])} for problem in error.errors(include_url=False)]
    return PydanticCustomError("nested", "{text}", {"text": "nested", "problems": problems})


def _flat(problems: Any, outer: tuple[int | str, ...] = ()) -> list[Any]:
    found: list[Any] = []
    for problem in problems:
        where = (*outer, *problem["loc"])
        if problem["type"] == "nested":
            found += _flat(problem["ctx"]["problems"], where)
        else:
            found.append({**problem, "loc": where})
    return found


def _keys(keys: list[str], one: str, several: str) -> str:
    if len(keys) == 1:
        return f"key {keys[0]}: this key {one}"
    return f"keys {', '.join(keys)}: these keys {several}"


def _key(loc: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in loc) or "top level"


# pydantic's sentences that do not speak of YAML, in words that do
_IN_YAML = {
    "tuple_type": "expected a list",
    "invalid_key": "expected a name (decimals have points; after a comma begins the next key)",
}


def _fault(problem: Any) -> str:
    reason = _IN_YAML.get(problem["type"], problem["msg"].removeprefix("Value error, "))
    reason = reason[0].lower() + reason[1:]
    if isinstance(problem["input"], int | float | str | bool):
        value = repr(problem["input"])
        reason += f", got {value if len(value) <= 80 else value[:77] + '...'}"
    return f"key {_key(problem['loc'])}: {reason}"
