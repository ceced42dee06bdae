"""Packages and files depend on each other in one direction, and installations contain all folders."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAY_IMPORT = {"tisim": set(), "factory": {"tisim"}, "calibration": {"tisim"}, "learn": set()}


Import = ast.Import | ast.ImportFrom


@cache
def imports(file: Path) -> tuple[tuple[Import, bool], ...]:
    """Imports of a file at any level of nesting, and True for those that are made when it is imported.

    Those under TYPE_CHECKING count as made; those inside functions do not.
    """
    return tuple(_imports(ast.parse(text_of(file)).body, outside=True))


def _imports(nodes: Sequence[ast.AST], *, outside: bool) -> Iterator[tuple[Import, bool]]:
    for node in nodes:
        if isinstance(node, Import):
            yield node, outside
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):  # statements, no expressions
            below = getattr(node, name, ())
            if isinstance(below, list):
                yield from _imports(below, outside=outside and not isinstance(node, ast.FunctionDef))


@cache
def text_of(file: Path) -> str:
    return file.read_text(encoding="utf-8")


def imported(file: Path) -> set[str]:
    """Top-level names of all modules that a file imports, at any level of nesting."""
    found: set[str] = set()
    for node, _ in imports(file):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif node.module and not node.level:
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
def test_files_import_each_other_one_way(package: str) -> None:
    """No circle of imports, not even for types; the faces of packages and imports in functions are free."""
    files = [f for f in (ROOT / package).rglob("*.py") if f.name != "__init__.py"]
    TopologicalSorter({f: needed(f) for f in files}).prepare()  # CycleError names the files


def test_folders_of_the_factory_import_each_other_one_way() -> None:
    """Nor in functions: a folder is a layer. Modules beside the folders are layers of their own."""
    found: dict[str, set[str]] = {}
    for file in (ROOT / "factory").rglob("*.py"):
        layer = file.relative_to(ROOT / "factory").parts[0].removesuffix(".py")
        modules = [n.module for n, _ in imports(file) if isinstance(n, ast.ImportFrom) and n.module]
        others = {m.split(".")[1] for m in modules if m.startswith("factory.")}
        found.setdefault(layer, set()).update(others - {layer})
    assert len(found) > 15
    TopologicalSorter(found).prepare()  # CycleError names the layers


def needed(file: Path) -> set[Path]:
    """Files whose import a file begins with."""
    found: set[Path] = set()
    for node, outside in imports(file):
        if outside and isinstance(node, ast.ImportFrom) and node.module:
            path = ROOT.joinpath(*node.module.split("."))
            found |= {path.with_suffix(".py"), *(path / f"{a.name}.py" for a in node.names)}
        elif outside and isinstance(node, ast.Import):
            found |= {ROOT.joinpath(*a.name.split(".")).with_suffix(".py") for a in node.names}
    return {f for f in found if f.is_file()}


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
        for node, _ in imports(file):
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
    text = text_of(file) + (text_of(stub) if stub.is_file() else "")
    return all(
        re.search(rf"\b{a.name}\b", text) or (path / a.name).is_dir() or (path / f"{a.name}.py").is_file()
        for a in names
    )
