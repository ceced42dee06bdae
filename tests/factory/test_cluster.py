"""A dask cluster that does not respond, has no workers, or dies: reported, waited for, given up, no loss."""

from __future__ import annotations

import logging
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Generator
from pathlib import Path

import distributed
import pytest

from factory.building.build import BuildProgress, build_dataset
from factory.errors import InputError
from factory.plan import Plan
from factory.simulation import cluster as cluster_module
from factory.store.staging import Staging
from tests.factory.conftest import Builder, digest, environment

SIMULATOR = "tests.factory.standin:simulate"


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "NOTICE_SECONDS", 0.3)


@pytest.fixture
def port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


class Processes:
    """A scheduler and workers, each in its own process."""

    def __init__(self, port: int) -> None:
        self.address, self._port = f"tcp://127.0.0.1:{port}", port
        self._running: list[subprocess.Popen[bytes]] = []

    def start(self, *arguments: str, **variables: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [sys.executable, "-m", *arguments],
            env=environment(**variables),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._running.append(process)
        return process

    def scheduler(self) -> subprocess.Popen[bytes]:
        options = ("--host", "127.0.0.1", "--port", str(self._port), "--no-dashboard")
        process = self.start("distributed.cli.dask_scheduler", *options)
        deadline = time.monotonic() + 120
        while True:
            try:
                socket.create_connection(("127.0.0.1", self._port), timeout=1).close()
                return process
            except OSError:
                assert time.monotonic() < deadline
                time.sleep(0.1)

    def worker(self, **variables: str) -> subprocess.Popen[bytes]:
        """Start a worker and wait until the scheduler knows it; on a busy machine this takes seconds."""
        options = ("--no-nanny", "--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1")
        process = self.start("distributed.cli.dask_worker", self.address, *options, **variables)
        deadline = time.monotonic() + 120
        while not cluster_module._workers(self.address, 60):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.1)
        return process

    def end(self) -> None:
        for process in self._running:
            process.kill()
            process.wait()


@pytest.fixture
def processes(port: int, monkeypatch: pytest.MonkeyPatch) -> Generator[Processes]:
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "2s")
    found = Processes(port)
    yield found
    found.end()


def _build(plan: Plan, target: Path, address: str, timeout: float, **options: object) -> object:
    return build_dataset(
        plan,
        target,
        cluster=address,
        cluster_timeout=timeout,
        simulator=SIMULATOR,
        **options,  # type: ignore[arg-type]
    )


def test_a_port_where_nobody_listens(
    plan: Plan, port: int, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    began = time.monotonic()
    with pytest.raises(InputError, match=r"no dask scheduler answers there .* for 4 s \(--cluster-timeout\)"):
        _build(plan, tmp_path / "a.zarr", f"tcp://127.0.0.1:{port}", 4)
    assert 3.9 < time.monotonic() - began < 120
    assert "no dask scheduler answers there" in caplog.text
    assert "waiting up to" in caplog.text
    assert Staging(tmp_path / "a.zarr").read_plan() == plan.identity


def test_a_port_that_never_answers(plan: Plan, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The server accepts the connection and never replies."""
    caplog.set_level(logging.CRITICAL, logger="distributed")
    with socket.socket() as mute:
        mute.bind(("127.0.0.1", 0))
        mute.listen()
        with pytest.raises(InputError, match=r"no dask scheduler answers there .* for 4 s"):
            _build(plan, tmp_path / "a.zarr", f"tcp://127.0.0.1:{mute.getsockname()[1]}", 4)


def test_an_address_that_is_none(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"--cluster smoke://x: is no address of a scheduler"):
        _build(plan, tmp_path / "a.zarr", "smoke://x", 60)


def test_a_scheduler_without_workers_is_waited_for(
    plan: Plan, processes: Processes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    processes.scheduler()
    with pytest.raises(InputError, match=r"the scheduler has no workers for 3 s \(--cluster-timeout\)"):
        _build(plan, tmp_path / "a.zarr", processes.address, 3)
    assert "the scheduler has no workers: waiting up to" in caplog.text


@pytest.mark.parametrize(
    ("threads", "here", "sentence"),
    [
        (2, {}, r"worker .* runs 2 pokes at a time in one process: expected 1"),  # times would count twice
        (1, {"tisim": "0.0"}, r"worker .* has tisim .*, expected 0\.0 as here"),
    ],
)
def test_workers_that_would_give_other_results_are_refused(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    threads: int, here: dict[str, str], sentence: str,
) -> None:  # fmt: skip
    facts = cluster_module.worker_facts()
    own = iter([{**facts, **here}])  # asked in this process first
    monkeypatch.setattr(cluster_module, "worker_facts", lambda: next(own, facts))
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=threads, processes=False, dashboard_address=None
        ) as cluster,
        pytest.raises(InputError, match=sentence),
    ):
        _build(plan, tmp_path / "a.zarr", cluster.scheduler_address, 60)


def test_a_scheduler_that_dies_in_the_middle(
    plan: Plan, processes: Processes, standin_build: Builder, tmp_path: Path
) -> None:
    target, reference = tmp_path / "a.zarr", tmp_path / "reference.zarr"
    scheduler = processes.scheduler()
    processes.worker(STANDIN_SECONDS="1")

    def kill(state: BuildProgress) -> None:
        if state.done == 1:
            os.kill(scheduler.pid, signal.SIGKILL)

    with pytest.raises(InputError, match=r"the connection was lost .*every finished poke is kept"):
        _build(plan, target, processes.address, 60, on_progress=kill)
    kept = len(Staging(target).finished())
    assert 1 <= kept < 4
    assert standin_build(plan, target).simulated == 4 - kept
    standin_build(plan, reference)
    assert digest(target) == digest(reference)


def test_workers_that_all_die_are_waited_for(
    plan: Plan, processes: Processes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    processes.scheduler()
    worker = processes.worker(STANDIN_SECONDS="1")

    def kill(state: BuildProgress) -> None:
        if state.done == 1:
            os.kill(worker.pid, signal.SIGKILL)

    with pytest.raises(InputError, match=r"has lost all of its workers for 2 s \(--cluster-timeout\)"):
        _build(plan, tmp_path / "a.zarr", processes.address, 2, on_progress=kill)
    assert "has lost all of its workers: waiting up to" in caplog.text
    assert len(Staging(tmp_path / "a.zarr").finished()) >= 1
