"""A study on disk: every material against every law, two processes or more, resumable at any moment."""

from __future__ import annotations

import contextlib
import hashlib
import logging
import multiprocessing
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, fields, is_dataclass, replace
from multiprocessing import connection
from pathlib import Path
from typing import Any

import numpy as np

from calibration.errors import InputError
from calibration.experiment import Experiment
from calibration.inference import Generation, HistoryError
from calibration.measurements._kinds import Kind, compared, is_added
from calibration.measurements.outlines.setup import Setup
from calibration.parameters import (
    added_coordinates,
    is_added_part,
    is_series,
    parametrisation,
    part_kind,
)
from calibration.progress import FitProgress, OnProgress
from calibration.study import parts
from calibration.study._store import FitStore, locked
from calibration.study.calibrate import FitOptions, best_so_far, calibrate
from calibration.study.calibration import Calibration
from calibration.study.measurements import Measurements, ObjectiveName, OnSetup, measurements
from calibration.study.parts import CardParts
from tisim import laws
from tisim.parallel.extensions import digest_of_code, is_own

log = logging.getLogger(__name__)

# Raised whenever the objective or the search changes: their histories would not fit together.
FORMAT = 10


@dataclass(frozen=True, kw_only=True)
class Task:
    """One fit of a study.

    Attributes
    ----------
    experiment : Experiment
        As it was read, or as the caller changed it: trials left out, rows cut.
    material, law : str
    terms : int
        Of a series law.
    options : FitOptions
    folder : Path
        Where the fit is kept while it runs and when it has ended.
    objective : str
        "likelihood" or "dice".
    setup : Setup, optional
        What is known of rig and camera.
    setup_file : str
        Where it was read from, for the command that repeats the fit.
    parts : tuple of str
        What the material has beside the law (`calibration.study.parts`).
    free_bulk_ratio : bool
        K/G is found by photographs, and not held.
    card : CardParts, optional
        Of the material: parts that are held, or begin the search.
    """

    experiment: Experiment
    material: str
    law: str
    terms: int
    options: FitOptions
    folder: Path
    objective: ObjectiveName = "likelihood"
    setup: Setup | None = None
    setup_file: str = ""
    parts: tuple[str, ...] = ()
    free_bulk_ratio: bool = False
    card: CardParts | None = None

    @property
    def label(self) -> str:
        return parts.label(parametrisation(self.law, terms=self.terms).label, self.parts, self.card)

    @property
    def alternatives(self) -> list[Task]:
        """Fits among which the data choose; itself where there is no choice."""
        return [replace(self, parts=specs) for specs in parts.alternatives(self.parts)]

    @property
    def name(self) -> str:
        return f"{self.material}-{self.label}"

    @property
    def added_kinds(self) -> list[Kind]:
        """Kinds of measurement from outside the package whose trials it fits."""
        mine = [t for t in self.experiment.trials if t.material == self.material]
        found = compared(replace(self.experiment, trials=tuple(mine)))
        return [kind for kind, _ in found if is_added(kind)]

    @property
    def is_added(self) -> bool:
        """True if it needs something from outside the package, which other processes may not know."""
        law = laws.added(self.law) is not None or added_coordinates(self.law) is not None
        return law or any(map(is_added_part, self.parts)) or bool(self.added_kinds)

    def measurements(self, experiment: Experiment, *, workers: int | None) -> Measurements:
        """Measurement models of the experiment that it fits."""
        law = parts.with_parts(
            parametrisation(self.law, terms=self.terms), self.parts, experiment, self.material, self.card
        )
        return measurements(
            experiment,
            self.material,
            law,
            workers=workers,
            objective=self.objective,
            free_bulk_ratio=self.free_bulk_ratio,
        )

    def store(self) -> FitStore:
        header: dict[str, Any] = {
            "format": FORMAT,
            "data": self.experiment.digest,
            "trials": _content(self.experiment),
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
        if self.parts:
            header["parts"] = list(self.parts)
        added = laws.added(self.law)
        own = [*(() if added is None else vars(added).values()), *(part_kind(s).make for s in self.parts)]
        own += [added_coordinates(self.law)]
        own += [kind.load for kind in self.added_kinds]
        if any(callable(thing) and not is_own(thing) for thing in own):
            header["code"] = digest_of_code(*own)
        if self.card is not None:
            header["start"] = self.card.path
            header["card"] = self.card.content
        if self.free_bulk_ratio:
            header["free_bulk_ratio"] = True
        if self.setup_file:
            header["rig_file"] = self.setup_file
        return FitStore(self.folder, self.name, header)


def tasks_for(
    experiment: Experiment,
    *,
    law_names: Sequence[str],
    materials: Sequence[str],
    folder: Path,
    options: FitOptions | None = None,
    terms: int = 1,
    objective: ObjectiveName = "likelihood",
    setup: Setup | None = None,
    setup_file: str = "",
    specs: Sequence[str] = (),
    free_bulk_ratio: bool = False,
    cards: Mapping[str, parts.CardParts] | None = None,
) -> list[Task]:
    """Every law for every material, law by law, in the order given; specs : of parts beside each law; cards :
    by material, whose parts are held or begin the search."""
    return [
        Task(
            experiment=experiment,
            material=material,
            law=law,
            terms=terms if is_series(law) else 1,
            options=options or FitOptions(),
            folder=folder,
            objective=objective,
            setup=setup,
            setup_file=setup_file,
            parts=tuple(specs),
            free_bulk_ratio=free_bulk_ratio,
            card=(cards or {}).get(material),
        )
        for law in law_names
        for material in materials
    ]


def by_cost(names: Sequence[str]) -> list[str]:
    """Laws in the order in which fits of all are useful soonest: few constants first, and last the law that
    has no equilibrium in many trials and needs most steps in the others."""
    return sorted(
        names,
        key=lambda n: (n == "st-venant-kirchhoff", len(parametrisation(n).coordinates), n != "neo-hookean"),
    )


def _content(experiment: Experiment) -> str:
    """sha256 of trials and materials as they are fitted, which may be fewer than the files hold."""
    total = hashlib.sha256()

    def add(value: Any) -> None:
        if is_dataclass(value) and not isinstance(value, type):
            add([(f.name, getattr(value, f.name)) for f in fields(value)])
        elif isinstance(value, np.ndarray):
            total.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
        elif isinstance(value, Mapping):
            add(list(value.items()))
        elif isinstance(value, list | tuple):
            total.update(f"({len(value)}".encode())
            for part in value:
                add(part)
        elif isinstance(value, Path):  # of a photograph; its content counts in the experiment's digest
            add(value.name)
        else:
            total.update(f"{type(value).__name__}:{value!r};".encode())

    add([experiment.materials, experiment.trials])
    return total.hexdigest()


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
        result = parts.choose(found)
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
            result = parts.choose(ended)
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
