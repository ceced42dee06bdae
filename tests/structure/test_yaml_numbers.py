"""learn imports no other package, so that it reads YAML's numbers by its own rule: the same one."""

from __future__ import annotations

from typing import Any

from learn import _yaml
from tisim.io import bounded_yaml


def _numbers(loader: Any) -> dict[str, list[tuple[str, str]]]:
    kinds = ("timestamp", "int", "float")
    return {
        start: [(tag, rule.pattern) for tag, rule in entries if tag.endswith(kinds)]
        for start, entries in loader.yaml_implicit_resolvers.items()
    }


def test_numbers_are_read_by_one_rule() -> None:
    found = _numbers(_yaml._Loader)
    assert found == _numbers(bounded_yaml._Loader)
    assert any(found.values())
