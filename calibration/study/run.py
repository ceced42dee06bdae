"""A study on disk: every material against every law, two processes or more, resumable at any moment."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import connection
from pathlib import Path
from typing import Any

import numpy as np

from calibration.experiment import Experiment, read
from calibration.outlines.setup import Setup
from calibration.parameters import parametrisation
from calibration.search import Generation
from calibration.study._store import FitStore
from calibration.study.calibrate import FitOptions, best_so_far, calibrate
from calibration.study.calibration import Calibration
from calibration.study.measurements import ObjectiveName, OnSetup, measurements

# Raised whenever the objective or the search changes: their histories would not fit together.
FORMAT = 2


@dataclass(frozen=True, kw_only=True)
class Task:
    """One fit of a study. setup: what is known of rig and camera."""

    experiment: Path
    digest: str
    material: str
    law: str
    terms: int
    options: FitOptions
    folder: Path
    objective: ObjectiveName = "likelihood"
    setup: Setup | None = None

    @property
    def label(self) -> str:
        return parametrisation(self.law, terms=self.terms).label

    @property
    def name(self) -> str:
        return f"{self.material}-{self.label}"

    def store(self) -> FitStore:
        header: dict[str, Any] = {
            "format": FORMAT,
            "data": self.digest,
            "material": self.material,
            "law": self.label,
            "seed": self.options.cma.seed,
            "population": self.options.cma.population,
            "generations": self.options.cma.max_generations,
            "restarts": self.options.cma.restarts,
            "polish": self.options.gauss_newton,
            "objective": self.objective,
            "held_out": self.options.leave_one_out,
            "rig": None if self.setup is None else self.setup.digest,
        }
        return FitStore(self.folder, self.name, header)


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Where each fit stands: generations done and best cost so far by name, and what has ended."""

    generations: dict[str, int]
    best: dict[str, float]
    ended: dict[str, Calibration]
    total: int


def run(
    tasks: Sequence[Task], *, workers: int, told: Callable[[Progress], None] = lambda _: None
) -> list[Calibration]:
    """Fit all tasks; those already on disk are read. Results in the order of the tasks.

    A KeyboardInterrupt stops all workers; what their searches had found stays on disk (`stopped` reads it).
    InputError where a fit on disk is of other data or options.
    """
    ended: dict[str, Calibration] = {}
    for task in tasks:
        task.folder.mkdir(parents=True, exist_ok=True)
        found = task.store().result()
        task.store().history()  # refuses another study's before anything is computed
        if found is not None:
            ended[task.name] = found
    waiting = [t for t in tasks if t.name not in ended]
    if waiting:
        _run(waiting, workers, ended, len(tasks), told)
    return [ended[t.name] for t in tasks]


def _run(
    waiting: list[Task],
    workers: int,
    ended: dict[str, Calibration],
    total: int,
    told: Callable[[Progress], None],
) -> None:
    if min(workers, len(waiting)) == 1:
        for task in waiting:
            show = partial(_show, waiting, ended, total, told)
            show()
            ended[task.name] = fit_task(task, workers=workers, watch=show)
            show()
        return
    # each fit alone on one core: BLAS threads that spin while they wait cost a factor
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
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
            told(_progress(waiting, ended, total))
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def _show(
    waiting: list[Task], ended: dict[str, Calibration], total: int, told: Callable[[Progress], None]
) -> None:
    told(_progress(waiting, ended, total))


def fit_task(task: Task, *, workers: int | None, watch: Callable[[], None] = lambda: None) -> Calibration:
    """One fit, going on from its history, written down when it ends; watch is called each generation."""
    store = task.store()
    experiment = OnSetup.of(read(task.experiment), task.setup)

    def told(generation: Generation) -> None:
        if not generation.replayed:
            store.append(generation)
        watch()

    result = calibrate(
        parametrisation(task.law, terms=task.terms),
        measurements(experiment, task.material, workers=workers, objective=task.objective),
        options=task.options,
        history=store.history(),
        told=told,
    )
    result = _as_asked(result, task)
    store.finish(result)
    return result


def _as_asked(result: Calibration, task: Task) -> Calibration:
    """The result with what was asked for on it."""
    if task.setup is not None:
        note = "; ".join(n for n in (task.setup.sentence, result.note) if n)
        result = replace(result, note=note)
    return replace(result, objective=task.objective)


def _end_with_parent() -> None:
    """Ends this worker when its parent is killed: the next run must find its files left alone."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_watch, args=(parent.sentinel,), daemon=True).start()


def _watch(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


def stopped(tasks: Sequence[Task], experiment: Experiment) -> list[Calibration]:
    """What a stopped study has: finished fits, and the best candidate of each unfinished one."""
    found: list[Calibration] = []
    for task in tasks:
        store = task.store()
        result = store.result()
        if result is None:
            history = [g for g in store.history() if np.isfinite(g.costs).any()]
            if not history:
                continue
            data = measurements(
                OnSetup.of(experiment, task.setup), task.material, workers=1, objective=task.objective
            )
            if data.outlines is not None:
                data.outlines.reference = None
            result = best_so_far(parametrisation(task.law, terms=task.terms), data, history)
            result = _as_asked(result, task)
        found.append(result)
    return found


def _progress(waiting: Sequence[Task], ended: dict[str, Calibration], total: int) -> Progress:
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
    return Progress(generations=generations, best=best, ended=dict(ended), total=total)


def _lines(path: Path) -> list[str]:
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


def _costs(line: str) -> list[float]:
    tail = line.rpartition('"costs": [')[2].rstrip("]}")
    return [float(c) for c in tail.split(",") if c.strip() not in ("", "null")]
