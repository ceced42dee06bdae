"""A build that is killed at any moment and restarted: no loss, no duplicate, the same bytes."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import io
import multiprocessing
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import psutil
import pytest
from rich.console import Console

from factory.building.build import build_dataset
from factory.building.report import Screen, estimate
from factory.errors import InputError
from factory.plan import Plan, make_plan
from factory.reader import open_dataset
from factory.recipe import Recipe
from factory.simulation import local
from factory.store import assemble, staging
from factory.store.staging import Staging, building_folder
from tests.factory.conftest import Builder, digest, environment


class Killed(BaseException):
    """Simulated kill -9 at one file operation; no file operation succeeds after it."""


class Reaper:
    """Allow `alive` file operations; the next one, and all after it, raise `Killed`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, alive: int) -> None:
        self.alive, self.dead = alive, False
        for name in ("replace", "rename", "unlink", "rmdir"):
            monkeypatch.setattr(Path, name, self.mortal(getattr(Path, name)))
        half = SimpleNamespace(rmtree=self.mortal(shutil.rmtree, first=_half_gone))
        monkeypatch.setattr(staging, "shutil", half)
        monkeypatch.setattr(assemble, "shutil", half)

    def mortal(self, action: Callable[..., Any], first: Callable[..., None] | None = None) -> Any:
        def call(*args: Any, **kwargs: Any) -> Any:
            # Zarr moves files in its own threads: only operations of this package count
            if threading.current_thread() is not threading.main_thread():
                return action(*args, **kwargs)
            if self.dead or self.alive == 0:
                if first is not None and not self.dead:
                    first(*args)
                self.dead = True
                raise Killed
            self.alive -= 1
            return action(*args, **kwargs)

        return call


def _half_gone(folder: Path, *_: object) -> None:
    """Leave the folder as a killed rmtree would, with half of its files."""
    for path in sorted(Path(folder).rglob("*.npz"))[::2]:
        os.unlink(path)  # noqa: PTH108 - Path.unlink is the patched one


def _lives_through_every_kill(
    plan: Plan, run: Builder, folder: Path, prepare: Callable[[Path], None], overwrite: bool
) -> int:
    """Kill a build at its first, second, ... file operation and build again; return their number."""
    reference = folder / "reference.zarr"
    run(plan, reference)
    left: set[str] = set()  # digests of the files after earlier kills: each state is rebuilt once
    for moment in range(200):
        target = folder / f"{moment}.zarr"
        prepare(target)
        with pytest.MonkeyPatch.context() as patch:
            reaper = Reaper(patch, moment)
            try:
                run(plan, target, overwrite=overwrite)
            except Killed:
                pass
            else:
                assert not reaper.dead
                return moment
        if (files := _files(target)) not in left:
            left.add(files)
            assert run(plan, target).errors == {}
            assert digest(target) == digest(reference), f"killed at operation {moment}"
            assert not building_folder(target).exists()
        shutil.rmtree(target, ignore_errors=True)
        shutil.rmtree(building_folder(target), ignore_errors=True)
    raise AssertionError("the build never came to an end")


def _files(target: Path) -> str:
    """Digest of names and contents of the target and its building folder; for the ledger its line count."""
    total = hashlib.sha256()
    for root in (target, building_folder(target)):
        for path in sorted(root.rglob("*")):
            content = path.read_bytes() if path.is_file() else b"/"
            if path.name == "ledger.jsonl":  # times differ
                content = b"%d" % content.count(b"\n")
            elif path.name == "lock":  # holds a process id
                content = b""
            name = path.relative_to(target.parent).as_posix().replace(target.name, "target")
            total.update(f"{name} {hashlib.sha256(content).hexdigest()}\n".encode())
    return total.hexdigest()


@pytest.fixture
def short(tiny: Recipe) -> Plan:
    """A plan of two pokes: there is a rebuild for each possible kill."""
    protocol = tiny.protocol.model_copy(update={"own_sites": 1})
    return make_plan(tiny.model_copy(update={"protocol": protocol}), "ogden")


@pytest.fixture
def _few_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write five of the store's fifty arrays, one of each kind: kills do not depend on the array."""
    kept = ("done", "message", "depth", "rod_force", "surface_displacement")
    specs = assemble._specs
    monkeypatch.setattr(assemble, "_specs", lambda plan: {n: s for n, s in specs(plan).items() if n in kept})


@pytest.mark.usefixtures("_few_arrays")
def test_every_kill_of_a_first_build(short: Plan, standin_build: Builder, tmp_path: Path) -> None:
    moments = _lives_through_every_kill(short, standin_build, tmp_path, lambda _: None, overwrite=False)
    assert moments > 2 * len(short.pokes)  # a rename and an unlink for each poke, and others


@pytest.mark.usefixtures("_few_arrays")
def test_every_kill_of_an_overwrite(short: Plan, standin_build: Builder, tmp_path: Path) -> None:
    kept = tmp_path / "kept.zarr"
    standin_build(short, kept)
    assert _lives_through_every_kill(
        short, standin_build, tmp_path, lambda target: _copy(kept, target), overwrite=True
    )


def _copy(source: Path, target: Path) -> None:
    shutil.copytree(source, target)


def test_real_kills_with_two_workers(
    quick_store: Path, command: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    target = tmp_path / "target.zarr"
    log = tmp_path / "log"
    arguments = ("--model", "ogden", "--recipe", "quick", "--out", str(target), "--workers", "2")
    variables = {"STANDIN_SECONDS": "0.4", "STANDIN_LOG": str(log)}
    moments = random.Random(5)
    kills = 0
    for _ in range(2):
        before = len(Staging(target).finished())
        process = command(*arguments, **variables)
        while process.poll() is None and len(Staging(target).finished()) == before:
            time.sleep(0.005)
        time.sleep(moments.uniform(0, 0.25))
        if process.poll() is None:
            os.kill(process.pid, signal.SIGKILL)  # only the main process: its workers must end by themselves
            kills += 1
        process.communicate()
    assert kills == 2
    assert Staging(target).finished()
    process = command(*arguments, **variables)
    _, errors = process.communicate(timeout=600)
    assert process.returncode == 0, errors
    assert digest(target) == digest(quick_store)
    data = open_dataset(target)
    assert data.table["done"].all()
    np.testing.assert_array_equal(np.unique(data.table["frame_poke"]), np.arange(12))
    # staged pokes are not simulated again: only those in progress at a kill are
    simulated = len(log.read_text().splitlines())
    solves = len(np.unique(data.table["solved_as"]))  # the others are a solve at another modulus
    assert solves == 8
    assert solves <= simulated <= solves + kills * 2 * 2


def test_bytes_do_not_depend_on_the_workers(plan: Plan, tmp_path: Path) -> None:
    for workers in (1, 2):
        build_dataset(
            plan, tmp_path / f"{workers}.zarr", workers=workers, simulator="tests.factory.standin:simulate"
        )
    assert digest(tmp_path / "1.zarr") == digest(tmp_path / "2.zarr")


def test_a_dead_worker_is_replaced(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trigger = tmp_path / "kill"
    trigger.touch()
    monkeypatch.setenv("STANDIN_KILL", str(trigger))
    built = build_dataset(plan, tmp_path / "a.zarr", workers=2, simulator="tests.factory.standin:simulate")
    assert not trigger.exists()
    assert built.errors == {}
    assert built.simulated == len(plan.pokes)


def test_a_poke_that_kills_its_worker_is_recorded(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bad = plan.pokes[1]
    monkeypatch.setenv("STANDIN_DIE", f"{round(bad.scene.site[0] * 1e6)}")
    built = build_dataset(plan, tmp_path / "a.zarr", workers=1, simulator="tests.factory.standin:simulate")
    assert built.errors == {1: "its worker process died 2 times"}
    assert built.simulated == len(plan.pokes) - 1


def test_a_failed_poke_is_noted_and_tried_again(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, reference = tmp_path / "a.zarr", tmp_path / "reference.zarr"
    standin_build(plan, reference)
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    built = standin_build(plan, target)
    text = "RuntimeError: the stand-in was told to fail"
    assert built.errors == {1: text}
    data = open_dataset(target)
    assert [data.status(i) == "failed" for i in range(4)] == [False, True, False, False]
    assert data.message(1) == text
    assert data.table["frame_count"][1] == 0
    monkeypatch.delenv("STANDIN_FAIL")
    again = standin_build(plan, target)
    assert (again.simulated, again.errors) == (1, {})
    assert digest(target) == digest(reference)


def test_a_finished_store_is_left_alone(plan: Plan, standin_build: Builder, tmp_path: Path) -> None:
    target = tmp_path / "a.zarr"
    standin_build(plan, target)
    times = {path: path.stat().st_mtime_ns for path in target.rglob("*")}
    assert standin_build(plan, target).simulated == 0
    assert times == {path: path.stat().st_mtime_ns for path in target.rglob("*")}
    assert not building_folder(target).exists()


def test_disk_full_while_a_poke_is_written(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, reference = tmp_path / "a.zarr", tmp_path / "reference.zarr"
    standin_build(plan, reference)
    real, calls = os.fsync, iter(range(100))

    def full(handle: int) -> None:
        if next(calls) == 6:  # plan file and folder, poke 0 and folder, poke 2 and folder, poke 1
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(handle)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(InputError, match="No space left on device; every finished poke is kept"):
            standin_build(plan, target)
    assert Staging(target).finished() == {0, 2}
    assert not list(building_folder(target).rglob("*.part"))
    assert standin_build(plan, target).simulated == 2
    assert digest(target) == digest(reference)


def test_disk_full_while_the_store_is_written(
    quick_store: Path, quick: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    """A real limit on file size, larger than the staged results and smaller than the store's shards."""
    target = tmp_path / "a.zarr"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, before[1]))
    try:
        with pytest.raises(InputError, match="File too large; every finished poke is kept"):
            standin_build(quick, target)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert len(Staging(target).finished()) == 12
    assert not target.exists()
    assert standin_build(quick, target).simulated == 0
    assert digest(target) == digest(quick_store)


def test_ctrl_c_waits_until_a_result_is_open(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It did not, and a file of zipfile that is interrupted while it is made prints a traceback."""
    payload = io.BytesIO()
    np.savez(payload, depth=np.zeros(0), rod_force=np.zeros((0, 3)), grid_displacement=np.zeros((0, 4, 3)))
    target, console = tmp_path / "a.zarr", Console(file=io.StringIO())
    seen = Screen(plan, target, console, estimate(plan, target, 1))
    staged = Staging(target)
    staged.results.mkdir(parents=True)
    staged.result_path(0).write_bytes(payload.getvalue())
    load, opened = np.load, []

    def interrupted(*arguments: Any, **options: Any) -> object:
        signal.raise_signal(signal.SIGINT)
        found = load(*arguments, **options)
        opened.append(found)
        return found

    monkeypatch.setattr(np, "load", interrupted)
    with pytest.raises(KeyboardInterrupt), staged.opened(0):
        pass
    with pytest.raises(KeyboardInterrupt):
        seen._add(0, payload.getvalue())
    assert len(opened) == 2


def test_ctrl_c_ends_cleanly_and_goes_on(
    quick_store: Path,
    quick: Plan,
    standin_build: Builder,
    command: Callable[..., subprocess.Popen[str]],
    tmp_path: Path,
) -> None:
    target = tmp_path / "a.zarr"
    arguments = ("--model", "ogden", "--recipe", "quick", "--out", str(target), "--workers", "2")
    process = command(*arguments, STANDIN_SECONDS="0.5")
    while not Staging(target).finished():
        assert process.poll() is None
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # to the whole group, as a terminal does
    _, errors = process.communicate(timeout=600)
    assert process.returncode == 130
    kept = len(Staging(target).finished())
    assert f"Stopped. {kept} finished pokes are kept; the same command" in errors
    assert "Traceback" not in errors
    deadline = time.monotonic() + 120
    while left := _alive_in_group(process.pid):  # all workers end
        assert time.monotonic() < deadline, left
        time.sleep(0.05)
    assert standin_build(quick, target).simulated == 12 - kept
    assert digest(target) == digest(quick_store)


_FIRST_WORKER = """
from pathlib import Path
from factory.simulation import local
if __name__ == "__main__":
    workers = [local._start("math:sqrt") for _ in range(2)]
    for worker in workers:
        status = Path(f"/proc/{worker.process.pid}/status").read_text()
        fields = dict(line.split(":", 1) for line in status.splitlines())
        print(int(fields["SigBlk"], 16) >> 1 & 1)  # bit 1: SIGINT
        local._stop(worker)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads the signals of Linux")
def test_no_worker_sees_ctrl_c_not_even_the_first(tmp_path: Path) -> None:
    script = tmp_path / "first_worker.py"  # in a new process: only the first start is at risk
    script.write_text(_FIRST_WORKER)
    run = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, timeout=600, env=environment()
    )
    assert run.stdout.split() == ["1", "1"], run.stderr


@pytest.mark.parametrize("simulator", ["math:sqrt", "math:nothing"])
def test_a_worker_that_loads_while_the_build_is_stopped_says_nothing(
    simulator: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local, "end_with_parent", lambda _: None)
    ours, theirs = multiprocessing.Pipe()
    ours.close()
    local._work(theirs, simulator, 0)


def _alive_in_group(group: int) -> list[str]:
    alive = []
    for process in psutil.process_iter(["status", "cmdline"]):
        with contextlib.suppress(psutil.Error, ProcessLookupError):
            if os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE:
                alive.append(str(process.info))
    return alive


def test_cluster_with_a_worker_killed(
    quick_store: Path, command: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    """A real LocalCluster with two worker processes."""
    target = tmp_path / "a.zarr"
    trigger = tmp_path / "kill"
    trigger.touch()
    process = command(
        *("--model", "ogden", "--recipe", "quick", "--out", str(target), "--workers", "2"),
        *("--cluster", "local"),
        STANDIN_KILL=str(trigger),
        STANDIN_SECONDS="0.1",
    )
    _, errors = process.communicate(timeout=600)
    assert process.returncode == 0, errors
    assert not trigger.exists()
    assert digest(target) == digest(quick_store)
