"""Worker processes with one core each, kept for the next batch."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future

from tisim.parallel.chunks import Chunk, solve_chunk
from tisim.parallel.extensions import adopt
from tisim.parallel.threads import SAME_BYTES, one_thread
from tisim.result import Result

IDLE_SECONDS = 120.0  # time for which processes wait for the next batch
START_SECONDS = 3.0  # time to start them: imports, Taichi's runtime and the kernels of a law, on each core

_warm_until = 0.0
_missed = 0.0

Solved = list[tuple[int, Result]]


def cores() -> int:
    """Cores that this process may use."""
    from loky import cpu_count

    return int(cpu_count())


def pays_off(seconds: Sequence[float], count: int) -> bool:
    """True if processes should be used for chunks of these costs [core-s] on `count` cores.

    Running processes are used if they save time. Otherwise the time that they would have saved is summed over
    calls, and they are started once the sum exceeds the cost of starting them. The total cost is then at most
    twice that of the best decision in hindsight.
    """
    global _missed
    if min(count, len(seconds)) < 2:
        return False
    total = sum(seconds)
    saving = total - max(total / count, max(seconds))
    if time.monotonic() < _warm_until:
        return saving > 0.02  # sending scenes and results costs some milliseconds
    if _missed + saving < START_SECONDS:
        _missed += saving
        return False
    _missed = 0.0
    return True


def submit(chunks: Sequence[Chunk], workers: int) -> dict[Future[Solved], Chunk]:
    """Submit chunks to the worker processes, which are started if necessary."""
    from loky import get_reusable_executor
    from loky.process_executor import BrokenProcessPool

    executor = get_reusable_executor(max_workers=workers, timeout=IDLE_SECONDS, env=SAME_BYTES)
    futures: dict[Future[Solved], Chunk] = {}
    for chunk in chunks:
        try:
            future = executor.submit(_solve, chunk)
        except BrokenProcessPool as error:  # a worker died during the submission
            future = Future()
            future.set_exception(error)
        future.add_done_callback(_keep_warm)
        futures[future] = chunk
    return futures


def _keep_warm(_future: object) -> None:
    global _warm_until
    _warm_until = time.monotonic() + 0.8 * IDLE_SECONDS


def stop(futures: dict[Future[Solved], Chunk]) -> None:
    """Cancel pending chunks and, if some are running, kill the processes; the next call starts new ones."""
    global _warm_until
    for future in futures:
        future.cancel()
    if not all(future.done() for future in futures):
        from loky import get_reusable_executor

        get_reusable_executor(reuse=True).shutdown(wait=False, kill_workers=True)
        _warm_until = 0.0


def _solve(chunk: Chunk) -> Solved:
    adopt(chunk.extensions or ())
    with one_thread():
        return list(solve_chunk(chunk))
