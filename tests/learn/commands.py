"""Helpers shared by the tests of the commands."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner, Result

import learn.train

RECIPE = (
    "name: small\nmodel: invariant-gnn-small\nepochs: 3\nbatch: 8\nema_decay: 0.9\ntrain_depth_mm: 2.5\n"
    "near_weight: 20\nnear_width_mm: 6\ndepth_power: 0\n"
)


def call(app: object, *arguments: object) -> Result:
    """Run a command in this process."""
    return CliRunner().invoke(app, [str(a) for a in arguments])  # type: ignore[arg-type]


def train_small(store: Path, folder: Path, *flags: object, recipe: str = RECIPE) -> Path:
    """Train a small run, in a few seconds; return its folder."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    file = folder.parent / "r.yaml"
    file.write_text(recipe)
    done = call(learn.train.app, store, "--recipe", file, "--out", folder, "--threads", 1, *flags)
    assert done.exit_code == 0, done.output
    return folder


def refused(result: Result, *words: str) -> str:
    """Assert exit code 2 and one line on stderr that contains these words; return stderr."""
    assert result.exit_code == 2, (result.output, result.exception)
    assert result.stderr.count("\n") == 1, result.stderr
    assert "Traceback" not in result.stderr
    for word in words:
        assert word in result.stderr, result.stderr
    return str(result.stderr)
