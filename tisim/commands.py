"""`tisim VERB`: one entry to the commands of all installed packages.

A verb is an entry point of the group `tisim.verbs`, whose value is a typer application of one command; any
distribution may add verbs. The help of a verb is the first line of its module's docstring, after the colon.
Verbs are imported only when they are run, so that help is printed without delay.
"""

from __future__ import annotations

import ast
from difflib import get_close_matches
from functools import cached_property
from importlib.machinery import PathFinder
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from tisim.options import Version

GROUP = "tisim.verbs"


def verbs() -> dict[str, EntryPoint]:
    """Entry points by verb, ordered by package and name."""
    found = sorted(entry_points(group=GROUP), key=lambda e: (e.module.partition(".")[0], e.name))
    return {entry.name: entry for entry in found}


def purpose(module: str) -> str:
    """First line of a module's docstring, read without importing it; empty if it has none."""
    first = _docstring(module).partition("\n")[0]
    return (first.partition("`: ")[2] or first).rstrip(".")


def _docstring(module: str) -> str:
    package, *parts = module.split(".")
    spec, name = find_spec(package), package
    for part in parts:
        name = f"{name}.{part}"
        spec = spec and PathFinder.find_spec(name, spec.submodule_search_locations)
    if spec is None or spec.origin is None:
        return ""
    return ast.get_docstring(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))) or ""


class _Verb(TyperCommand):
    """A verb with its name and purpose; its command is imported when it is run or completed."""

    def __init__(self, entry: EntryPoint) -> None:
        super().__init__(
            name=entry.name,
            help=purpose(entry.module),
            rich_help_panel=purpose(entry.module.partition(".")[0]).partition(":")[0],
            callback=None,
        )
        self._entry = entry

    @cached_property
    def _command(self) -> Any:
        return typer.main.get_command(self._entry.load())

    def make_context(self, info_name: str | None, args: list[str], *rest: Any, **options: Any) -> Any:
        return self._command.make_context(info_name, args, *rest, **options)


class _Verbs(TyperGroup):
    """Group of the verbs, in the order of their packages."""

    @cached_property
    def _known(self) -> dict[str, EntryPoint]:
        return verbs()

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002
        return list(self._known)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002
        entry = self._known.get(cmd_name)
        return None if entry is None else _Verb(entry)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        if args[0] not in self._known and not ctx.resilient_parsing:
            near = get_close_matches(args[0], self._known, n=1)
            hint = f"did you mean {near[0]}?" if near else "tisim --help shows all"
            typer.echo(f"error: tisim has no verb {args[0][:60]!r}: {hint}", err=True)
            raise typer.Exit(2)
        return super().resolve_command(ctx, args)


app = typer.Typer(cls=_Verbs, rich_markup_mode="rich", pretty_exceptions_enable=False, no_args_is_help=True)


@app.callback()
def door(version: Version = False) -> None:
    """Soft tissue: from measurements to a calibrated simulator, a dataset and a surrogate. Each verb is also
    `python -m PACKAGE.VERB`, and answers --help."""
    del version


def main() -> None:
    """The console script."""
    app(prog_name="tisim")
