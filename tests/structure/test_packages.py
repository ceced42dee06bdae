"""The four packages depend on each other in one direction, and installations contain all their folders."""

from __future__ import annotations

import ast
import re
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


@pytest.mark.parametrize("folder", ["benchmarks", "studies", "datasets", "docs", "tests"])
def test_scripts_import_modules_that_exist(folder: str) -> None:
    """Scripts that no test runs follow a module that moves."""
    ours = {*MAY_IMPORT, "benchmarks", "studies"}
    wrong = []
    for file in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.ImportFrom) or not node.module or node.level:
                continue
            if node.module.partition(".")[0] in ours and not _defines(node.module, node.names):
                wrong.append(f"{file.relative_to(ROOT)}:{node.lineno}: {node.module}")
    assert not wrong


def _defines(module: str, names: list[ast.alias]) -> bool:
    """True if a module of the repository exists and contains the names, as text or as modules of its own."""
    path = ROOT.joinpath(*module.split("."))
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    if not file.is_file():
        return path.is_dir() and all((path / f"{a.name}.py").is_file() for a in names)
    stub = file.with_suffix(".pyi")  # of a package that imports its names when they are used
    text = file.read_text(encoding="utf-8") + (stub.read_text(encoding="utf-8") if stub.is_file() else "")
    return all(
        re.search(rf"\b{a.name}\b", text) or (path / a.name).is_dir() or (path / f"{a.name}.py").is_file()
        for a in names
    )
