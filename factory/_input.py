"""Input that people write: errors of one sentence, and YAML files read into validated models."""

from __future__ import annotations

import difflib
import importlib.resources
import stat
from collections.abc import Hashable
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import PydanticCustomError

MAX_BYTES = 1_000_000  # of a YAML file
MAX_DEPTH = 40  # levels of nesting, aliases expanded
MAX_NODES = 50_000  # scalars, lists and mappings, aliases expanded
_LARGEST_WHOLE = 2**64


class InputError(Exception):
    """Bad input or an unusable target; its text is one sentence for people (exit code 2)."""


def describe_os_error(error: OSError, doing: str) -> str:
    """One sentence for a failed file operation: what was being done, where, and the system's reason."""
    where = f" {error.filename}" if error.filename else ""
    return f"{doing}{where}: {error.strerror or error}"


def one_line(error: BaseException, limit: int = 200) -> str:
    """The text of an error of another library on one line; its type where it has no text."""
    return (" ".join(str(error).split()) or type(error).__name__)[:limit]


def shipped_folder(name: str) -> Path:
    """Folder of the recipes or material cards that come with the package.

    Parameters
    ----------
    name : {"recipes", "materials"}

    Returns
    -------
    Path
        `factory/_shipped/NAME` of an installed wheel, `datasets/NAME` of a checkout.
    """
    installed = Path(str(importlib.resources.files("factory"))) / "_shipped" / name
    return installed if installed.is_dir() else Path(__file__).parent.parent / "datasets" / name


class Strict(BaseModel):
    """Base of everything read from YAML: unknown keys, NaN and infinity are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


M = TypeVar("M", bound=BaseModel)


def read_yaml(path: Path, model: type[M]) -> M:
    """Read a YAML file into a model.

    Raises
    ------
    InputError
        In one sentence that names the file, the key and what was expected.
    """
    try:
        return model.model_validate(_tuples(read_mapping(path)))
    except ValidationError as error:
        raise InputError(f"{path}: {validation_sentence(error)}") from None


def read_mapping(path: Path) -> dict[Any, Any]:
    """Read the keys and values of a YAML file, within limits on size, depth, aliases and numbers.

    Raises
    ------
    InputError
        Where the file cannot be read, is no YAML, repeats a key, or exceeds a limit.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"cannot read {path}: expected a file")
        if status.st_size > MAX_BYTES:
            raise InputError(f"{path}: expected at most {MAX_BYTES} bytes, got {status.st_size}")
        data = _load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(describe_os_error(error, "cannot read")) from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected UTF-8 text") from None
    except _RefusedError as error:
        raise InputError(f"{path}: {error}") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" at line {mark.line + 1}" if mark is not None else ""
        words = (getattr(error, name, None) for name in ("context", "problem", "reason"))
        why = ", ".join(" ".join(str(word).split()) for word in words if word)
        why = f": {why}" if why else ""
        raise InputError(f"{path}: not valid YAML{line}{why}") from None
    if not isinstance(data, dict):
        raise InputError(f"{path}: expected keys and values at the top level")
    return data


class _RefusedError(yaml.YAMLError):
    """YAML that is valid but beyond a limit; the text is for people."""

    def __init__(self, node_or_mark: yaml.Node | yaml.Mark | None, text: str) -> None:
        mark: Any = getattr(node_or_mark, "start_mark", node_or_mark)
        super().__init__(f"line {mark.line + 1}: {text}" if mark is not None else text)


class _Loader(yaml.SafeLoader):
    """The safe loader, with a limit on nesting and errors that name the line of a bad value."""

    _depth = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise _RefusedError(self.peek_event().start_mark, f"nested deeper than {MAX_DEPTH} levels")
        try:
            return super().compose_node(parent, index)
        finally:
            self._depth -= 1

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            value = super().construct_object(node, deep)
        except (ValueError, OverflowError) as error:  # a date or a number that Python cannot hold
            raise _RefusedError(node, f"cannot read the value {_short(node)} ({one_line(error)})") from None
        if isinstance(value, int) and abs(value) >= _LARGEST_WHOLE:
            raise _RefusedError(node, f"expected a whole number below 2^64, got {_short(node)}")
        return value


def _load(text: str) -> Any:
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        _measure(node, {}, set())
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _measure(node: yaml.Node, known: dict[int, tuple[int, int]], open_nodes: set[int]) -> tuple[int, int]:
    """Nodes and levels below a node with its aliases expanded; refuses cycles and repeated keys.

    An alias is the same object as its anchor, so each node is measured once however often it is used.
    """
    if id(node) in known:
        return known[id(node)]
    if id(node) in open_nodes:
        raise _RefusedError(node, "an alias stands inside of what it refers to")
    open_nodes.add(id(node))
    children: list[yaml.Node] = []
    if isinstance(node, yaml.MappingNode):
        _check_keys(node)
        children = [child for pair in node.value for child in pair]
    elif isinstance(node, yaml.SequenceNode):
        children = list(node.value)
    count, depth = 1, 1
    for child in children:
        nodes, levels = _measure(child, known, open_nodes)
        count, depth = count + nodes, max(depth, levels + 1)
    if count > MAX_NODES:
        raise _RefusedError(node, f"holds more than {MAX_NODES} values once its aliases are expanded")
    if depth > MAX_DEPTH:
        raise _RefusedError(node, f"nested deeper than {MAX_DEPTH} levels once its aliases are expanded")
    open_nodes.discard(id(node))
    known[id(node)] = (count, depth)
    return count, depth


def _check_keys(node: yaml.MappingNode) -> None:
    seen: dict[Hashable, yaml.Node] = {}
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise _RefusedError(key, "expected a plain word as key")
        first = seen.setdefault((key.tag, key.value), key)
        if first is not key:
            before = first.start_mark.line + 1
            raise _RefusedError(key, f"key {_short(key)} is given twice (first at line {before})")


def _short(node: yaml.Node) -> str:
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else "here"
    return text if len(text) <= 40 else f"{text[:37]}..."


def _tuples(data: object) -> object:
    """YAML lists as tuples, the form that the frozen models hold."""
    if isinstance(data, dict):
        return {key: _tuples(value) for key, value in data.items()}
    if isinstance(data, list):
        return tuple(_tuples(value) for value in data)
    return data


def validation_sentence(error: ValidationError) -> str:
    """What is wrong with input, in one sentence: all missing and unknown keys, and the first other fault."""
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


def nested_problems(error: ValidationError) -> PydanticCustomError:
    """The problems of a model that a validator calls, to be raised there: reported under the outer key."""
    return PydanticCustomError(
        "nested", "{text}", {"text": "nested", "problems": error.errors(include_url=False)}
    )


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


def _fault(problem: Any) -> str:
    reason = problem["msg"].removeprefix("Value error, ")
    reason = reason[0].lower() + reason[1:]
    if isinstance(problem["input"], int | float | str | bool):
        value = repr(problem["input"])
        reason += f", got {value if len(value) <= 80 else value[:77] + '...'}"
    return f"key {_key(problem['loc'])}: {reason}"
