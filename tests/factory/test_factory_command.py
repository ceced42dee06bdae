"""The build command as its users meet it."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest
from conftest import TINY, digest
from typer.testing import CliRunner

import factory.build
from factory._build import build
from factory.plan import Plan

run = CliRunner().invoke


@pytest.fixture(autouse=True)
def _standin(monkeypatch: pytest.MonkeyPatch, serial: None) -> None:
    del serial
    monkeypatch.setattr(factory.build, "build", functools.partial(build, simulator="standin:simulate"))


def _call(*arguments: str) -> tuple[int, str, str]:
    result = run(factory.build.app, list(arguments))
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.stdout, result.stderr


def test_help_has_examples() -> None:
    code, output, _ = _call("--help")
    assert code == 0
    for text in ("Examples", "--recipe quick", "--overwrite", "--workers", "--dry-run", "--cluster", "--out"):
        assert text in output


def test_dry_run_prints_the_plan_and_writes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code, output, _ = _call("--model", "mooney-rivlin", "--dry-run", "--workers", "2")
    assert code == 0
    for text in (
        str(tmp_path / "datasets" / "paper-mooney-rivlin.zarr"),
        "1320 = 11 shapes x 3 softness x 40 (20 shared sites, 20 own)",
        "nodes",
        "expected time",
        "2 workers",
        "expected size",
        "MB",
        "c10 = ",
    ):
        assert text in output
    assert not list(tmp_path.iterdir())


def test_build_picture_and_second_call(tiny_file: Path, tmp_path: Path) -> None:
    target = tmp_path / "new" / "a.zarr"
    arguments = ("--model", "ogden", "--recipe", str(tiny_file), "--out", str(target), "--workers", "1")
    code, output, _ = _call(*arguments)
    assert code == 0
    assert "4 of 4 pokes (4 simulated now)" in output
    assert (tmp_path / "new" / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    before = digest(target)
    code, output, _ = _call(*arguments)
    assert code == 0
    assert "nothing was left to simulate" in output
    assert digest(target) == before
    code, output, _ = _call(*arguments, "--overwrite")
    assert "4 simulated now" in output
    assert digest(target) == before
    assert sorted(path.name for path in target.parent.iterdir()) == ["a.png", "a.zarr"]


def test_failed_pokes_are_said(
    tiny_file: Path, tmp_path: Path, plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    target = tmp_path / "a.zarr"
    code, output, _ = _call("--model", "ogden", "--recipe", str(tiny_file), "--out", str(target))
    assert code == 1
    assert "1 of 4 pokes failed (first: poke 1: RuntimeError: the stand-in was told to fail)" in output


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--model", "jello"), "--model jello: expected one of st-venant-kirchhoff, "),
        (
            ("--model", "ogden", "--recipe", "papper"),
            "--recipe papper: expected a path of a YAML file or one",
        ),
        (
            ("--model", "ogden", "--materials", "/nowhere"),
            "/nowhere/S0.yaml: no material card for",
        ),
        (("--model", "ogden", "--out", __file__), "is not a dataset of the factory"),
        (("--model", "ogden", "--out", f"{__file__}/a.zarr"), "Not a directory"),
        (("--model", "ogden", "--dry-run", "--out", __file__), "is not a dataset of the factory"),
    ],
)
def test_bad_input_is_one_sentence(arguments: tuple[str, ...], words: str) -> None:
    code, _, errors = _call(*arguments)
    assert code == 2
    assert words in errors
    assert errors.startswith("error: ")
    assert errors.count("\n") == 1


def test_a_bad_recipe_is_named(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(TINY.replace("seed: 3", "seed: three"))
    code, _, errors = _call("--model", "ogden", "--recipe", str(path))
    assert code == 2
    assert errors == f"error: {path}: key seed: input should be a valid integer, got 'three'\n"
