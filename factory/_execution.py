"""Where pokes are simulated: in worker processes of this machine, or on a dask cluster.

One poke is one task. Unlike in concurrent.futures, a local worker that dies takes only its own poke with it,
and is replaced.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import math
import multiprocessing
import os
import queue
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

import numpy as np

from factory._input import InputError, one_line
from factory._record import Outcome, encode, record
from factory.plan import PlannedPoke
from tisim.parallel.extensions import Extension, adopt, needed

log = logging.getLogger(__name__)

SIMULATOR = "tisim:simulate"
ERROR_LENGTH = 400
CLUSTER_TIMEOUT = 300.0  # s without a scheduler or without a worker, after which a build gives up
NOTICE_SECONDS = 10.0  # after which it says what it waits for
_ATTEMPTS = 2  # a poke whose worker died twice is recorded as failed
_ANSWER_SECONDS = 20.0  # for the scheduler to hand over a finished result, or to count its workers

# one poke takes one core; more threads would only fight, and would change the order of sums
THREAD_VARIABLES = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    # MKL may otherwise pick another path for another memory alignment, and the bytes would differ
    "MKL_CBWR": "AUTO,STRICT",
}

Simulate = Callable[..., Sequence[Any]]


def _sendable(pokes: Sequence[PlannedPoke]) -> tuple[Extension, ...]:
    """Laws that were registered from outside and that the pokes need, for other processes."""
    found = needed([poke.scene for poke in pokes])
    if found is None:
        names = ", ".join(sorted({poke.scene.material.law for poke in pokes}))
        raise InputError(
            f"--model {names}: the law cannot be sent to worker processes: put it into a module of its own "
            "and give that with --plugin"
        )
    return found


def load_simulator(name: str) -> Simulate:
    """The function behind "module:function"."""
    module, _, function = name.partition(":")
    found: Simulate = getattr(importlib.import_module(module), function)
    return found


def run_poke(poke: PlannedPoke, simulator: str = SIMULATOR, extensions: Sequence[Extension] = ()) -> Outcome:
    """Simulate one poke; whatever goes wrong comes back as text, so that the build goes on.

    Parameters
    ----------
    poke : PlannedPoke
    simulator : str
        "module:function" with the signature of `tisim.simulate`.
    extensions : sequence of Extension
        Laws that were registered in the builder's process and that this one may lack.
    """
    wall, core = time.perf_counter(), time.process_time()
    payload: bytes | None = None
    error: str | None = None
    try:
        adopt(extensions)
        result = load_simulator(simulator)([poke.scene], workers=1)[0]
        arrays = record(poke.scene, result)
        arrays["poke"] = np.array(
            poke.index, dtype=np.int64
        )  # so that a file under another poke's name is recognised
        payload = encode(arrays)
    except Exception as problem:
        text = " ".join(str(problem).split())
        error = f"{type(problem).__name__}: {text}"[:ERROR_LENGTH]
    return Outcome(
        index=poke.index,
        payload=payload,
        error=error,
        wall=time.perf_counter() - wall,
        core=time.process_time() - core,
    )


def end_with_parent(parent: int) -> None:
    """Ends this process soon after its parent is gone (kill -9 leaves no time to say goodbye)."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


@dataclass
class _Worker:
    process: BaseProcess
    pipe: Connection
    poke: PlannedPoke | None = None
    ready: bool = False


def run_local(pokes: Sequence[PlannedPoke], *, workers: int, simulator: str) -> Generator[Outcome]:
    """Simulate pokes in worker processes; closing the generator ends them.

    Yields
    ------
    Outcome
        In the order in which they come.
    """
    extensions = _sendable(pokes)
    waiting = deque(pokes)
    deaths: dict[int, int] = {}
    pool: dict[Connection, _Worker] = {}
    try:
        while waiting or any(worker.poke for worker in pool.values()):
            while len(pool) < min(workers, len(waiting) + sum(bool(w.poke) for w in pool.values())):
                worker = _start(simulator, extensions)
                pool[worker.pipe] = worker
            for pipe in wait(list(pool)):
                assert isinstance(pipe, Connection)
                worker = pool[pipe]
                try:
                    message = pipe.recv()
                except (EOFError, ConnectionError):
                    del pool[pipe]
                    yield from _requeue_failed(worker, waiting, deaths)
                    continue
                if isinstance(message, Outcome):
                    worker.poke = None
                    yield message
                elif message is not None:
                    raise InputError(f"the workers cannot load the simulator {simulator}: {message}")
                worker.poke = waiting.popleft() if waiting else None
                if worker.poke is not None:
                    with contextlib.suppress(OSError):  # a dead worker: the next wait() says so
                        pipe.send(worker.poke)
                worker.ready = True
                if worker.poke is None:
                    _stop(pool.pop(pipe))
    finally:
        for worker in pool.values():
            _stop(worker)


def _requeue_failed(
    worker: _Worker, waiting: deque[PlannedPoke], deaths: dict[int, int]
) -> Generator[Outcome]:
    """Put a dead worker's poke back into the queue, or give it up after some deaths."""
    _stop(worker)
    code = worker.process.exitcode
    if not worker.ready:
        raise InputError(f"a worker process ended with code {code} before it could take a poke")
    if worker.poke is None:
        return
    index = worker.poke.index
    deaths[index] = deaths.get(index, 0) + 1
    if deaths[index] < _ATTEMPTS:
        waiting.appendleft(worker.poke)
    else:
        yield Outcome(index=index, payload=None, error=f"its worker process died {_ATTEMPTS} times")


def _start(simulator: str, extensions: Sequence[Extension] = ()) -> _Worker:
    # spawn, not fork: a forked child of a process that has started Taichi hangs
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(
        target=_work, args=(theirs, simulator, os.getpid(), tuple(extensions)), daemon=True
    )
    with _environment(THREAD_VARIABLES), _no_interrupts():
        process.start()
    theirs.close()
    return _Worker(process=process, pipe=ours)


def _stop(worker: _Worker) -> None:
    worker.pipe.close()
    if worker.process.is_alive():
        worker.process.kill()  # it owns nothing that a kill could spoil
    worker.process.join()


def _work(pipe: Connection, simulator: str, parent: int, extensions: Sequence[Extension] = ()) -> None:
    threading.Thread(target=end_with_parent, args=(parent,), daemon=True).start()
    with contextlib.suppress(EOFError, OSError):  # a build that is stopped closes the pipe
        try:
            load_simulator(simulator)
        except Exception as error:
            pipe.send(f"{type(error).__name__}: {error}")
            return
        pipe.send(None)
        while True:
            pipe.send(run_poke(pipe.recv(), simulator, extensions))


@contextlib.contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """Variables that a child started inside inherits."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _no_interrupts() -> Iterator[None]:
    """Children started inside never see Ctrl-C, which a terminal sends to all: we end them ourselves."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # the first child would start the tracker, and its start unblocks SIGINT before the child is made
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run_cluster(
    pokes: Sequence[PlannedPoke],
    *,
    address: str,
    workers: int,
    simulator: str,
    timeout: float = CLUSTER_TIMEOUT,
) -> Generator[Outcome]:
    """Simulate pokes on a dask cluster; the arrays travel back, so that only this process writes files.

    dask runs a poke again where its worker was lost, three times at most.

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
        In the order in which they come.
    """
    try:
        import distributed
    except ImportError:
        raise InputError("--cluster needs dask: pip install 'tisim[cluster]'") from None
    extensions = _sendable(pokes)
    cluster: Any = None
    client: Any = None
    # before the workers start: numpy and MKL read these once
    os.environ.update(THREAD_VARIABLES)
    try:
        if address == "local":
            cluster = distributed.LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
            )
        client = _connected(address, cluster, timeout)
        finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        run = os.urandom(4).hex()  # a scheduler may still remember the keys of an earlier build
        pending: dict[Any, tuple[int, Any]] = {}  # with the futures: dask forgets what nobody holds
        for poke in pokes:
            future = client.submit(run_poke, poke, simulator, extensions, key=f"poke-{poke.index}-{run}")
            pending[future.key] = (poke.index, future)
            future.add_done_callback(finished.put)
        yield from _collected(client, pending, finished, address, timeout)
    except OSError as error:
        raise _lost(address, one_line(error)) from None
    finally:
        if client is not None:
            with contextlib.suppress(Exception):  # a dead scheduler cannot say goodbye
                client.close(timeout=5)
        if cluster is not None:
            cluster.close()


def _connected(address: str, cluster: Any, timeout: float) -> Any:
    """A client of the scheduler, once it answers and has a worker."""
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


def _collected(
    client: Any,
    pending: dict[Any, tuple[int, Any]],
    finished: queue.SimpleQueue[Any],
    address: str,
    timeout: float,
) -> Generator[Outcome]:
    """Outcomes as their futures finish; InputError where the scheduler is gone, or all workers are."""
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
        future.release()  # the cluster need not keep what we have


def _has_workers(client: Any) -> bool:
    try:
        return _workers(client.scheduler.address, _ANSWER_SECONDS) > 0
    except OSError:
        return False


def _workers(address: str, timeout: float) -> int:
    """How many workers the scheduler has; OSError where it does not answer in time.

    A client would wait without end for a port that takes the connection and says nothing.
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
    """Waiting for something: says so once after some seconds, gives up after `timeout`."""

    def __init__(self, state: str, timeout: float) -> None:
        self._state, self._timeout, self._began, self._noted = state, timeout, time.monotonic(), False

    def left(self) -> float:
        """Seconds until it gives up."""
        return max(0.0, self._began + self._timeout - time.monotonic())

    def restart(self) -> None:
        """Count from now on: what it waits for was there."""
        self._began, self._noted = time.monotonic(), False

    def check(self, reason: str = "") -> None:
        """Log what is waited for, once it is time; InputError when the time is over."""
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
