"""A study of fits from its arguments: checked before anything is computed, then run or shown as stopped.

`calibration.fit` and the command of that name have this plan.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from calibration._files import check_no_experiment, on_any_disk
from calibration.errors import InputError, OptionError
from calibration.experiment import BeamTrial, Experiment, read
from calibration.fit_request import FitRequest
from calibration.parameters import is_series
from calibration.progress import OnProgress
from calibration.results import Fits
from tisim import laws
from tisim.parallel.pool import cores

if TYPE_CHECKING:
    from calibration.diagnosis.rig import Rig
    from calibration.study import Task
    from calibration.study.parts import CardParts


@dataclass(frozen=True, kw_only=True)
class FitPlan:
    """Fits that are asked for, checked and ready to run.

    Attributes
    ----------
    tasks : list of Task
    experiment : Experiment
        The experiment, with the rig's corrections if a rig was given.
    folder : Path
    workers : int
    rig : Rig, optional
    """

    tasks: list[Task]
    experiment: Experiment
    folder: Path
    workers: int
    rig: Rig | None = None

    def run(self, on_progress: OnProgress) -> Fits:
        """Make the fits that are missing; an exception leaves what was found on disk."""
        from calibration.study import run

        found = run(self.tasks, workers=self.workers, on_progress=on_progress)
        return Fits(tuple(found), self.experiment, self.folder)

    def stopped(self) -> Fits:
        """Finished fits, and the best candidate of each unfinished one."""
        from calibration.study import stopped

        return Fits(tuple(stopped(self.tasks, self.experiment)), self.experiment, self.folder)

    def with_earlier(self, found: Fits) -> Fits:
        """These fits, followed by those to the same data that earlier runs have finished in the folder.

        One card and one report then have all laws.
        """
        from calibration.study import finished

        own = {own.name for task in self.tasks for own in (task, *task.alternatives)}
        earlier = finished(self.folder / "fits", self.tasks[0].store().header, without=own)
        earlier = [r for r in earlier if r.law in laws.names()]
        return Fits((*found.results, *earlier), self.experiment, self.folder)


def plan_fit(experiment: str | Path | Experiment, request: FitRequest) -> FitPlan:
    """The checked plan of a fit: makes its folder, removes earlier results where asked, computes nothing."""
    from calibration.inference import CmaOptions
    from calibration.study import FitOptions, OnSetup, parts, tasks_for

    data = experiment if isinstance(experiment, Experiment) else read(Path(experiment))
    names = law_names(request.model)
    if not 1 <= request.terms <= 3:
        raise OptionError("terms", request.terms, "expected 1 to 3")
    if request.terms > 1 and not any(map(is_series, names)):
        raise OptionError("terms", request.terms, f"expected a law that is a series, got {', '.join(names)}")
    objective = request.objective
    if objective not in ("likelihood", "dice"):
        raise OptionError("objective", objective, "expected likelihood or dice")
    wanted = _materials(request.materials, data)
    specs = parts.asked(time=request.time, damage=request.damage, fibres="fibres" if request.fibres else None)
    if specs and objective != "likelihood":
        raise OptionError(
            parts.option_of(specs[0]),
            specs[0],
            "expected --objective likelihood, overlaps of bodies have no time",
        )
    cards = _starts(request.start, wanted, objective)
    parts.check(data, wanted, specs, cards)
    if request.free_bulk_ratio:
        _check_seen(data, wanted, objective)
    setup = known_rig(request.rig, data, wanted, objective=objective)
    folder = Path(request.out)
    options = FitOptions(
        cma=CmaOptions(
            seed=request.seed,
            population=request.population,
            max_generations=request.generations,
            restarts=request.restarts,
        ),
        gauss_newton=request.polish and objective == "likelihood",  # Dice is not smooth where it is best
        leave_one_out=request.held_out,
    )
    count = processes(request.workers)
    _check_folder(folder)
    tasks = tasks_for(
        data,
        law_names=names,
        materials=wanted,
        folder=folder / "fits",
        options=options,
        terms=request.terms,
        objective="likelihood" if objective == "likelihood" else "dice",
        setup=setup,
        setup_file="" if request.rig is None else str(request.rig),
        specs=specs,
        free_bulk_ratio=request.free_bulk_ratio,
        cards=cards,
    )
    _check_names(tasks)
    if request.overwrite:
        _remove_earlier(tasks, folder)
    return FitPlan(tasks=tasks, experiment=OnSetup.of(data, setup), folder=folder, workers=count, rig=setup)


def names_of(value: str | Sequence[str]) -> list[str]:
    """Names as a list or as a text with commas, without empty ones."""
    names = [n.strip() for n in value.split(",")] if isinstance(value, str) else list(value)
    return [n for n in names if n]


def law_names(model: str | Sequence[str]) -> list[str]:
    """Names of laws, each once; "all" for every law, those that are useful soonest first.

    Raises
    ------
    InputError
        One is not known, or there is none.
    """
    from calibration.study import by_cost

    if model == "all":
        return by_cost(laws.names())
    names = names_of(model)
    for name in names:
        if name not in laws.names():
            raise OptionError("model", name, f"expected all or some of {', '.join(laws.names())}")
    if not names:
        raise OptionError("model", None, "expected at least one law")
    return list(dict.fromkeys(names))


def processes(workers: int | None) -> int:
    """The number of processes; InputError where it is less than 1."""
    if workers is not None and workers < 1:
        raise OptionError("workers", workers, "expected 1 or more")
    return workers or cores()


def _materials(asked: str | Sequence[str] | None, data: Experiment) -> list[str]:
    used = {t.material for t in data.trials}
    if asked is None:
        return [m for m in data.materials if m in used]
    wanted = names_of(asked)
    if not wanted:
        raise OptionError("material", None, f"expected some of {', '.join(sorted(used))}, got none")
    for name in wanted:
        if name not in used:
            raise OptionError("material", name, f"expected some of {', '.join(sorted(used))}")
    return list(dict.fromkeys(wanted))


def _check_seen(data: Experiment, materials: Sequence[str], objective: str) -> None:
    """Refuse a free K/G where the fit has no outlines, which alone show it."""
    if objective != "likelihood":
        raise OptionError(
            "free_bulk_ratio", None, f"expected --objective likelihood, with {objective} K/G is held"
        )
    if not any(isinstance(t, BeamTrial) and t.traced and t.material in materials for t in data.trials):
        raise OptionError(
            "free_bulk_ratio",
            None,
            f"expected traced photographs of beams of {', '.join(materials)}, nothing else shows K/G",
        )


def known_rig(
    path: str | Path | None, data: Experiment, materials: Sequence[str], *, objective: str = "likelihood"
) -> Rig | None:
    """The corrections of a rig file; None without a file. InputError where fits of these materials cannot be
    corrected by it."""
    if path is None:
        return None
    if objective != "likelihood":
        raise OptionError("rig", path, "expected --objective likelihood, overlaps of bodies know no rig")
    marked = [t.id for t in data.trials if isinstance(t, BeamTrial) and t.material in materials and t.markers]
    if marked:
        raise OptionError(
            "rig",
            path,
            f"corrects outlines, not markers: expected none, but trial {marked[0]} has some",
        )
    from calibration.diagnosis.rig import read_rig

    return read_rig(Path(path)).on(data)


def _starts(path: str | Path | None, materials: list[str], objective: str) -> dict[str, CardParts]:
    """Parts of cards, by the material that takes them: one card goes to the one material that is fitted,
    cards of a folder by their names."""
    if path is None:
        return {}
    if objective != "likelihood":
        raise OptionError("start", path, "expected --objective likelihood, overlaps of bodies have no time")
    from calibration.prediction._cards import read_cards
    from calibration.study.parts import CardParts

    known = read_cards(Path(path))
    if len(known) == 1 == len(materials):
        known = {materials[0]: next(iter(known.values()))}
    found = {}
    for material in materials:
        if material not in known:
            raise OptionError("start", path, f"expected a card of {material}, found {', '.join(known)}")
        card = known[material]
        own = card.parts()
        if not own:
            raise OptionError(
                "start", path, f"expected viscosity, softening or fibres in the card of {card.material}"
            )
        found[material] = CardParts(f"the card of {card.material}", own, str(Path(path).resolve()))
    return found


def _check_folder(folder: Path) -> None:
    """Refuse a folder that holds something else."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: expected a folder to write to")
    check_no_experiment(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: expected a folder that can be written to")


def _check_names(tasks: Sequence[Task]) -> None:
    """Refuse fits of two materials that would have one file: "gel" and "gel-stable" of two laws."""
    made: dict[str, Task] = {}
    for task in tasks:
        other = made.setdefault(on_any_disk(task.name), task)
        if other is not task and other.material != task.material:
            raise InputError(
                f"materials {other.material} and {task.material}: expected names that tell their fits apart,"
                f" both have one {task.name}: fit them into two folders (--material, --out)"
            )


def _remove_earlier(tasks: Sequence[Task], folder: Path) -> None:
    """Remove the results of these fits, and of no others."""
    from calibration.study import remove_fits

    if (folder / "fits").is_dir():
        remove_fits(folder / "fits", {own.name for task in tasks for own in (task, *task.alternatives)})
