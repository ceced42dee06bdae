"""Safe loading of YAML: plain values within limits on nesting, aliases and numbers.

A file of a few lines can expand to gigabytes (aliases of aliases), contain itself, or nest until the parser
overflows its stack. `load` refuses such files, and mappings with a repeated key. It reads 1e3 as a number
(YAML 1.1 requires 1.0e+3) and keeps dates as text.
"""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, Literal

import yaml

Problem = Literal["syntax", "tag", "text", "key", "twice", "depth", "cycle", "values", "number", "value"]

_LARGEST_WHOLE = 2**64


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits on the contents of a file.

    Attributes
    ----------
    depth : int
        Levels of nesting after the expansion of aliases.
    values : int
        Number of scalars, lists and mappings after the expansion of aliases.
    """

    depth: int = 50
    values: int = 1_000_000


class YamlError(Exception):
    """The content is not plain YAML within the limits.

    Attributes
    ----------
    problem : str
        "syntax" (not YAML), "tag" (not plain values), "text" (not UTF-8), "key" (a list or mapping as key),
        "twice" (a repeated key), "depth" (nested too deeply), "cycle" (an alias within itself), "values" (too
        many), "number" (too large) or "value" (one that Python cannot represent or that contradicts its tag).
    text : str
        Description of the problem, without the line.
    line : int or None
        Line of the problem, counted from 1.
    key : str
        The repeated key, "" otherwise.
    """

    def __init__(self, problem: Problem, text: str, line: int | None, key: str = "") -> None:
        super().__init__(text if line is None else f"line {line}: {text}")
        self.problem, self.text, self.line, self.key = problem, text, line, key


def load(content: bytes, limits: Limits) -> Any:
    """The values of one YAML document; None if it is empty.

    Parameters
    ----------
    content : bytes
        UTF-8 text.
    limits : Limits

    Raises
    ------
    YamlError
        If the content is not plain YAML within the limits.
    """
    try:
        loader = _Loader(content.decode("utf-8"), limits)
        try:
            node = loader.get_single_node()
            if node is None:
                return None
            _measure(node, limits, {}, set())
            return loader.construct_document(node)
        finally:
            loader.dispose()
    except UnicodeDecodeError:
        raise YamlError("text", "expected UTF-8 text", None) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        words = (getattr(error, name, None) for name in ("context", "problem", "reason"))
        why = ", ".join(" ".join(str(word).split()) for word in words if word)
        tag = isinstance(error, yaml.constructor.ConstructorError)
        raise YamlError("tag" if tag else "syntax", why, None if mark is None else mark.line + 1) from None


def as_tuples(values: object) -> object:
    """The values with lists replaced by tuples, as frozen models need."""
    if isinstance(values, dict):
        return {key: as_tuples(value) for key, value in values.items()}
    if isinstance(values, list):
        return tuple(as_tuples(value) for value in values)
    return values


class _Loader(yaml.SafeLoader):
    """The safe loader, with a limit on nesting and errors that name the line of a bad value."""

    def __init__(self, text: str, limits: Limits) -> None:
        self._limits, self._depth = limits, 0
        super().__init__(text)

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self._depth += 1
        if self._depth > self._limits.depth:
            text = f"nested deeper than {self._limits.depth} levels"
            raise YamlError("depth", text, self.peek_event().start_mark.line + 1)
        try:
            return super().compose_node(parent, index)
        finally:
            self._depth -= 1

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            value = super().construct_object(node, deep)
        except (ValueError, OverflowError, TypeError, AttributeError) as error:
            # too many digits, or a tag (!!timestamp) with another type of value
            why = " ".join(str(error).split())[:200] or type(error).__name__
            problem: Problem = "number" if node.tag == "tag:yaml.org,2002:int" else "value"
            raise _fault(problem, f"cannot read the value {_short(node)} ({why})", node) from None
        if isinstance(value, int) and abs(value) >= _LARGEST_WHOLE:
            raise _fault("number", f"expected a whole number below 2^64, got {_short(node)}", node)
        return value


# Numbers are those of YAML 1.2: in 1.1, 0100 is octal (64), 16:40 of base 60 (1000), and 1e3 a text. What is
# no number here stays text, which a key that expects a number refuses.
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


def _measure(
    node: yaml.Node, limits: Limits, known: dict[int, tuple[int, int]], open_nodes: set[int]
) -> tuple[int, int]:
    """Number of nodes and levels of a node with its aliases expanded.

    An alias is the same object as its anchor, so that each node is measured only once. YamlError for cycles,
    repeated keys, or more than the limits.
    """
    if id(node) in known:
        return known[id(node)]
    if id(node) in open_nodes:
        raise _fault("cycle", "an alias stands inside of what it refers to", node)
    open_nodes.add(id(node))
    children: list[yaml.Node] = []
    if isinstance(node, yaml.MappingNode):
        _check_keys(node)
        children = [child for pair in node.value for child in pair]
    elif isinstance(node, yaml.SequenceNode):
        children = list(node.value)
    count, depth = 1, 1
    for child in children:
        nodes, levels = _measure(child, limits, known, open_nodes)
        count, depth = count + nodes, max(depth, levels + 1)
    if count > limits.values:
        text = f"holds more than {limits.values} values once its aliases are expanded"
        raise _fault("values", text, node)
    if depth > limits.depth:
        text = f"nested deeper than {limits.depth} levels once its aliases are expanded"
        raise _fault("depth", text, node)
    open_nodes.discard(id(node))
    known[id(node)] = (count, depth)
    return count, depth


def _check_keys(node: yaml.MappingNode) -> None:
    seen: dict[Hashable, yaml.Node] = {}
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise _fault("key", "expected a plain word as key", key)
        first = seen.setdefault(_value(key), key)
        if first is not key:
            text = f"key {_short(key)} is given twice (first at line {first.start_mark.line + 1})"
            raise _fault("twice", text, key, str(key.value))


def _value(key: yaml.ScalarNode) -> Hashable:
    """Value of a key: 1 and 0x1, or yes and true, are the same in a mapping."""
    if key.tag == "tag:yaml.org,2002:str":
        return str(key.value)
    try:
        value = _Loader("", Limits()).construct_object(key)
    except (YamlError, yaml.YAMLError):  # said where the values are made
        return key.tag, key.value
    return value if isinstance(value, Hashable) else (key.tag, key.value)


def _fault(problem: Problem, text: str, node: yaml.Node, key: str = "") -> YamlError:
    return YamlError(problem, text, node.start_mark.line + 1, key)


def _short(node: yaml.Node) -> str:
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else "here"
    return text if len(text) <= 40 else f"{text[:37]}..."
