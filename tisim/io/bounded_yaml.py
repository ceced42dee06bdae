"""YAML that people write: plain values within limits on nesting, aliases and numbers.

A file of a few lines can stand for gigabytes (aliases of aliases), contain itself, or nest until the parser
runs out of stack. `load` refuses those, and a key that stands twice in a mapping; it reads 1e3 as a number
(YAML 1.1 wants 1.0e+3) and leaves dates as text.
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
        Levels of nesting, aliases expanded.
    values : int
        Scalars, lists and mappings, aliases expanded.
    """

    depth: int = 50
    values: int = 1_000_000


class YamlError(Exception):
    """A file that is no plain YAML within the limits.

    Attributes
    ----------
    problem : str
        "syntax" (no YAML), "tag" (beyond plain values), "text" (no UTF-8), "key" (a list or mapping as key),
        "twice" (a key), "depth", "cycle" (an alias within itself), "values" (too many), "number" (too large)
        or "value" (one that Python cannot hold, or of another tag than it is written).
    text : str
        What is wrong, without the line.
    line : int or None
        Counted from 1.
    key : str
        The key that stands twice, "" otherwise.
    """

    def __init__(self, problem: Problem, text: str, line: int | None, key: str = "") -> None:
        super().__init__(text if line is None else f"line {line}: {text}")
        self.problem, self.text, self.line, self.key = problem, text, line, key


def load(content: bytes, limits: Limits) -> Any:
    """The values of one YAML document; None where it is empty.

    Parameters
    ----------
    content : bytes
        UTF-8 text.
    limits : Limits

    Raises
    ------
    YamlError
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
    """The same values with tuples for lists, the form that frozen models hold."""
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
            # digits without end, or a tag (!!timestamp) whose value is none
            why = " ".join(str(error).split())[:200] or type(error).__name__
            problem: Problem = "number" if node.tag == "tag:yaml.org,2002:int" else "value"
            raise _fault(problem, f"cannot read the value {_short(node)} ({why})", node) from None
        if isinstance(value, int) and abs(value) >= _LARGEST_WHOLE:
            raise _fault("number", f"expected a whole number below 2^64, got {_short(node)}", node)
        return value


_Loader.yaml_implicit_resolvers = {
    start: [(tag, pattern) for tag, pattern in entries if tag != "tag:yaml.org,2002:timestamp"]
    for start, entries in _Loader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789")
)


def _measure(
    node: yaml.Node, limits: Limits, known: dict[int, tuple[int, int]], open_nodes: set[int]
) -> tuple[int, int]:
    """Nodes and levels below a node with its aliases expanded; refuses cycles and repeated keys.

    An alias is the same object as its anchor, so each node is measured once however often it is used.
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
        first = seen.setdefault((key.tag, key.value), key)
        if first is not key:
            text = f"key {_short(key)} is given twice (first at line {first.start_mark.line + 1})"
            raise _fault("twice", text, key, str(key.value))


def _fault(problem: Problem, text: str, node: yaml.Node, key: str = "") -> YamlError:
    return YamlError(problem, text, node.start_mark.line + 1, key)


def _short(node: yaml.Node) -> str:
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else "here"
    return text if len(text) <= 40 else f"{text[:37]}..."
