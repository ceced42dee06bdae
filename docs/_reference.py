"""Pages of the reference that are read off the code: each command's --help, each package's public names."""

from __future__ import annotations

import importlib
import inspect
import re
import tomllib
import types
from pathlib import Path
from typing import Any

import typer
from sphinx.application import Sphinx
from typer.testing import CliRunner

ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "docs" / "reference"
# Public modules, by package: what a user imports, and where parts of one's own are registered.
MODULES = {
    "tisim": (
        "tisim",
        "tisim.laws",
        "tisim.parts",
        "tisim.inclusions",
        "tisim.mesh",
        "tisim.problems",
        "tisim.view",
    ),
    "factory": ("factory",),
    "calibration": (
        "calibration",
        "calibration.parameters",
        "calibration.metrics",
        "calibration.diagnosis.catalogue",
        "calibration.lab_files",
        "calibration.export",
        "calibration.fetch",
    ),
    "learn": ("learn", "learn.data", "learn.models", "learn.metrics", "learn.training", "learn.evaluation"),
}
HELP_COLUMNS = "100"
_SENTENCE = re.compile(r" +[A-Z]")
_ENTRY = re.compile(r"(\w[\w, *]*) : (.+)")


def write_all(app: Sphinx) -> None:
    """Called before Sphinx looks for pages."""
    del app
    _write_new(REFERENCE / "commands-help.md", commands_page())
    for package, modules in MODULES.items():
        _write_new(REFERENCE / "python" / f"{package}.rst", python_page(package, modules))


def commands_page() -> str:
    """`--help` of every command, as a terminal of HELP_COLUMNS columns shows it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [
        "# Help of every command",
        "",
        "As `--help` shows it. What the commands share: [commands](commands.md).",
        "",
    ]
    for verb, entry in project["entry-points"]["tisim.verbs"].items():
        module, _, name = entry.partition(":")
        application: typer.Typer = getattr(importlib.import_module(module), name)
        plain = {"COLUMNS": HELP_COLUMNS, "TERMINAL_WIDTH": HELP_COLUMNS, "NO_COLOR": "1", "TERM": "dumb"}
        runs_as = f"python -m {module.removesuffix('.command')}"
        shown = CliRunner().invoke(application, ["--help"], env=plain, prog_name=runs_as)
        if shown.exit_code:
            raise RuntimeError(f"{runs_as} --help ended with {shown.exit_code}: {shown.output}")
        text = "\n".join(line.rstrip() for line in shown.output.strip("\n").splitlines())
        lines += [f"## tisim {verb}", "", "```text", text, "```", ""]
    return "\n".join(lines)


def python_page(package: str, modules: tuple[str, ...]) -> str:
    """The docstrings of a package's public modules and of what they export, in reStructuredText."""
    lines = [package, "=" * len(package), ""]
    seen: set[int] = set()
    for name in modules:
        module = importlib.import_module(name)
        if name != package:
            lines += [name, "-" * len(name), ""]
        lines += [f".. automodule:: {name}", "   :no-members:", "   :no-index:", ""]
        for member in getattr(module, "__all__", ()):
            value = getattr(module, member)
            directive = _directive(value)
            if directive is not None and id(value) not in seen:
                seen.add(id(value))
                lines += [f".. {directive}:: {name}.{member}", ""]
    return "\n".join(lines)


def _directive(value: object) -> str | None:
    if inspect.isclass(value) and not isinstance(value, types.GenericAlias):
        return "autoclass"
    return "autofunction" if inspect.isroutine(value) else None


def describe_after_colon(*event: Any) -> None:
    """Docstrings of this project say `name : what it is`; NumPy's style expects a type there."""
    lines: list[str] = event[-1]
    found: list[str] = []
    inside = False
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if below and set(below) == {"-"}:
            inside = line in ("Parameters", "Attributes")
        entry = _ENTRY.fullmatch(line) if inside else None
        # `name : type` with a sentence below stays as it is
        typed = entry is not None and len(entry[2].split()) < 5 and _SENTENCE.match(below) is not None
        found += [line] if entry is None or typed else [entry[1], f"    {entry[2]}"]
    lines[:] = found


def _write_new(path: Path, text: str) -> None:
    """Only what has changed, so that the next build reads no page in vain."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_all)
    app.connect("autodoc-process-docstring", describe_after_colon, priority=100)  # before napoleon's 500
    return {"parallel_read_safe": True}
