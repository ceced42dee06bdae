"""The four packages depend on each other in one direction, and installations contain all their folders."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAY_IMPORT = {"tisim": set(), "factory": {"tisim"}, "calibration": {"tisim"}, "learn": set()}


def imported(file: Path) -> set[str]:
    """Top-level names of all modules that a file imports, at any level of nesting."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
    return found


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_go_one_way(package: str) -> None:
    files = list((ROOT / package).rglob("*.py"))
    assert len(files) > 20
    others = set(MAY_IMPORT) - {package}
    wrong = {f"{f.relative_to(ROOT)}: {n}" for f in files for n in imported(f) & others - MAY_IMPORT[package]}
    assert not wrong


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_every_folder_is_a_package(package: str) -> None:
    """setuptools does not install folders without an __init__.py."""
    folders = {f.parent for f in (ROOT / package).rglob("*.py")}
    assert not {str(d.relative_to(ROOT)) for d in folders if not (d / "__init__.py").exists()}
