"""Adapt a trained run to bodies of one's own, from a few simulated pokes of them.

A surrogate that was trained on many shapes is less accurate on a body with an inclusion, a material law, an
indenter or a block that it has not seen. Some ten simulated pokes of that body, minutes of simulation, adapt
it: the network is fine-tuned on them (`learn.training.fine_tuning`), and its intervals are calibrated for
this body.

Few pokes cannot spare a test part. The errors are therefore those of cross-validation: the contact points are
divided into parts, and the pokes of each part are predicted by networks that were fine-tuned on the others.
The network that is kept is fine-tuned on all of them, for the number of epochs with the least errors there:
none where the run is right already. (The choice among a few numbers makes these errors a little too small.)
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import MemoryDataset, Store, contact_points
from learn.data.folds import frames_once
from learn.errors import InputError
from learn.evaluation.intervals import Intervals, fit_intervals, force_fault, recalibrated
from learn.evaluation.intervals_file import load_intervals, save_intervals
from learn.evaluation.pictures import draw_adaptation
from learn.evaluation.predictions import predict_part
from learn.evaluation.summary import Row, summarise
from learn.metrics import Predictions, join_predictions
from learn.models import MODELS, Model
from learn.progress import OnProgress, Progress, ignore
from learn.training import Recipe, Run, known_domain, load_run
from learn.training.fine_tuning import FineTuning, Tuned
from learn.training.recipe import check_recipe
from learn.training.run_dataset import save_tables
from learn.training.run_folder import BEST, check_free, save_checkpoint, write_whole
from learn.validity import Domain, domain_of

PARTS = 5  # of the cross-validation
LEAST_POINTS = 3
# quantities of the contact, not of the body: their trained ranges stay those of the run as well
OF_CONTACT = ("angle_deg", "cover_mm", "depth_over_cover", "site_to_side_mm")
# What differs from the recipe of the run (studies/learning/own-body.md).
CHANGES: dict[str, Any] = {
    "name": "adapt",
    "split": "site",
    "fold": 0,
    "train_softness": None,
    "train_depth_mm": None,
    "epochs": 16,
    "batch": 16,
    "optimiser": "adam",
    "learning_rate": 3e-4,
    "schedule": "constant",
    "warmup": 0.0,
    "ema_decay": 0.95,
    "data": "memory",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Adaptation:
    """A run adapted to the pokes of another dataset.

    Attributes
    ----------
    run, store, recipe : the run that was begun from, the dataset, and the recipe of the fine-tuning.
    rows : the frames that were used, of the store.
    points : number of their contact points.
    before : predictions of these frames by the run as it was.
    after : predictions by networks that were fine-tuned on the other parts of the cross-validation, for
        `epochs`; `before` if these are None.
    kept : the network that is kept.
    epochs : number of epochs that it was fine-tuned; 0 if only the unit of the force was corrected, None if
        it is the run's own.
    intervals : intervals for the dataset's bodies; None if a force was predicted to be 0 N or less.
    """

    run: Run
    store: Store
    recipe: Recipe
    rows: NDArray[np.int64]
    points: int
    before: Predictions
    after: Predictions
    kept: Tuned
    epochs: int | None
    intervals: Intervals | None

    @property
    def rows_of_table(self) -> dict[str, Row]:
        """Metrics before and after."""
        return {"as trained": summarise(self.before), "adapted": summarise(self.after)}

    @property
    def domain(self) -> Domain:
        """Domain of validity: of indenter, block, inclusion, law and depth that of the pokes.

        Of where and at which angle the body is indented it is that of the run as well: few pokes leave much
        of these ranges out, and the network has learned them.
        """
        own = domain_of(self.store, self.rows)
        known = known_domain(self.run, self.store)
        if known is None:
            return own
        wider = {key: known.ranges[key] for key in OF_CONTACT if key in known.ranges and key in own.ranges}
        hull = {
            key: (min(low, own.ranges[key][0]), max(high, own.ranges[key][1]))
            for key, (low, high) in wider.items()
        }
        return own.model_copy(update={"ranges": {**own.ranges, **hull}})

    @property
    def verdict(self) -> str:
        """One sentence: what the fine-tuning gave on contact points that it was not given."""
        was, now = self.rows_of_table.values()
        mean, force = was["mean"].mean, was["rel force"].mean
        if self.epochs is None:
            return (
                "fine-tuning gains nothing at contact points left out: the run's own network is kept (mean"
                f" error {mean:.3g} mm, force error {force:.1%})"
            )
        passes = "1 epoch" if self.epochs == 1 else f"{self.epochs} epochs"
        how = f"fine-tuned for {passes}" if self.epochs else "only the unit of the force is corrected"
        most = self.recipe.epochs
        more = f"; it was the largest number tried, and --epochs {2 * most} may gain more"
        hint = more if self.epochs and self.epochs == most else ""
        return (
            f"{how}: at contact points left out mean error {mean:.3g} -> {now['mean'].mean:.3g} mm, force"
            f" error {force:.1%} -> {now['rel force'].mean:.1%}{hint}"
        )

    @property
    def interval_text(self) -> str:
        """One sentence on the intervals."""
        if self.intervals is None:
            return "no intervals: a force was predicted to be 0 N or less"
        level, promised, pokes = self.intervals.level, self.intervals.promised, self.intervals.pokes
        few = f", few enough that only {promised:.0%} can be promised" if promised < level else ""
        return f"{level:.0%} intervals of these bodies, calibrated on {pokes} pokes{few}"

    def save(self, folder: Path | str) -> None:
        """Write a run's folder: best.pt, intervals.json, adaptation.json, adaptation.png.

        Raises
        ------
        InputError
            If there is a run already.
        OSError
            If a file cannot be written.
        """
        place = Path(folder)
        check_free(place)
        place.mkdir(parents=True, exist_ok=True)
        write_whole(place / "adaptation.json", (json.dumps(self.as_dict(), indent=1) + "\n").encode())
        draw_adaptation(self.before, self.after).savefig(place / "adaptation.png", dpi=120)
        save_tables(place, self.store)
        save_checkpoint(place / BEST, self._content())
        if self.intervals is not None:
            save_intervals(load_run(place), self.intervals)

    def as_dict(self) -> dict[str, Any]:
        """Content of adaptation.json."""
        return {
            "run": str(self.run.folder),
            "dataset": self.store.location,
            "contact_points": self.points,
            "frames": len(self.rows),
            "epochs": self.epochs,
            "metrics": {
                name: {key: value.mean for key, value in row.items()}
                for name, row in self.rows_of_table.items()
            },
        }

    def _content(self) -> dict[str, Any]:
        run, store = self.run, self.store
        points = np.unique(contact_points(store, np.unique(store.frame_poke[self.rows]))).tolist()
        return {
            "version": MODELS[run.recipe.model].version,
            "uuid": store.uuid,
            "law": store.law,
            "location": store.address,
            "recipe": self.recipe.model_dump(mode="json"),
            "statistics": self.kept.statistics.as_dict(),
            "groups": {"train": points, "validation": [], "test": []},
            "seen": points,
            "epoch": self.epochs or 0,
            "domain": self.domain.model_dump(mode="json"),
            "model": self.kept.model.cpu().state_dict(),
            "pretrained": {
                "folder": str(run.folder),
                "uuid": run.uuid,
                "location": run.location,
                "recipe": run.recipe.model_dump(mode="json"),
                "groups": run.groups,
                "seen": sorted(run.seen),
                "weights": run.weights[0],
            },
        }


def adapt_recipe(run: Run, changes: Mapping[str, Any] | None = None, where: str = "adapt") -> Recipe:
    """The run's recipe with `CHANGES` for fine-tuning, and further ones; InputError names a wrong key."""
    return check_recipe({**run.recipe.model_dump(), **CHANGES, **(changes or {})}, where)


def adapt(
    run: Run,
    store: Store,
    *,
    recipe: Recipe | None = None,
    rows: NDArray[np.int64] | None = None,
    device: torch.device | str = "cpu",
    on_progress: OnProgress = ignore,
) -> Adaptation:
    """Adapt a run to the pokes of another dataset.

    Parameters
    ----------
    run : the run to begin from; it is left as it is.
    store : dataset of the body, or bodies, to adapt to.
    recipe : of the fine-tuning; by default `adapt_recipe` of the run.
    rows : frames of the store to use; by default all, of pokes that share a solve one.
    device : where the networks are trained.
    on_progress : called after each step.

    Raises
    ------
    InputError
        If there are fewer than three contact points, or the network does not take the dataset's inputs.
    DivergedError
        If a fine-tuning diverges.
    """
    chosen = recipe or adapt_recipe(run)
    used = frames_once(store) if rows is None else rows
    tuning = FineTuning(run, store, chosen, device=device)
    keys = contact_points(store, store.frame_poke[used])
    points = np.unique(keys)
    if len(points) < LEAST_POINTS:
        raise InputError(
            f"{store.location}: {len(points)} contact points, expected {LEAST_POINTS} or more to adapt to"
        )
    order = np.random.default_rng(chosen.seed).permutation(points)
    parts = [np.isin(keys, part) for part in np.array_split(order, min(PARTS, len(order)))]
    stages = stages_to(chosen.epochs)
    steps = _Steps(sum(tuning.steps(used[~part], chosen.epochs) for part in parts), on_progress)

    def predicted(model: Model, part: NDArray[np.bool_]) -> Predictions:
        return predict_part(model, tuning.scenes, MemoryDataset(store, used[part]), prepared=tuning.prepared)

    own = run.model.to(device)
    before = join_predictions([predicted(own, part) for part in parts])
    run.model.cpu()
    of_parts = [
        [predicted(tuned.model, part) for tuned in tuning.stages(used[~part], stages, on_step=steps.next)]
        for part in parts
    ]
    tried: dict[int | None, Predictions] = {None: before}
    tried |= {
        stage: join_predictions(list(each))
        for stage, each in zip(stages, zip(*of_parts, strict=True), strict=True)
    }
    best = min(tried, key=lambda stage: _loss(tried[stage]))
    kept = Tuned(run.model, run.statistics)
    if best is not None:
        steps.more(tuning.steps(used, best))
        [kept] = tuning.stages(used, [best], on_step=steps.next)
    return Adaptation(
        run=run,
        store=store,
        recipe=chosen,
        rows=used,
        points=len(points),
        before=before,
        after=tried[best],
        kept=kept,
        epochs=best,
        intervals=None if force_fault(tried[best]) else _intervals(run, tried[best]),
    )


def stages_to(most: int) -> list[int]:
    """Numbers of epochs to choose among: 0, 1, 2, 4 and so on, and `most`."""
    return [0, *(2**k for k in range(most.bit_length()) if 2**k < most), most]


def _loss(predictions: Predictions) -> float:
    """Mean of the logarithms of mean error and force error; infinite if these are not finite."""
    row = summarise(predictions)
    found = float(np.mean([np.log(row[key].mean) for key in ("mean", "rel force")]))
    return found if np.isfinite(found) else np.inf


def _intervals(run: Run, predictions: Predictions) -> Intervals:
    """Intervals from pokes that the networks had not seen, by the run's error scale if it has intervals."""
    known = load_intervals(run)
    return fit_intervals(predictions) if known is None else recalibrated(known, predictions)


class _Steps:
    """Progress over the steps of all networks."""

    def __init__(self, total: int, on_progress: OnProgress) -> None:
        self._done, self._total, self._on_progress = 0, total, on_progress

    def more(self, steps: int) -> None:
        self._total += steps

    def next(self) -> None:
        self._done += 1
        self._on_progress(Progress(stage="adaptation", done=self._done, total=self._total))
