"""Targets and plans that are refused in one sentence, without loss of data."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from factory.building import report
from factory.building.build import BuildProgress, build_dataset
from factory.cli import make_console
from factory.errors import InputError
from factory.inspect import app as inspect_app
from factory.inspection.summary import summarise
from factory.plan import Plan, make_plan
from factory.recipe import load_recipe
from factory.store.staging import Staging, building_folder
from tests.factory.conftest import TINY, Builder, digest, run_app


@pytest.fixture
def other(tmp_path: Path) -> Plan:
    path = tmp_path / "other.yaml"
    path.write_text(TINY.replace("depth_mm: 30", "depth_mm: 20"))
    return make_plan(load_recipe(str(path)), "ogden")


def test_a_changed_recipe_is_refused_on_the_way(
    plan: Plan, other: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.zarr"
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    standin_build(plan, target)  # one poke fails, so the staged results stay
    before = digest(target), digest(building_folder(target))
    with pytest.raises(InputError, match=r"another plan \(changed: recipe\.protocol\.depth_mm\)"):
        standin_build(other, target)
    assert (digest(target), digest(building_folder(target))) == before


def test_a_changed_recipe_is_refused_when_finished(
    plan: Plan, other: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(plan, target)
    before = digest(target)
    with pytest.raises(InputError, match="was built with another plan"):
        standin_build(other, target)
    assert digest(target) == before
    assert not building_folder(target).exists()


def test_another_law_another_version_other_meshes_and_another_contact_are_refused(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(plan, target)
    with pytest.raises(InputError, match=r"changed: model\)"):
        standin_build(make_plan(plan.recipe, "neo-hookean"), target)
    with monkeypatch.context() as patch:
        patch.setitem(plan.identity["versions"], "tisim", "99.0")
        with pytest.raises(InputError, match=r"changed: versions\.tisim\)"):
            standin_build(plan, target)
    for key, other in (("element", "hex8"), ("mesh_layout", 1), ("contact", 1)):
        assert plan.identity[key] != other
        with monkeypatch.context() as patch:
            patch.setitem(plan.identity, key, other)
            with pytest.raises(InputError, match=rf"changed: {key}\)"):
                standin_build(plan, target)


def test_overwrite_keeps_the_old_store_until_the_new_one_is_whole(
    plan: Plan, other: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    target, reference = tmp_path / "a.zarr", tmp_path / "reference.zarr"
    standin_build(plan, target)
    standin_build(other, reference)
    before = digest(target)

    def stop(state: BuildProgress) -> None:
        assert digest(target) == before
        if state.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        standin_build(other, target, overwrite=True, on_progress=stop)
    assert digest(target) == before
    left = summarise(target)
    assert (left.recipe, len(left.done)) == (plan.recipe.name, 4)
    assert f"recipe {other.recipe.name}, {other.model}, 2 of 4 pokes so far" in left.replacement
    assert left.replacement in " ".join(run_app(inspect_app, target).output.split())
    with pytest.raises(InputError, match="was begun with another plan"):
        standin_build(plan, target)
    assert standin_build(other, target).simulated == 2  # resumes without --overwrite
    assert digest(target) == digest(reference)
    assert not summarise(target).replacement


def test_a_preview_is_of_the_store_beside_it(
    plan: Plan, other: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a whole store is to be replaced, its preview stays."""
    monkeypatch.setattr(report, "_PICTURE_SECONDS", -1.0)
    target, shown = tmp_path / "a.zarr", b""
    seen: set[bytes] = set()
    for one, overwrite in ((plan, False), (other, True)):
        screen = report.Screen(
            one, target, make_console(), report.estimate(one, target, 1, overwrite=overwrite)
        )

        def watch(state: BuildProgress, screen: report.Screen = screen) -> None:
            screen.update(state)
            seen.add(report.preview_path(target).read_bytes())

        built = standin_build(one, target, overwrite=overwrite, on_progress=watch)
        if overwrite:
            assert seen == {shown}
        screen.finish(built)
        shown = report.preview_path(target).read_bytes()
        seen.clear()


def test_failed_pokes_do_not_replace_a_complete_store(
    plan: Plan, other: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, reference = tmp_path / "a.zarr", tmp_path / "reference.zarr"
    standin_build(plan, target)
    standin_build(other, reference)
    before = digest(target)
    with monkeypatch.context() as patch:
        patch.setenv("STANDIN_FAIL", f"{round(other.pokes[1].scene.site[0] * 1e6)}")
        with pytest.raises(
            InputError, match=r"1 of 4 pokes failed .*the complete dataset that is there stays"
        ):
            standin_build(other, target, overwrite=True)
        assert digest(target) == before
        with pytest.raises(InputError, match="--partial: holds a complete dataset"):
            build_dataset(other, target, partial=True)
    assert digest(target) == before
    assert standin_build(other, target).simulated == 1
    assert digest(target) == digest(reference)


def test_a_stopped_overwrite_of_the_same_plan_goes_on(
    plan: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(plan, target)

    def stop(state: BuildProgress) -> None:
        if state.done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        standin_build(plan, target, overwrite=True, on_progress=stop)
    assert standin_build(plan, target).simulated == 1
    assert not building_folder(target).exists()
    assert standin_build(plan, target).simulated == 0


def test_two_builders(plan: Plan, standin_build: Builder, tmp_path: Path) -> None:
    target = tmp_path / "a.zarr"
    with Staging(target), pytest.raises(InputError, match="another builder is at work"):
        standin_build(plan, target)
    assert standin_build(plan, target).simulated == 4


def test_a_builder_that_waits_for_the_lock_of_a_finished_one_starts_afresh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file may be removed between open and flock, and a lock on a removed file excludes nobody."""
    target = tmp_path / "a.zarr"
    real, once = os.open, [True]

    def race(path: Path, *args: int) -> int:
        handle = real(path, *args)
        if once:
            once.clear()
            os.unlink(path)  # noqa: PTH108
        return handle

    monkeypatch.setattr("factory.store.staging.os.open", race)
    with Staging(target):
        monkeypatch.undo()
        assert (building_folder(target) / "lock").is_file()
        with pytest.raises(InputError, match="another builder"):
            Staging(target).__enter__()


@pytest.mark.skipif(os.getuid() == 0, reason="root may write everywhere")
def test_read_only_folder(plan: Plan, standin_build: Builder, tmp_path: Path) -> None:
    folder = tmp_path / "fixed"
    folder.mkdir(mode=0o555)
    with pytest.raises(InputError, match="Permission denied"):
        standin_build(plan, folder / "a.zarr")


def test_read_only_file_system(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fixed(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    monkeypatch.setattr(Path, "mkdir", fixed)
    with pytest.raises(InputError, match=r"a\.zarr\.building: Read-only file system"):
        standin_build(plan, tmp_path / "a.zarr")


def test_something_else_in_the_way(plan: Plan, standin_build: Builder, tmp_path: Path) -> None:
    for name in ("folder", "file"):
        target = tmp_path / name
        if name == "folder":
            target.mkdir()
            (target / "thesis.txt").write_text("precious")
        else:
            target.write_text("precious")
        with pytest.raises(InputError, match="is not a dataset of the factory"):
            standin_build(plan, target, overwrite=True)
    assert (tmp_path / "folder" / "thesis.txt").read_text() == "precious"
    assert (tmp_path / "file").read_text() == "precious"


def test_failed_pokes_without_their_parts(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import shutil

    target = tmp_path / "a.zarr"
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    standin_build(plan, target)
    shutil.rmtree(building_folder(target))
    with pytest.raises(InputError, match="--overwrite"):
        standin_build(plan, target)


def test_a_simulator_that_cannot_be_loaded(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot load the simulator nowhere:f: ModuleNotFoundError"):
        build_dataset(plan, tmp_path / "a.zarr", simulator="nowhere:f")
