"""Pokes on a dask cluster."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import os
import queue
import time
from collections.abc import Generator, Sequence
from typing import Any

from factory.errors import InputError, one_line
from factory.plan.poke import PlannedPoke
from factory.simulation.execution import ERROR_LENGTH, run_poke, sendable, worker_facts
from factory.simulation.record import Outcome
from tisim.parallel.threads import SAME_BYTES

log = logging.getLogger(__name__)

CLUSTER_TIMEOUT = 300.0  # s without a scheduler or without a worker, after which a build gives up
NOTICE_SECONDS = 10.0  # of waiting, after which the reason is logged
_ANSWER_SECONDS = 20.0  # for the scheduler to hand over a finished result, or to count its workers


def run_cluster(
    pokes: Sequence[PlannedPoke],
    *,
    address: str,
    workers: int,
    simulator: str,
    timeout: float = CLUSTER_TIMEOUT,
) -> Generator[Outcome]:
    """Simulate pokes on a dask cluster; only this process writes files, from the arrays that workers return.

    dask repeats a poke whose worker was lost, three times at most.

    Parameters
    ----------
    pokes : sequence of PlannedPoke
    address : str
        Address of a scheduler, or "local" for a cluster of `workers` processes on this machine.
    timeout : float
        Time [s] without a scheduler or without a worker after which InputError is raised.

    Yields
    ------
    Outcome
        In the order in which pokes finish.
    """
    try:
        import distributed
    except ImportError:
        raise InputError("--cluster needs dask: pip install 'tisim[cluster]'") from None
    extensions = sendable(pokes)
    cluster: Any = None
    client: Any = None
    # before the workers start: numpy and MKL read these once
    os.environ.update(SAME_BYTES)
    try:
        if address == "local":
            cluster = distributed.LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
            )
        client = _connected(address, cluster, timeout)
        _check_workers(client, address)
        finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        run = os.urandom(4).hex()  # a scheduler may still remember the keys of an earlier build
        pending: dict[Any, tuple[int, Any]] = {}  # holds the futures: dask drops a result without one
        for poke in pokes:
            future = client.submit(run_poke, poke, simulator, extensions, key=f"poke-{poke.index}-{run}")
            pending[future.key] = (poke.index, future)
            future.add_done_callback(finished.put)
        yield from _collected(client, pending, finished, address, timeout)
    except OSError as error:
        raise _lost(address, one_line(error)) from None
    finally:
        if client is not None:
            with contextlib.suppress(Exception):  # a dead scheduler does not answer
                client.close(timeout=5)
        if cluster is not None:
            cluster.close()


def _connected(address: str, cluster: Any, timeout: float) -> Any:
    """Wait until the scheduler answers and has a worker; return a client."""
    import distributed

    if cluster is not None:
        return distributed.Client(cluster)
    silent = _Wait(f"--cluster {address}: no dask scheduler answers there", timeout)
    idle = _Wait(f"--cluster {address}: the scheduler has no workers", timeout)
    while True:
        try:
            if _workers(address, min(2.0, max(0.1, silent.left()))):
                return distributed.Client(address)
        except ValueError as error:
            raise InputError(
                f"--cluster {address}: is no address of a scheduler ({one_line(error)})"
            ) from None
        except (OSError, RuntimeError) as error:
            silent.check(one_line(error))
            idle.restart()
        else:
            idle.check()
            silent.restart()
        time.sleep(min(0.3, silent.left()))


def _check_workers(client: Any, address: str) -> None:
    """Refuse workers that would give other bytes than this process, or measure another one's time.

    Workers that join later are not checked.
    """
    here = worker_facts()
    for worker, found in client.run(worker_facts).items():
        for name, wanted in here.items():
            if found[name] != wanted:
                raise InputError(
                    f"--cluster {address}: worker {worker} has {name} {found[name]},"
                    f" expected {wanted} as here"
                )
    for worker, about in client.scheduler_info(n_workers=-1)["workers"].items():
        if about["nthreads"] != 1:
            raise InputError(
                f"--cluster {address}: worker {worker} runs {about['nthreads']} pokes at a time in one"
                " process: expected 1 (dask worker --nthreads 1)"
            )


def _collected(
    client: Any,
    pending: dict[Any, tuple[int, Any]],
    finished: queue.SimpleQueue[Any],
    address: str,
    timeout: float,
) -> Generator[Outcome]:
    """Yield outcomes as they finish; InputError if the scheduler is lost or has no worker for too long."""
    waiting: _Wait | None = None
    while pending:
        try:
            future = finished.get(timeout=1.0)
        except queue.Empty:
            if client.status != "running":
                raise _lost(address, "the scheduler is gone") from None
            if _has_workers(client):
                waiting = None
            elif waiting is None:
                waiting = _Wait(f"--cluster {address}: the scheduler has lost all of its workers", timeout)
            else:
                waiting.check()
            continue
        waiting = None
        if future.status == "cancelled":
            raise _lost(address, "the scheduler is gone, or has cancelled the pokes")
        index, _ = pending.pop(future.key)
        lost = future.exception(timeout=_ANSWER_SECONDS)
        if lost is None:
            yield future.result(timeout=_ANSWER_SECONDS)
        else:
            text = f"{type(lost).__name__}: {one_line(lost, ERROR_LENGTH)}"
            yield Outcome(index=index, payload=None, error=text[:ERROR_LENGTH])
        future.release()  # so that the cluster frees the result


def _has_workers(client: Any) -> bool:
    try:
        return _workers(client.scheduler.address, _ANSWER_SECONDS) > 0
    except OSError:
        return False


def _workers(address: str, timeout: float) -> int:
    """Number of workers of the scheduler; OSError if it does not answer in time.

    A client would wait forever on a port that accepts the connection and never answers.
    """
    import distributed

    async def ask() -> int:
        async with distributed.rpc(address, timeout=timeout) as scheduler:
            return len(await scheduler.ncores())

    return asyncio.run(asyncio.wait_for(ask(), timeout))


def _lost(address: str, reason: str) -> InputError:
    return InputError(
        f"--cluster {address}: the connection was lost ({reason}); every finished poke is kept, and the same"
        " command goes on from there"
    )


class _Wait:
    """Limit on a wait: logs the state once after `NOTICE_SECONDS`, raises InputError after `timeout` [s]."""

    def __init__(self, state: str, timeout: float) -> None:
        self._state, self._timeout, self._began, self._noted = state, timeout, time.monotonic(), False

    def left(self) -> float:
        """Seconds until the limit."""
        return max(0.0, self._began + self._timeout - time.monotonic())

    def restart(self) -> None:
        """Restart the clock, since the condition was met in between."""
        self._began, self._noted = time.monotonic(), False

    def check(self, reason: str = "") -> None:
        """Log the state once after `NOTICE_SECONDS`; InputError if the limit has passed."""
        why = f" ({reason})" if reason else ""
        if self.left() <= 0.0:
            raise InputError(
                f"{self._state}{why} for {self._timeout:g} s (--cluster-timeout); every finished poke is"
                " kept, and the same command goes on from there"
            )
        if not self._noted and time.monotonic() - self._began >= NOTICE_SECONDS:
            self._noted = True
            log.warning("%s%s: waiting %s more.", self._state, why, _seconds(self.left()))


def _seconds(value: float) -> str:
    return "without end" if math.isinf(value) else f"up to {value:.0f} s"
