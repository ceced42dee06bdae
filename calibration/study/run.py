"""Run the fits of a study, in two processes or more, resumable at any moment."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import replace
from multiprocessing import connection
from pathlib import Path

import numpy as np

from calibration.errors import InputError
from calibration.experiment import Experiment
from calibration.inference import Generation, HistoryError
from calibration.progress import FitProgress, OnProgress
from calibration.study import parts
from calibration.study._store import locked
from calibration.study.calibrate import best_so_far, calibrate
from calibration.study.calibration import Calibration
from calibration.study.measurements import OnSetup
from calibration.study.tasks import Task
from tisim.parallel.threads import ONE_THREAD

log = logging.getLogger(__name__)


def run(
    tasks: Sequence[Task], *, workers: int, on_progress: OnProgress = lambda _: None
) -> list[Calibration]:
    """Fit all tasks; those already on disk are read.

    Parameters
    ----------
    tasks : sequence of Task
    workers : int
        Processes.
    on_progress : callable
        Called with a `FitProgress`, about twice a second.

    Returns
    -------
    list of Calibration
        In the order of the tasks.

    Raises
    ------
    InputError
        A fit on disk is damaged, or of other data or options, or another process is at work in the folder.
    KeyboardInterrupt
        All workers are stopped; what their searches had found stays on disk (`stopped` reads it).
    """
    with contextlib.ExitStack() as held:
        for folder in dict.fromkeys(task.folder for task in tasks):
            held.enter_context(locked(folder))
        ended: dict[str, Calibration] = {}
        for task in tasks:
            found = task.store().result()
            task.store().history()  # refuses another study's before anything is computed
            if found is not None:
                ended[task.name] = found
        waiting = [t for t in tasks if t.name not in ended]
        if waiting:
            _run(waiting, workers, ended, len(tasks), on_progress)
        return [ended[t.name] for t in tasks]


def _run(
    waiting: list[Task],
    workers: int,
    ended: dict[str, Calibration],
    total: int,
    on_progress: OnProgress,
) -> None:
    def show() -> None:
        on_progress(_progress(waiting, ended, total))

    # a law, part or kind of measurement of the caller's own is known to this process only
    own = [t for t in waiting if t.is_added]
    spread = [t for t in waiting if t not in own]
    if min(workers, len(spread)) == 1:
        own, spread = waiting, []
    for task in own:
        show()
        ended[task.name] = fit_task(task, workers=workers, on_generation=show)
        log.info("%r", ended[task.name])
        show()
    if spread:
        _run_spread(spread, workers, ended, show)


def _run_spread(
    waiting: list[Task], workers: int, ended: dict[str, Calibration], show: Callable[[], None]
) -> None:
    """Fits in processes of their own."""
    # each fit alone on one core: BLAS threads that spin while they wait cost a factor
    for name, count in ONE_THREAD.items():
        os.environ.setdefault(name, count)
    pool = ProcessPoolExecutor(
        max_workers=min(workers, len(waiting)),
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_end_with_parent,
    )
    futures: dict[Future[Calibration], Task] = {pool.submit(fit_task, t, workers=1): t for t in waiting}
    try:
        open_ones = set(futures)
        while open_ones:
            done, open_ones = wait(open_ones, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in done:
                ended[futures[future].name] = future.result()
                log.info("%r", ended[futures[future].name])
            show()
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def fit_task(
    task: Task, *, workers: int | None, on_generation: Callable[[], None] = lambda: None
) -> Calibration:
    """One fit, going on from its history, written down when it ends."""
    store = task.store()
    if len(task.alternatives) > 1:
        found = [
            t.store().result() or fit_task(t, workers=workers, on_generation=on_generation)
            for t in task.alternatives
        ]
        result = replace(parts.choose(found), asked=task.parts)
        store.finish(result, chosen_from=[t.name for t in task.alternatives])
        return result
    experiment = OnSetup.of(task.experiment, task.setup)

    def keep(generation: Generation) -> None:
        if not generation.replayed:
            store.append(generation)
        on_generation()

    try:
        result = calibrate(
            task.measurements(experiment, workers=workers),
            options=task.options,
            history=store.history(),
            on_progress=keep,
        )
    except HistoryError as error:
        raise InputError(
            f"{store.history_path}: {error} (--overwrite starts anew, --out writes elsewhere)"
        ) from error
    result = _with_setup(result, task)
    store.finish(result)
    return result


def _with_setup(result: Calibration, task: Task) -> Calibration:
    """The result with a note on the rig that it was corrected for, and the card that it took parts from."""
    rig = "" if task.setup is None else task.setup.sentence
    card = "" if task.card is None else task.card.sentence(task.parts)
    return replace(result, note="; ".join(n for n in (rig, card, result.note) if n))


def _end_with_parent() -> None:
    """Ends this worker when its parent is killed: the next run must find its files left alone."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_with_parent, args=(parent.sentinel,), daemon=True).start()


def _exit_with_parent(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


def stopped(tasks: Sequence[Task], experiment: Experiment) -> list[Calibration]:
    """State of a stopped study: finished fits, and the best candidate of each unfinished one."""
    found: list[Calibration] = []
    for task in tasks:
        store = task.store()
        result = store.result()
        if result is None and len(task.alternatives) > 1:
            ended = stopped(task.alternatives, experiment)
            if not ended:
                continue
            result = replace(parts.choose(ended), asked=task.parts)
            waiting = [own.label for own in task.alternatives if own.store().result() is None]
            if waiting:
                said = f"the best so far: {', '.join(waiting)} had not ended"
                result = replace(result, status="stopped", message=said, note="")
        elif result is None:
            history = [g for g in store.history() if np.isfinite(g.costs).any()]
            if not history:
                continue
            data = task.measurements(OnSetup.of(experiment, task.setup), workers=1)
            best = best_so_far(data, history)
            if best is None:
                continue
            result = _with_setup(best, task)
        found.append(result)
    return found


def _progress(waiting: Sequence[Task], ended: dict[str, Calibration], total: int) -> FitProgress:
    generations: dict[str, int] = {}
    best: dict[str, float] = {}
    for task in waiting:
        if task.name in ended:
            continue
        lines = _lines(task.store().history_path)
        generations[task.name] = max(0, len(lines) - 1)
        costs = [c for line in lines[1:] for c in _costs(line)]
        if costs:
            best[task.name] = min(costs)
    return FitProgress(
        message=", ".join(f"{name} generation {n}" for name, n in generations.items() if n),
        done=len(ended),
        total=total,
        generations=generations,
        best=best,
        ended=dict(ended),
    )


def _lines(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


def _costs(line: str) -> list[float]:
    """Costs in a line of a history; none in one that is being written just now."""
    tail = line.rpartition('"costs": [')[2]
    if not tail.endswith("]}"):
        return []
    return [float(c) for c in tail.rstrip("]}").split(",") if c.strip() not in ("", "null")]
