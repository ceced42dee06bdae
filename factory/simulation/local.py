"""Pokes in worker processes of this machine.

Unlike in concurrent.futures, a worker that dies takes only its own poke with it, and is replaced.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from factory.errors import InputError
from factory.plan.poke import PlannedPoke
from factory.simulation.execution import load_simulator, run_poke, sendable
from factory.simulation.record import Outcome
from tisim.parallel.extensions import Extension
from tisim.parallel.threads import SAME_BYTES

_ATTEMPTS = 2  # a poke whose worker died twice is recorded as failed


def end_with_parent(parent: int) -> None:
    """End this process soon after its parent ends (kill -9 allows the parent no clean-up)."""
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
        In the order in which pokes finish.
    """
    extensions = sendable(pokes)
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
                    with contextlib.suppress(OSError):  # a dead worker: the next wait() reports it
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
    """Put a dead worker's poke back into the queue, or report it as failed after `_ATTEMPTS` deaths."""
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
    with _environment(SAME_BYTES), _no_interrupts():
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
    """Set environment variables for child processes started inside."""
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
    """Block Ctrl-C, which a terminal sends to all, in children started inside: the parent ends them."""
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
