"""Everything a report says of one or more runs, as numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from learn.baselines import BASELINES
from learn.data import MemoryDataset, Split, Store
from learn.errors import InputError
from learn.evaluation.across import Answered, across_folds
from learn.evaluation.cases import cases_of
from learn.evaluation.clouds import cases_on, grid_floor_mm, scattered
from learn.evaluation.intervals import Coverage, Intervals, coverage, fit_intervals, rank_correlation
from learn.evaluation.kept import load_intervals
from learn.evaluation.parts import parts_of
from learn.evaluation.summary import Value, by_softness, over_folds, summarise
from learn.evaluation.symmetry import TurnError, turn_error
from learn.metrics import Cases
from learn.models import Ensemble, pokes_of, scene_of
from learn.training import Recipe, Run

CLOUD_SIZES = (512, 1024, 4096)
_CLOUD_POKES = 6
Say = Callable[[str], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Covered:
    """Intervals of a run and how they did on its test part. radius_mm: mean over points."""

    intervals: Intervals
    found: Coverage
    rank: float
    radius_mm: float


@dataclass(eq=False, kw_only=True)
class Evaluation:
    """What was found. models: names of what was trained, in `folds` beside baselines. tables: by name of a
    model, over folds, by softness. deeper: beyond the trained depth.

    covered, across: by intervals from the run's own validation part, and from the other folds' test parts.
    intervals: the latter where there are any; of which run (or runs together). clouds: by size of the cloud.
    floor_mm: what interpolation of the surface meshes alone is off. cases: of the first run, for pictures.
    """

    runs: list[Run]
    store: Store
    models: list[str] = field(default_factory=list)
    folds: dict[str, list[dict[str, dict[str, Value]]]] = field(default_factory=dict)
    turned: dict[str, TurnError] = field(default_factory=dict)
    turned_flat: dict[str, TurnError] = field(default_factory=dict)
    covered: dict[str, Covered] = field(default_factory=dict)
    across: dict[str, Covered] = field(default_factory=dict)
    intervals: list[tuple[Run, Intervals]] = field(default_factory=list)
    clouds: dict[str, dict[str, Value]] = field(default_factory=dict)
    floor_mm: float = float("nan")
    deeper: dict[str, dict[str, Value]] = field(default_factory=dict)
    cases: Cases | None = None

    @property
    def tables(self) -> dict[str, dict[str, dict[str, Value]]]:
        """Mean over folds, and sd over folds where there is more than one."""
        joined = {}
        for name, folds in self.folds.items():
            levels = [level for level in folds[0] if all(level in fold for fold in folds)]
            joined[name] = {level: over_folds([fold[level] for fold in folds]) for level in levels}
        return joined


def evaluate(
    runs: list[Run],
    store: Store,
    *,
    baselines: bool = True,
    clouds: bool = True,
    ensemble: bool = False,
    say: Say = lambda _text: None,
) -> Evaluation:
    """Answers of every run to its own test part; baselines fitted to each distinct training part.

    ensemble: runs of one model and training part, from different seeds, are evaluated as one as well, before
    they are alone. InputError where no two runs can be joined so. On another dataset than a run was trained
    on (`parts_of`) there are no baselines, and the intervals are those that were kept with the run.
    """
    found = Evaluation(runs=runs, store=store)
    scene = scene_of(store)
    fitted: set[str] = set()
    answers: list[Answered] = []
    joined = ensembles(runs) if ensemble else []
    for run, name in [*joined, *((run, run.recipe.model) for run in runs)]:
        split = parts_of(store, run)
        test = MemoryDataset(store, split.test)
        say(f"{run.folder}: {len(test)} test frames")
        cases = cases_of(run.model, scene, test)
        found.folds.setdefault(name, []).append(by_softness(cases))
        found.models += [name] if name not in found.models else []
        if found.cases is None:
            found.cases = cases
        answers.append(Answered(run, name, cases))
        _look_closer(found, run, name, split, cases, clouds=clouds and not found.clouds)
        key = _part(run.recipe)
        if not baselines or key in fitted or not len(split.train):
            continue
        fitted.add(key)
        train = MemoryDataset(store, split.train)
        for title, kind in BASELINES.items():
            say(f"fitting: {title}")
            baseline = kind()
            baseline.fit(train, scene)
            found.folds.setdefault(title, []).append(by_softness(cases_of(baseline, scene, test)))
    for one, intervals in across_folds([a for a in answers if a.run.uuid == store.uuid]):
        found.across[f"{one.name}, fold {one.run.recipe.fold}"] = _covered(intervals, one.cases)
        found.intervals = [(r, intervals if r is one.run else i) for r, i in found.intervals]
    return found


def ensembles(runs: list[Run]) -> list[tuple[Run, str]]:
    """Runs of one model and training part joined, with a name: each as a run of its first member's folder."""
    groups: dict[str, list[Run]] = {}
    for run in runs:
        groups.setdefault(f"{run.recipe.model} {_part(run.recipe)}", []).append(run)
    joined = [
        (together(group), f"{group[0].recipe.model}, {len(group)} together")
        for group in groups.values()
        if len({run.recipe.seed for run in group}) == len(group) > 1
    ]
    if not joined:
        raise InputError(
            "an ensemble wants two or more runs of one model and training part, each of another seed"
        )
    return joined


def together(runs: list[Run]) -> Run:
    """Runs as one, of the first one's folder."""
    return replace(
        runs[0],
        model=Ensemble([run.model for run in runs]).eval(),
        members=tuple(run.folder for run in runs),
    )


def _part(recipe: Recipe) -> str:
    """What the parts of a store depend on."""
    return repr((recipe.fold, recipe.split, recipe.train_softness, recipe.train_depth_mm))


def _covered(intervals: Intervals, cases: Cases) -> Covered:
    return Covered(
        intervals=intervals,
        found=coverage(intervals, cases),
        rank=rank_correlation(intervals, cases),
        radius_mm=float(intervals.radius_mm(cases).mean()),
    )


def _look_closer(
    found: Evaluation, run: Run, title: str, split: Split, cases: Cases, *, clouds: bool
) -> None:
    """Symmetry, intervals, depth and clouds of one run."""
    store, scene, model = found.store, scene_of(found.store), run.model
    name = f"{title}, fold {run.recipe.fold}"
    name += f", seed {run.recipe.seed}" if name in found.turned else ""
    own = store.uuid == run.uuid
    validation = MemoryDataset(store, split.validation if own else split.test)
    few = pokes_of(validation.__getitems__(np.linspace(0, len(validation) - 1, 8).astype(int)))
    part = scene.only(few.geometry.numpy())
    found.turned[name] = turn_error(model, part, few)
    found.turned_flat[name] = turn_error(model, part, few, about_normal=True)
    intervals: Intervals | None = None
    if not own:
        intervals = load_intervals(run)
    elif len(np.unique((held := cases_of(model, scene, validation)).poke)) >= 2:
        intervals = fit_intervals(held)
    if intervals is not None:
        found.intervals.append((run, intervals))
        found.covered[name] = _covered(intervals, cases)
    if run.recipe.train_depth_mm is not None:
        limit = run.recipe.train_depth_mm * 1e-3
        found.deeper[f"{name}, to {run.recipe.train_depth_mm:g} mm"] = summarise(
            cases.where(cases.depth <= limit)
        )
        if bool((cases.depth > limit).any()):
            found.deeper[f"{name}, deeper"] = summarise(cases.where(cases.depth > limit))
    if clouds:
        pokes = np.unique(store.frame_poke[split.test])
        pokes = pokes[np.linspace(0, len(pokes) - 1, min(_CLOUD_POKES, len(pokes))).astype(int)]
        rows = split.test[np.isin(store.frame_poke[split.test], pokes)]
        found.clouds["1024, the grid"] = summarise(cases_on(model, store, rows, store.points))
        for size in CLOUD_SIZES:
            found.clouds[f"{size}, scattered"] = summarise(
                cases_on(model, store, rows, scattered(store, size))
            )
        found.floor_mm = grid_floor_mm(store, rows)
