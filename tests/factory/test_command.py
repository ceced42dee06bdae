"""The build command from a user's point of view."""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import factory
import factory.build
import tisim
from factory.__main__ import app as factory_app
from factory.build import default_target
from factory.building import build as building
from factory.building.build import Built, build_dataset
from factory.building.report import Screen, estimate, preview_path, traces_of
from factory.cli import make_console
from factory.inspection.figures import draw_preview, preview_of
from factory.plan import Plan
from factory.reader import open_dataset
from factory.store.files import manifest_digest
from tests.factory.conftest import ROOT, TINY, digest, environment, run_app

run = CliRunner().invoke


@pytest.fixture(autouse=True)
def _standin(monkeypatch: pytest.MonkeyPatch, serial: None) -> None:
    del serial
    stand_in = functools.partial(build_dataset, simulator="tests.factory.standin:simulate")
    monkeypatch.setattr(building, "build_dataset", stand_in)


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


QUICK = ("--model", "ogden", "--recipe", "quick")  # planned in a fiftieth of the time of `paper`
COMMANDS = ("factory", *(f"factory.{verb}" for verb in ("build", "inspect", "verify", "card", "release")))
HEAVY = (
    "taichi",
    "matplotlib",
    "pyvista",
    "vtk",
    "dask",
    "distributed",
    "zarr",
    "trimesh",
    "cv2",
    "torch",
    "cma",
)


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("option", ["--help", "--version"])
def test_help_and_version_wait_for_nothing_heavy(command: str, option: str) -> None:
    code = (
        "import runpy, sys\n"
        f"sys.argv = [{command!r}, {option!r}]\n"
        "try:\n"
        f"    runpy.run_module({command!r}, run_name='__main__', alter_sys=True)\n"
        "except SystemExit as end:\n"
        "    assert not end.code, end.code\n"
        "print()\n"
        f"print(*[name for name in {HEAVY!r} if name in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment(), check=False
    )
    assert done.returncode == 0, done.stderr
    *text, last = done.stdout.splitlines()
    assert not last, f"imported for {option}: {last}"
    if option == "--version":
        assert text[0].startswith("tisim ")
    else:
        assert f"python -m {command}" in "\n".join(text)


def test_the_package_lists_its_commands() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "factory"], capture_output=True, text=True, env=environment(), check=False
    )
    assert done.returncode == 0, done.stderr
    for verb in ("build", "inspect", "verify", "card", "release"):
        assert verb in done.stdout


def test_one_program_with_verbs(tmp_path: Path) -> None:
    result = run(
        factory_app,
        ["build", "--model", "ogden", "--recipe", "quick", "--dry-run", "--out", str(tmp_path / "a.zarr")],
    )
    assert result.exit_code == 0, result.output
    assert "12 = 2 shapes x 3 material levels x 2" in result.output
    result = run(factory_app, ["inspect", str(tmp_path / "nothing.zarr")])
    assert result.exit_code == 2
    assert result.stderr == f"error: {tmp_path / 'nothing.zarr'}: no such dataset\n"


def test_every_public_name_is_there() -> None:
    for name in factory.__all__:
        assert getattr(factory, name).__doc__, name
    assert repr(factory.make_plan(factory.load_recipe("quick"), "ogden")) == (
        "Plan(quick, ogden: 12 pokes = 2 shapes x 3 material levels x 2)"
    )
    with pytest.raises(AttributeError, match="biuld"):
        _ = factory.biuld


def test_the_model_option_lists_all_laws() -> None:
    _, output, _ = _call("--help")
    words = " ".join(output.split())
    for name in tisim.laws.all_names():
        assert name[:10] in words


@pytest.mark.parametrize(
    ("materials", "name"),
    [
        (None, "quick-ogden.zarr"),
        ("fitted/cards", "quick-ogden-fitted.zarr"),
        ("my out/cards", "quick-ogden-my-out.zarr"),
        ("lab materials/", "quick-ogden-lab-materials.zarr"),
        ("/cards", "quick-ogden-materials.zarr"),
    ],
)
def test_the_name_of_the_store_follows_the_materials(materials: str | None, name: str) -> None:
    assert default_target("quick", "ogden", Path(materials) if materials else None) == Path("datasets") / name


@pytest.mark.usefixtures("unrendered")
def test_the_readmes_commands_follow_each_other(
    tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A dataset of the shipped cards, then one of fitted cards with the same recipe and law."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "datasets" / "materials", tmp_path / "fitted" / "cards")
    card = tmp_path / "fitted" / "cards" / "S0.yaml"
    card.write_text(card.read_text().replace("density: 1000.0", "density: 1075.0"))
    first = ("--model", "ogden", "--recipe", str(tiny_file))
    assert _call(*first)[0] == 0
    assert _call(*first, "--materials", "fitted/cards")[0] == 0
    assert {path.name for path in Path("datasets").iterdir()} == {
        f"tiny-ogden{end}" for end in (".zarr", ".png", "-fitted.zarr", "-fitted.png")
    }
    code, _, errors = _call(*first, "--materials", "fitted/cards", "--out", "datasets/tiny-ogden.zarr")
    assert code == 2
    assert f"give another --out, --out {tmp_path / 'datasets' / 'tiny-ogden-2.zarr'} for example" in errors


@pytest.mark.usefixtures("unrendered")
def test_materials_of_ones_own(tiny_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "my out" / "cards"
    folder.mkdir(parents=True)
    text = (ROOT / "datasets" / "materials" / "S1.yaml").read_text()
    (folder / "Eco.yaml").write_text(text.replace("material: S1", "material: Eco"))
    arguments = ("--model", "neo-hookean", "--recipe", str(tiny_file), "--materials", "my out/cards")
    code, output, errors = _call(*arguments)
    assert code == 0, errors
    assert "my out/cards has no card of the recipe's material levels (S0, S1): its own cards are" in errors
    assert "2 of 2 pokes (2 simulated now)" in output
    data = factory.open_dataset("datasets/tiny-neo-hookean-my-out.zarr")
    assert data.levels == ["Eco"]
    assert data.poke(1).level == "Eco"
    assert _call(*arguments, "--levels", "Eco")[0] == 0


@pytest.mark.usefixtures("unrendered")
def test_a_law_that_the_cards_lack_has_their_moduli(tiny_file: Path, tmp_path: Path) -> None:
    arguments = ("--model", "yeoh", "--recipe", str(tiny_file), "--out", str(tmp_path / "a.zarr"))
    _, output, _ = _call(*arguments, "--dry-run")
    assert "(from the card's small-strain moduli: it has no parameters of this law)" in " ".join(
        output.split()
    )
    code, output, _ = _call(*arguments)
    assert code == 0
    assert "material S0: its card has no parameters of yeoh: small-strain moduli." in output


def test_dry_run_of_a_complete_dataset_has_nothing_to_do(store: Path, tiny_file: Path) -> None:
    arguments = ("--model", "ogden", "--recipe", str(tiny_file), "--out", str(store), "--dry-run")
    for more, left in (((), "0"), (("--overwrite",), "4")):
        code, output, _ = _call(*arguments, *more)
        assert code == 0
        (line,) = (line for line in output.splitlines() if "to do" in line)
        assert line.split("│")[2].split()[0].rstrip(",") == left


def test_dry_run_refuses_what_the_build_would(stopped: Path, tiny_file: Path) -> None:
    tiny_file.write_text(tiny_file.read_text().replace("seed: 3", "seed: 4"))
    arguments = ("--model", "ogden", "--recipe", tiny_file, "--out", stopped)
    before = sorted(stopped.parent.rglob("*"))
    for flags in ((), ("--dry-run",)):
        done = run_app(factory.build.app, *arguments, *flags)
        assert done.exit_code == 2
        assert "was begun with another plan (changed: recipe.seed" in done.output
    assert sorted(stopped.parent.rglob("*")) == before
    assert run_app(factory.build.app, *arguments, "--dry-run", "--overwrite").exit_code == 0


def test_the_preview_replaces_no_other_picture(
    tmp_path: Path, plan: Plan, caplog: pytest.LogCaptureFixture
) -> None:
    assert preview_path(tmp_path / "gel-0.5").name == "gel-0.5.png"
    assert preview_path(tmp_path / "gel-0.5.zarr").name == "gel-0.5.png"
    own = tmp_path / "a.png"
    Image.new("L", (2, 2)).save(own)
    kept = own.read_bytes()
    screen = Screen(plan, tmp_path / "a.zarr", make_console(), estimate(plan, tmp_path / "a.zarr", 1))
    screen.finish(Built(tmp_path / "a.zarr", 4, 0))
    screen._draw()
    assert own.read_bytes() == kept
    assert "a.png is another picture, which stays" in caplog.text
    own.unlink()
    for _ in range(2):  # the second time it replaces its own
        screen._draw()
        assert own.stat().st_size > 5_000
        os.utime(own, (0, 0))


def test_dry_run_prints_the_plan_and_writes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code, output, _ = _call("--model", "mooney-rivlin", "--dry-run", "--workers", "2")
    assert code == 0
    for text in (
        str(tmp_path / "datasets" / "paper-mooney-rivlin.zarr"),
        "1320 = 11 shapes x 3 material levels x 40 (20 shared contact points, 20 own)",
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
    assert preview_of(tmp_path / "new" / "a.png") == manifest_digest(target)
    code, output, _ = _call(*arguments, "--overwrite")
    assert "4 simulated now" in output
    assert digest(target) == before
    assert sorted(path.name for path in target.parent.iterdir()) == ["a.png", "a.zarr"]


def test_the_preview_of_an_earlier_store_is_drawn_again(
    plan: Plan, finished_store: Path, tiny_file: Path, tmp_path: Path
) -> None:
    """A build that is killed between the swap of the store and its last picture leaves the earlier one."""
    target, picture = tmp_path / "a.zarr", tmp_path / "a.png"
    shutil.copytree(finished_store, target)
    arguments = ("--model", "ogden", "--recipe", tiny_file, "--out", target)
    draw_preview(plan, {}, picture)  # on the way
    drawn = []
    for old in (picture.read_bytes(), None):
        if old is None:
            picture.unlink()
        done = run_app(factory.build.app, *arguments)
        assert done.exit_code == 0
        assert "nothing was left to simulate" in done.output
        assert preview_of(picture) == manifest_digest(target) != ""
        drawn.append(picture.read_bytes())
        assert drawn[-1] != old
    os.utime(picture, (0, 0))
    assert run_app(factory.build.app, *arguments).exit_code == 0
    assert picture.stat().st_mtime == 0  # it is of the store
    assert drawn[0] == drawn[1]
    data = open_dataset(target)
    traces = traces_of(data)
    deepest = max(traces, key=lambda i: (data.poke(i).depth.max(), -i))
    for index, trace in traces.items():
        poke = data.poke(index)
        np.testing.assert_array_equal(trace.depth, poke.depth)
        assert (trace.grid is None) == (index != deepest)
        if trace.grid is not None:
            moved = poke.grid[int(poke.depth.argmax())] - data.grid_rest(0)
            np.testing.assert_allclose(trace.grid, moved, atol=1e-9)


@pytest.mark.usefixtures("unrendered")
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
            "/nowhere: expected a folder of material cards",
        ),
        ((*QUICK, "--out", __file__), "is not a dataset of the factory"),
        ((*QUICK, "--out", f"{__file__}/a.zarr"), "Not a directory"),
        ((*QUICK, "--dry-run", "--out", __file__), "is not a dataset of the factory"),
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
