"""Numbers of a report on one or more runs: metrics on test parts, baselines, intervals."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray

from learn.baselines import BASELINES
from learn.data import MemoryDataset, Split, Store
from learn.data.clouds import SurfaceField, scattered
from learn.data.loaders import without_fields
from learn.errors import InputError
from learn.evaluation.cross_conformal import Predicted, across_folds, inside_alone
from learn.evaluation.ensembles import ensembles, names_of
from learn.evaluation.intervals import (
    LEAST_POKES,
    Coverage,
    Intervals,
    coverage,
    fit_intervals,
    force_fault,
    rank_correlation,
    too_few,
)
from learn.evaluation.intervals_file import load_intervals
from learn.evaluation.new_to_run import parts_of, trained_on
from learn.evaluation.predictions import (
    Cloud,
    SymmetryError,
    interpolation_error_mm,
    predict_on,
    predict_part,
    symmetry_error,
)
from learn.evaluation.summary import (
    Outside,
    Row,
    by_cover,
    by_depth,
    by_distance,
    by_softness,
    over_folds,
    summarise,
)
from learn.metrics import Predictions
from learn.models import Scenes, pokes_of
from learn.progress import OnProgress, Progress, ignore
from learn.training import Recipe, Run, known_domain
from learn.validity import frame_distances

CLOUD_SIZES = (512, 1024, 4096)
CLOUD_SEEDS = 3  # clouds of each size, since one cloud has a single point near the tip
_CLOUD_POKES = 6
Floats = NDArray[np.float64]
log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False, kw_only=True)
class Covered:
    """Intervals of a run, with their coverage, rank correlation and mean radius on its test part."""

    intervals: Intervals
    found: Coverage
    rank: float
    radius_mm: float


@dataclass(eq=False, kw_only=True)
class Evaluation:
    """Results of `evaluate`.

    Attributes
    ----------
    runs, store : the evaluated runs, and the dataset that they are evaluated on.
    device : device on which the models predict.
    models : names of the trained models; `folds` also has the baselines.
    folds : metrics by softness level: by name, one entry per fold.
    frames, pokes : numbers of different frames and pokes in the test parts.
    symmetry, symmetry_vertical : symmetry errors by run, for random motions, and for quarter turns about the
        vertical.
    covered, across : coverage of intervals from the run's own validation part, and from the other folds.
    no_intervals : reason why a run has no intervals, by run.
    intervals : intervals of each run (or ensemble), from the other folds if there are enough.
    by_name : folders of runs on another dataset, whose own is not where it was, so that shapes were
        identified by their names.
    clouds : metrics by point cloud; interpolation_mm: error of their interpolated truth [mm].
    depths, covers : metrics by model and band of depth, and of cover over the inclusion below the contact;
        one entry per fold.
    deeper : metrics up to and beyond the depth that was trained on.
    outside : errors by run and distance from the trained ranges, on a dataset other than the training one.
    predictions : predictions of the first run (or ensemble), for pictures.
    """

    runs: list[Run]
    store: Store
    device: torch.device
    models: list[str] = field(default_factory=list)
    folds: dict[str, list[dict[str, Row]]] = field(default_factory=dict)
    frames: int = 0
    pokes: int = 0
    symmetry: dict[str, SymmetryError] = field(default_factory=dict)
    symmetry_vertical: dict[str, SymmetryError] = field(default_factory=dict)
    covered: dict[str, Covered] = field(default_factory=dict)
    across: dict[str, Covered] = field(default_factory=dict)
    no_intervals: dict[str, str] = field(default_factory=dict)
    by_name: list[str] = field(default_factory=list)
    intervals: list[tuple[Run, Intervals]] = field(default_factory=list)
    clouds: dict[str, Row] = field(default_factory=dict)
    interpolation_mm: float = float("nan")
    depths: dict[str, list[Row]] = field(default_factory=dict)
    covers: dict[str, list[Row]] = field(default_factory=dict)
    deeper: dict[str, Row] = field(default_factory=dict)
    outside: dict[str, Outside] = field(default_factory=dict)
    predictions: Predictions | None = None

    @property
    def tables(self) -> dict[str, dict[str, Row]]:
        """Mean and standard deviation over folds; for a single fold, its own values (`over_folds`)."""
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
    device: torch.device | str = "cpu",
    on_progress: OnProgress = ignore,
) -> Evaluation:
    """Evaluate every run on its own test part, with baselines fitted to each distinct training part.

    Parameters
    ----------
    runs, store : runs to evaluate, and the dataset. On a dataset other than the training one (`parts_of`)
        there are no baselines, and the intervals are those saved with the run.
    baselines, clouds : fit baselines; predict on other point clouds.
    ensemble : also evaluate runs that differ in seed alone as an ensemble (`ensembles`), before the single
        runs.
    device : device on which the models predict; baselines run on the CPU, to which the models return.
    on_progress : called before each step.

    Raises
    ------
    InputError
        If a run is given twice, does not fit the dataset, or predicts what is not finite, or with `ensemble`
        no two can be joined.
    """
    _check_once(runs)
    found = Evaluation(runs=runs, store=store, device=torch.device(device))
    here = Scenes.of(store)
    scenes = here.to(found.device)
    fitted: set[str] = set()
    predicted: list[Predicted] = []
    tested = np.zeros(store.frames, dtype=bool)
    joined = ensembles(runs) if ensemble else []
    every = [*joined, *zip(runs, names_of(runs), strict=True)]
    steps = _Steps(len(every) + (len(BASELINES) if baselines else 0), on_progress)
    for run, name in every:
        split = parts_of(store, run)
        test = MemoryDataset(store, split.test)
        steps.next(f"{run.folder}: {len(test)} test frames")
        run.model.to(found.device)
        predictions = predict_part(run.model, scenes, test)
        _check_finite(run, predictions)
        found.folds.setdefault(name, []).append(by_softness(predictions))
        found.models += [name] if name not in found.models else []
        tested[split.test] = True
        if found.predictions is None:
            found.predictions = predictions
        for bands, rows in ((found.depths, by_depth(predictions)), (found.covers, by_cover(predictions))):
            for band, row in rows.items():
                bands.setdefault(f"{name}, {band}", []).append(row)
        validation = _validation(run, store, scenes, split)
        distance = _distance(run, store, predictions)
        calibrating = None if validation is None or _fault(validation) else validation
        predicted.append(Predicted(run, name, predictions, distance, calibrating))
        _look_closer(found, predicted[-1], scenes, split, validation, clouds=clouds and not found.clouds)
        run.model.cpu()
        key = _part(run.recipe)
        if not baselines or key in fitted or not len(split.train):
            continue
        fitted.add(key)
        train = MemoryDataset(store, split.train)
        for title, kind in BASELINES.items():
            steps.next(f"fitting: {title}")
            baseline = kind()
            baseline.fit(train, here)
            found.folds.setdefault(title, []).append(by_softness(predict_part(baseline, here, test)))
    found.by_name = [str(r.folder) for r in runs if r.uuid != store.uuid and trained_on(r) is None]
    found.frames, found.pokes = int(tested.sum()), len(np.unique(store.frame_poke[tested]))
    own = [p for p in predicted if p.run.uuid == store.uuid]
    for one, intervals in across_folds(own, copies=store.copies):
        found.across[f"{one.name}, fold {one.run.recipe.fold}"] = _covered(intervals, one)
        found.intervals = [(r, i) for r, i in found.intervals if r is not one.run] + [(one.run, intervals)]
    return found


class _Steps:
    """Counter of steps for the callback and the log."""

    def __init__(self, total: int, on_progress: OnProgress) -> None:
        self._done, self._total, self._on_progress = 0, total, on_progress

    def next(self, text: str) -> None:
        log.info(text)
        total = max(self._total, self._done + 1)
        self._on_progress(Progress(stage="evaluation", done=self._done, total=total, text=text))
        self._done += 1


def _check_once(runs: list[Run]) -> None:
    """Raise InputError if a run is given twice: it would count as two, with a spread of zero."""
    places = [run.folder.resolve() for run in runs]
    for run, place in zip(runs, places, strict=True):
        if places.count(place) > 1:
            raise InputError(f"{run.folder}: given twice, expected each run once")


def _check_finite(run: Run, predictions: Predictions) -> None:
    """Raise InputError if a prediction is not finite: the means of the tables would leave such frames out."""
    good = np.isfinite(predictions.predicted).all(axis=(1, 2)) & np.isfinite(predictions.force_predicted)
    if not good.all():
        why = " (a member's force may be 0 N or less, which has no geometric mean)" if run.members else ""
        which = ", ".join(map(str, run.members or [run.folder]))
        raise InputError(
            f"{which}: the answer to {int((~good).sum())} of {len(good)} frames, the first of poke"
            f" {int(predictions.poke[~good][0])}, is not finite{why}: train for more epochs"
        )


def _part(recipe: Recipe) -> str:
    """Text of the recipe's keys on which the parts of a store depend."""
    return repr((recipe.fold, recipe.split, recipe.train_softness, recipe.train_depth_mm))


def _distance(run: Run, store: Store, predictions: Predictions) -> Floats:
    """Distance of frames from the run's trained ranges (f,); 0 if these are not known."""
    domain = known_domain(run, store)
    if domain is None:
        return np.zeros(len(predictions.depth))
    return frame_distances(domain, store, predictions.poke, predictions.depth, predictions.clock)


def _covered(intervals: Intervals, one: Predicted) -> Covered:
    """Coverage of intervals as they are stated, widened outside the trained ranges."""
    return Covered(
        intervals=intervals,
        found=coverage(intervals, one.predictions, distance=one.distance),
        rank=rank_correlation(intervals, one.predictions, distance=one.distance),
        radius_mm=float(intervals.radius_mm(one.predictions, distance=one.distance).mean()),
    )


def _look_closer(
    found: Evaluation,
    one: Predicted,
    scenes: Scenes,
    split: Split,
    validation: Predictions | None,
    *,
    clouds: bool,
) -> None:
    """Add symmetry, intervals, depth and clouds of one run; `scenes` are on the model's device."""
    run, title, predictions = one.run, one.name, one.predictions
    store, model = found.store, run.model
    name = f"{title}, fold {run.recipe.fold}"
    name += f", seed {run.recipe.seed}" if name in found.symmetry else ""
    own = store.uuid == run.uuid
    rows = split.validation if own else split.test
    few = pokes_of(without_fields(store, rows[np.linspace(0, len(rows) - 1, 8).astype(int)]))
    part = scenes.only(few.geometry.numpy())
    found.symmetry[name] = symmetry_error(model, part, few)
    found.symmetry_vertical[name] = symmetry_error(model, part, few, about_normal=True)
    intervals = _own_intervals(found, run, name, validation)
    if intervals is not None:
        found.intervals.append((run, intervals))
        found.covered[name] = _covered(intervals, one)
    if not own and run.domain is not None:
        for band, row in by_distance(predictions, one.distance, intervals).items():
            found.outside[f"{name}, {band}"] = row
    if run.recipe.train_depth_mm is not None:
        limit = run.recipe.train_depth_mm * 1e-3
        found.deeper[f"{name}, to {run.recipe.train_depth_mm:g} mm"] = summarise(
            predictions.where(predictions.depth <= limit)
        )
        if bool((predictions.depth > limit).any()):
            found.deeper[f"{name}, deeper"] = summarise(predictions.where(predictions.depth > limit))
    if clouds:
        _clouds(found, run, split)


def _validation(run: Run, store: Store, scenes: Scenes, split: Split) -> Predictions | None:
    """Predictions of the validation part that calibrate; None for a run of another dataset."""
    if store.uuid != run.uuid:
        return None
    found = predict_part(run.model, scenes, MemoryDataset(store, split.validation))
    return inside_alone(found, _distance(run, store, found))


def _fault(validation: Predictions) -> str | None:
    """Sentence stating why these predictions cannot calibrate; None if they can."""
    return too_few(validation.pokes) if validation.pokes < LEAST_POKES else force_fault(validation)


def _own_intervals(
    found: Evaluation, run: Run, name: str, validation: Predictions | None
) -> Intervals | None:
    """Intervals from the validation part, or those saved with a run of another dataset; None if none."""
    if validation is None:
        kept = load_intervals(run)
        if kept is None:
            found.no_intervals[name] = f"{run.folder} has no intervals of its own dataset yet"
        return kept
    fault = _fault(validation)
    if fault is not None:
        found.no_intervals[name] = fault
        return None
    return fit_intervals(validation)


def _clouds(found: Evaluation, run: Run, split: Split) -> None:
    store = found.store
    pokes = np.unique(store.frame_poke[split.test])
    pokes = pokes[np.linspace(0, len(pokes) - 1, min(_CLOUD_POKES, len(pokes))).astype(int)]
    rows = split.test[np.isin(store.frame_poke[split.test], pokes)]
    surfaces = SurfaceField(store, pokes.tolist())

    def errors_on(cloud: Cloud) -> Row:
        return summarise(predict_on(run.model, store, rows, cloud, surfaces, device=found.device))

    found.clouds["1024, the grid"] = errors_on(lambda setup: setup.points)
    for size in CLOUD_SIZES:
        each = [errors_on(partial(scattered, count=size, seed=seed)) for seed in range(CLOUD_SEEDS)]
        found.clouds[f"{size}, scattered"] = over_folds(each)
    found.interpolation_mm = interpolation_error_mm(store, rows)
