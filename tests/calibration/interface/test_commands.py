"""Common properties of the commands: verbs, versions, fast start, names with brackets, a full disk."""

from __future__ import annotations

import errno
import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, poke_entry, write_experiment
from typer import Typer
from typer.testing import CliRunner

import calibration
from calibration.diagnose import app as diagnose
from calibration.diagnose import main
from calibration.diagnosis import SIMULATORS, kinds
from calibration.diagnosis.model import DEFAULT_SIMULATOR
from calibration.fit import app as fit
from calibration.predict import app as predict
from calibration.study._store import FitStore, locked
from calibration.table import app as table

ROOT = Path(__file__).resolve().parents[3]
VERBS = ("reconstruct", "fit", "diagnose", "predict", "table")
HEAVY = ("cma", "cv2", "matplotlib", "scipy.stats", "pyvista", "torch", "trimesh", "jinja2", "plotly")


def strip(folder: Path) -> Path:
    stretch = np.linspace(1.05, 2.0, 20)
    return write_experiment(
        folder,
        [coupon_entry("pull", "pull.csv")],
        tables={
            "pull.csv": {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)},
        },
    )


def test_the_package_lists_its_verbs() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "calibration"], capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == 0, done.stderr
    for verb in VERBS:
        assert f"python -m calibration.{verb}" in done.stdout


def test_the_simulator_is_called_by_its_name() -> None:
    """The default of the function and of the command, and the name that an unknown one is answered with."""
    options = (inspect.signature(f).parameters["simulator"].default for f in (calibration.diagnose, main))
    assert {DEFAULT_SIMULATOR, next(iter(SIMULATORS)), *options} == {"tisim"}


@pytest.mark.parametrize("verb", VERBS)
def test_a_command_starts_light_and_knows_its_version(verb: str) -> None:
    code = (
        f"import sys; from typer.testing import CliRunner; from calibration.{verb} import app\n"
        "run = CliRunner().invoke\n"
        "assert run(app, ['--help']).exit_code == 0\n"
        "said = run(app, ['--version'])\n"
        "assert said.exit_code == 0 and said.output.startswith('tisim '), said.output\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("verb", VERBS)
def test_examples_of_the_help_name_experiments_of_a_clone(verb: str) -> None:
    examples = importlib.import_module(f"calibration.{verb}").EXAMPLES
    named = re.findall(r"\S*measured/\S*", examples)
    assert named
    for name in named:
        assert (ROOT / name / "experiment.yaml").exists(), name


def test_help_names_every_domain() -> None:
    from calibration.diagnose import app

    said = " ".join(CliRunner().invoke(app, ["--help"]).output.replace("│", " ").split())
    for name in kinds():
        assert name in said


def test_brackets_in_names_are_no_markup(tmp_path: Path) -> None:
    """rich takes [/red] as the end of a style."""
    folder = strip(tmp_path / "[" / "red] lab")
    out = tmp_path / "out [" / "bold]"
    words = [str(folder), "--model", "neo-hookean", "--generations", "3", "--workers", "1", "--out", str(out)]
    done = CliRunner().invoke(fit, words)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code in (0, 1), done.output
    assert str(out / "report.html") in done.output
    assert str(out / "cards" / "S0.yaml") in done.output


def test_a_full_disk_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(tmp_path / "out"))

    monkeypatch.setattr(FitStore, "append", full)
    folder = strip(tmp_path / "lab")
    done = CliRunner().invoke(
        fit, [str(folder), "--model", "neo-hookean", "--workers", "1", "--out", str(tmp_path / "out")]
    )
    assert done.exit_code == 2, done.output
    (line,) = [text for text in done.stderr.splitlines() if text.strip()]
    assert line.startswith(f"error: no space is left on the disk at {tmp_path / 'out'}")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--seed", "-1"], "error: --seed -1: expected 0 or more"),
        (["--objective", "guess"], "error: --objective guess: expected likelihood or dice"),
        (["--model", "hooke"], "error: --model hooke: expected all or some of"),
    ],
)
def test_options_that_cannot_be_used(tmp_path: Path, words: list[str], sentence: str) -> None:
    done = CliRunner().invoke(fit, [str(strip(tmp_path / "lab")), "--out", str(tmp_path / "out"), *words])
    assert done.exit_code == 2
    assert done.stderr.startswith(sentence)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("app", "folder", "kind", "split"),
    [
        (diagnose, "indentation", "indentation", ()),
        (diagnose, "compression", "compression", ()),
        (diagnose, "bench/clean", "outlines", ()),
        (predict, "bench/clean", "outlines", ("--calibrate", "*-cantilever-*", "--predict", "*-bridge-*")),
    ],
)
def test_a_law_for_a_kind_of_measurement_that_has_one(
    tmp_path: Path, app: Typer, folder: str, kind: str, split: tuple[str, ...]
) -> None:
    words = [str(ROOT / "datasets" / "measured" / folder), *split, "--law", "ogden:2"]
    done = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "out")])
    assert done.exit_code == 2, done.output
    assert done.stderr == f"error: --law ogden: {kind} has one law only, expected auto\n"


@pytest.mark.parametrize(("app", "more"), [(fit, ()), (diagnose, ()), (predict, ("--calibrate", "pull"))])
def test_results_do_not_go_into_the_folder_of_an_experiment(
    tmp_path: Path, app: Typer, more: tuple[str, ...]
) -> None:
    lab = strip(tmp_path / "lab")
    before = sorted(lab.rglob("*"))
    done = CliRunner().invoke(app, [str(lab), *more, "--out", str(lab)])
    assert done.exit_code == 2, done.output
    assert (
        done.stderr == f"error: --out {lab}: holds an experiment: expected another folder for the results\n"
    )
    assert sorted(lab.rglob("*")) == before


def test_a_second_fit_in_one_folder_waits_outside(tmp_path: Path) -> None:
    folder, out = strip(tmp_path / "lab"), tmp_path / "out"
    with locked(out / "fits"):
        for more in ([], ["--overwrite"]):
            words = [str(folder), "--model", "neo-hookean", "--workers", "1", "--out", str(out), *more]
            done = CliRunner().invoke(fit, words)
            assert done.exit_code == 2, done.output
            assert "another calibration is at work here" in done.stderr
    assert not list((out / "fits").glob("*.json*"))


def test_a_table_of_an_indentation_says_what_it_compares(tmp_path: Path) -> None:
    time = np.linspace(0.0, 10.0, 40)
    record = {"time_s": time, "depth_mm": 0.3 * time, "force_N": 0.05 * time}
    folder = write_experiment(
        tmp_path / "lab", [poke_entry("p1", "p1.csv")], tables={"p1.csv": record}, name="block"
    )
    done = CliRunner().invoke(table, [str(folder)])
    assert done.exit_code == 2
    assert "found trials of kind poke" in done.stderr
    assert "calibration.fit" in done.stderr


_WITHOUT = """
import runpy, sys
for name in sys.argv[1].split(","):
    sys.modules[name] = None  # as if it were not installed
sys.argv = sys.argv[2:]
runpy.run_module(sys.argv[0], run_name="__main__")
"""


def _without(packages: str, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", _WITHOUT, packages, *words],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
    )


def test_photographs_without_their_extra_end_in_one_sentence(tmp_path: Path) -> None:
    done = _without(
        "cv2",
        "calibration.reconstruct",
        "datasets/measured/photographs",
        "--out",
        str(tmp_path / "traced"),
    )
    assert done.returncode == 2
    assert done.stderr.strip() == "error: the package cv2 is not installed: pip install 'tisim[photo]'"


def test_fits_and_diagnoses_of_records_need_neither_photographs_nor_bodies(tmp_path: Path) -> None:
    folder = strip(tmp_path / "data")
    options = (str(folder), "--workers", "1", "--out")
    packages = "cv2,trimesh,rtree,manifold3d,pytetwild"
    fitted = _without(packages, "calibration.fit", *options, str(tmp_path / "f"), "--model", "neo-hookean")
    assert fitted.returncode == 0, fitted.stderr
    diagnosed = _without(packages, "calibration.diagnose", *options, str(tmp_path / "d"))
    assert diagnosed.returncode == 0, diagnosed.stderr
