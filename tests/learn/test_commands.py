"""The commands as programs: fast help without torch, versions, tables that fit a terminal, plugins."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch
from rich.console import Console

import learn
import learn.bench
import learn.evaluate
import learn.export
import learn.predict
import learn.train
from learn._options import set_threads
from learn._terminal import print_table
from learn.metrics import METRICS
from learn.models import MODELS
from learn.training import RECIPES, load_run
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import write_store

ROOT = Path(__file__).parents[2]
COMMANDS = ("train", "evaluate", "predict", "export", "bench")
PLUGIN = Path(__file__).parent / "plugin.py"
POKE = "site_mm: [5, -10]\ndepth_mm: 2\nshape: shape-1\nsoftness: S1\n"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(tmp_path_factory.mktemp("commands") / "s.zarr", sites=2, frames=2)


def _python(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=environment, cwd=ROOT, capture_output=True, text=True, timeout=600,
    )  # fmt: skip


WITHOUT = """
import runpy, sys
for name in sys.argv[2].split(","):
    sys.modules[name] = None  # as if it were not installed
sys.argv = sys.argv[:1] + sys.argv[3:]
module = sys.argv.pop(1)
runpy.run_module(module, run_name="__main__", alter_sys=False)
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_help_needs_nothing_heavy(command: str) -> None:
    heavy = "torch,zarr,scipy,matplotlib,pydantic,yaml,onnx,fsspec,numpy"
    done = _python(WITHOUT, "-", heavy, f"learn.{command}", "--help")
    assert done.returncode == 0, done.stderr
    assert "--version" in done.stdout


def test_what_draws_nothing_loads_no_drawing_library() -> None:
    """A second of each start: matplotlib, and scipy.stats for the rotations of `learn.evaluate`."""
    code = (
        "import sys, learn\n"
        "touch = learn.load('covers').real_time({'inclusion': {'kind': 'none'}, 'shear_modulus_kPa': 9})\n"
        "touch(site=(0, 0), direction=(0, 0, -1), depth=1e-3)\n"
        "from learn.evaluation.predictions import _motions\n"
        "assert len(_motions(2, about_normal=False)) == 2\n"
        "print(sorted({'matplotlib', 'scipy.stats', 'jinja2', 'onnx'} & set(sys.modules)))\n"
    )
    done = _python(code)
    assert (done.returncode, done.stdout) == (0, "[]\n"), done.stderr


@pytest.mark.parametrize("command", COMMANDS)
def test_without_torch_each_command_says_what_to_install(command: str) -> None:
    arguments = {"predict": ["run", "poke.yaml"]}.get(command, ["run"])
    done = _python(WITHOUT, "-", "torch", f"learn.{command}", *arguments)
    assert done.returncode == 2
    first = done.stderr.splitlines()[0]
    assert first == "error: the package torch is not installed: pip install 'tisim[learn]'"
    assert "Traceback" not in done.stderr


def test_the_package_lists_its_commands() -> None:
    done = _python(WITHOUT, "-", "torch", "learn", "--help")
    assert done.returncode == 0
    assert [name for name in COMMANDS if name not in done.stdout] == []
    import learn.cli

    assert call(learn.cli.app, "--version").output == f"tisim {learn.__version__}\n"
    for command in COMMANDS:
        shown = call(getattr(learn, command).app, "--version")
        assert (shown.exit_code, shown.output) == (0, f"tisim {learn.__version__}\n")


def test_help_names_what_there_is() -> None:
    """The help lists the names literally, since the registries need torch."""
    shown = " ".join(call(learn.train.app, "--help").output.replace("│", " ").split())
    assert [name for name in (*RECIPES, *MODELS) if name not in shown and name != "decay"] == []


@pytest.mark.parametrize("width", [60, 80, 110, 170])
@pytest.mark.parametrize("models", [1, 5, 9])
def test_tables_fit_the_terminal(width: int, models: int, capsys: pytest.CaptureFixture[str]) -> None:
    """No cell is truncated: every number and every word of a heading is complete."""
    heads = ["model", *(metric.heading for metric in METRICS.values())]
    rows = [[f"model-number-{k}", *(f"{k}.{j:04d}" for j in range(1, len(heads)))] for k in range(models)]
    print_table(Console(width=width, file=sys.stdout), "Title", heads, rows)
    shown = capsys.readouterr().out
    assert max(len(line) for line in shown.splitlines()) <= width
    words = [cell for row in rows for cell in row] + [word for head in heads for word in head.split()]
    assert [word for word in words if word not in shown] == []
    assert "…" not in shown


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_a_plugin_brings_a_metric_and_a_model(store: Path, tmp_path: Path) -> None:
    """Train, evaluate and predict with a metric and a model from a file outside the package."""
    flags = ("--plugin", PLUGIN)
    run = train_small(store, tmp_path / "run", "--model", "decay", *flags)
    assert load_run(run).recipe.model == "decay"
    done = call(learn.evaluate.app, run, "--no-clouds", "--no-baselines", "--threads", 1, *flags)
    assert done.exit_code == 0, done.output
    tables = json.loads((run / "evaluation" / "tables.json").read_text())
    assert 0 < tables["tables"]["decay"]["all"]["median"]["mean"] < 1
    assert "median over all points" in (run / "evaluation" / "report.html").read_text()
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    done = call(learn.predict.app, run, scene, "--out", tmp_path / "out", *flags)
    assert done.exit_code == 0, done.output
    refused(call(learn.export.app, run, *flags), "model decay has no ONNX export")
    scene.write_text(POKE.replace("softness: S1", "shear_modulus_kPa: 18"))
    own = call(learn.predict.app, run, scene, "--out", tmp_path / "own", *flags)
    refused(own, "model decay knows the dataset's shapes and softness levels alone")


def test_without_its_plugin_a_run_is_refused(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = train_small(store, tmp_path / "run", "--model", "decay", "--plugin", PLUGIN)
    monkeypatch.delitem(MODELS, "decay")
    refused(call(learn.evaluate.app, run), "key model: expected one of", "--plugin FILE registers others")
    bad = tmp_path / "bad.py"
    bad.write_text("1 / 0\n")
    refused(call(learn.evaluate.app, run, "--plugin", bad), "bad.py: ZeroDivisionError: division by zero")
    refused(call(learn.evaluate.app, run, "--plugin", tmp_path / "no.py"), "no.py: expected a Python file")


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_too_few_pokes_for_intervals_is_said(tmp_path: Path) -> None:
    """With one validation poke the terminal and the report state why there is no table."""
    store = write_store(tmp_path / "s.zarr", shapes=3, softness=("S0",), sites=1, frames=2)
    run = train_small(store, tmp_path / "run", "--epochs", 1, "--model", "invariant-gnn-small")
    done = call(learn.evaluate.app, run, "--no-clouds", "--no-baselines", "--threads", 1)
    assert done.exit_code == 0, done.output
    reason = "intervals need at least two validation pokes, there is 1"
    assert reason in " ".join(done.output.split())
    html = (run / "evaluation" / "report.html").read_text()
    assert "<h2>Intervals</h2>" in html
    assert reason in html
    assert "1 test poke cannot show how the model performs on others" in html
    assert sorted(p.stem for p in (run / "evaluation").glob("*.png")) == ["force", "learning", "only"]


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_names_with_brackets_are_no_markup(store: Path, tmp_path: Path) -> None:
    folder = tmp_path / "[bold]run[/x]"
    run = train_small(store, folder, "--model", "invariant-gnn-small", "--epochs", 1)
    scene = tmp_path / "poke[red].yaml"
    scene.write_text(POKE)
    done = call(learn.predict.app, run, scene, "--out", tmp_path / "out[/]")
    assert done.exit_code == 0, done.output
    assert str(tmp_path / "out[/]") in done.output
    done = call(learn.evaluate.app, run, "--no-clouds", "--no-baselines", "--threads", 1)
    assert done.exit_code == 0, done.output
    assert str(folder) in done.output
    refused(call(learn.evaluate.app, tmp_path / "[/no]"), str(tmp_path / "[/no]"))


def test_threads_are_those_that_the_process_was_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """torchrun sets OMP_NUM_THREADS for each of its processes, a batch system the cores."""
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2}, raising=False)
    try:
        torch.set_num_threads(1)
        set_threads(None)
        assert torch.get_num_threads() == 1
        set_threads(2)
        assert torch.get_num_threads() == 2
        monkeypatch.delenv("OMP_NUM_THREADS")
        set_threads(None)
        assert torch.get_num_threads() == 3
    finally:
        torch.set_num_threads(1)


def test_bad_devices_are_refused(store: Path, tmp_path: Path) -> None:
    for device, words in (("banana", "expected auto, cpu or cuda"), ("cuda", "torch sees no GPU here")):
        if device == "cuda" and torch.cuda.is_available():
            continue
        refused(call(learn.train.app, store, "--device", device, "--out", tmp_path / "run"), words)
