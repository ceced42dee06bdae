"""Training, epoch by epoch; after each the run can be stopped and resumed to the same result."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from learn.data import Batch, MemoryDataset, Split, Statistics, Store, StreamDataset, statistics
from learn.data.folds import contact_points, split_of
from learn.errors import InputError
from learn.models import MODELS, Scenes, make_model, pokes_of
from learn.progress import OnProgress, Progress, ignore
from learn.training.augmentation import Augmentation
from learn.training.optimisation import Optimisation, learning_rate
from learn.training.process_group import ProcessGroup
from learn.training.recipe import Recipe, loss_of
from learn.training.run_dataset import check_dataset, save_tables
from learn.training.run_folder import (
    BEST,
    LAST,
    Log,
    load_checkpoint,
    load_weights,
    recipe_of,
    save_checkpoint,
)
from learn.validity import domain_of

_DIVERGED = 10.0  # ratio to the lowest training loss of an epoch
_WARM_FRAMES = 600  # for the warm start


class DivergedError(Exception):
    """The loss diverged; the last good checkpoint is kept. The text is one sentence."""


class Trainer:
    """Trainer of one run in `folder`.

    Parameters
    ----------
    store : the dataset.
    recipe : the training recipe.
    folder : folder of the run; created if necessary.
    process_group : this process among those of torchrun; by default the only one, on the CPU.
    resume : continue from the folder's `last.pt`. InputError if there is none, or it is another run's.
    on_progress : called after each batch and each epoch.

    Attributes
    ----------
    epoch : epochs done.
    split : frames of the three parts.
    model : the network that is trained.
    optimisation : its steps, with the moving average of its weights, which is kept.
    ahead : number of batches that another thread prepares in advance. 0 on a CPU, where training keeps to the
        threads that it was given; on a GPU the neighbourhoods of dropped points take longer than a step.
    """

    def __init__(
        self,
        store: Store,
        recipe: Recipe,
        folder: Path,
        *,
        process_group: ProcessGroup | None = None,
        resume: bool = False,
        on_progress: OnProgress = ignore,
    ) -> None:
        group = process_group or ProcessGroup(0, 1, torch.device("cpu"))
        self.store, self.recipe, self.folder, self.group = store, recipe, folder, group
        self.on_progress = on_progress
        self.ahead = 0 if group.device.type == "cpu" else 2
        self.split: Split = split_of(store, recipe)
        rows = np.concatenate([self.split.train, self.split.validation])
        self.seen = sorted(set(contact_points(store, np.unique(store.frame_poke[rows])).tolist()))
        kept = self._checkpoint(resume)
        self.train_data = self._dataset()
        self.validation = MemoryDataset(store, self.split.validation) if group.is_main else None
        if kept is None:
            self.statistics = statistics(self._ordered(), store)
        else:
            self.statistics = Statistics(**kept["statistics"])
        torch.manual_seed(recipe.seed)
        self.model = make_model(recipe.model, self.statistics).to(group.device)
        if store.clock is not None and not self.model.takes_clock:
            raise InputError(
                f"{store.location}: its frames have time, which model {recipe.model} takes no account of"
            )
        if kept is None:
            self._warm_start()
        self.optimisation = Optimisation(self.model, recipe, self.statistics, group)
        self.epoch, self.best, self.first = 0, math.inf, math.inf
        if kept is not None:
            self._restore(kept)
        scenes = Scenes.of(store).to(group.device)
        self.domain = domain_of(store, self.split.train)
        train = scenes.only(self._geometries(self.split.train))
        self.scenes_validation = scenes.only(self._geometries(self.split.validation))
        # neighbourhoods depend on the points alone, which are the same in both
        self.prepared = [self.model.prepare(scene) for scene in scenes.scenes]
        self.augmentation = Augmentation(
            store, recipe, self.split.train, scenes=train, prepared=self.prepared, prepare=self.model.prepare
        )

    def train(self) -> None:
        """Train to the recipe's last epoch.

        Raises
        ------
        DivergedError
            If the loss is not finite, or above ten times the best; the last good checkpoint is kept.
        OSError
            If a checkpoint or the log cannot be written; the last good checkpoint is kept.
        """
        if self.group.is_main:
            self.folder.mkdir(parents=True, exist_ok=True)
        log = Log(self.folder, epochs_done=self.epoch) if self.group.is_main else None
        try:
            if self.group.is_main:
                save_tables(self.folder, self.store)
            while self.epoch < self.recipe.epochs:
                begun = time.perf_counter()
                losses = self._epoch()
                seconds = time.perf_counter() - begun
                line = {
                    "epoch": self.epoch,
                    "step": self.optimisation.step,
                    **losses,
                    "learning_rate": learning_rate(self.recipe, self.epoch / self.recipe.epochs),
                }
                if self.group.is_main:
                    line |= self._validate()
                    self._check(line)
                self.epoch += 1
                if self.group.is_main and log is not None:
                    line |= {"seconds": seconds, "samples_per_second": len(self.split.train) / seconds}
                    # first the log: of an epoch that is not in last.pt, resuming drops its line
                    log.add(line)
                    self._save(line)
                self.group.wait()
                self._report(0, line)
        finally:
            if log is not None:
                log.close()

    def _warm_start(self) -> None:
        rows = self.split.train
        some = rows[np.linspace(0, len(rows) - 1, min(len(rows), _WARM_FRAMES)).astype(int)]
        scenes = Scenes.of(self.store).only(self._geometries(rows))
        self.model.cpu().warm_start(MemoryDataset(self.store, some).batches(8), scenes)
        self.model.to(self.group.device)

    def _geometries(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """The interior of each of these frames."""
        return self.store.geometry[self.store.frame_poke[rows]]

    def _dataset(self) -> MemoryDataset | StreamDataset:
        if self.recipe.data == "memory":
            if self.group.world > 1 and len(self.split.train) < self.recipe.batch:
                raise InputError(
                    f"{self.store.location}: {len(self.split.train)} frames to train on are no batch of"
                    f" {self.recipe.batch} for {self.group.world} processes: expected one process, or a"
                    " smaller key batch"
                )
            return MemoryDataset(self.store, self.split.train)
        shards = len(np.unique(self.split.train // self.store.shard))
        if shards < self.group.world:
            raise InputError(
                f"{self.store.location}: {shards} shards to train on cannot be split among "
                f"{self.group.world} processes: expected data: memory, or fewer processes"
            )
        return StreamDataset(
            self.store,
            self.split.train,
            batch=self._batch(),
            shuffle_buffer=self.recipe.shuffle_buffer,
            seed=self.recipe.seed,
            rank=self.group.rank,
            world=self.group.world,
        )

    def _batch(self) -> int:
        """Number of frames per batch in this process."""
        if self.recipe.batch % self.group.world:
            raise InputError(
                f"recipe {self.recipe.name}: key batch: {self.recipe.batch} frames cannot be split among "
                f"{self.group.world} processes"
            )
        return self.recipe.batch // self.group.world

    def _ordered(self) -> Iterator[Batch]:
        if isinstance(self.train_data, MemoryDataset):
            return self.train_data.batches(256)
        return iter(StreamDataset(self.store, self.split.train, batch=256, shuffle_buffer=1, seed=None))

    def _batches(self) -> Iterator[Batch]:
        data, group = self.train_data, self.group
        if isinstance(data, MemoryDataset):
            yield from data.batches(
                self._batch(), seed=self.recipe.seed, epoch=self.epoch, rank=group.rank, world=group.world
            )
            return
        data.epoch = self.epoch
        source = iter(data)
        while True:
            batch = next(source, None)
            if not group.all_true(batch is not None):
                return
            assert batch is not None
            yield batch

    def _epoch(self) -> dict[str, float]:
        self.model.train()
        # of dropout: a function of the epoch, so that a resumed run of any number of processes is the same
        key = np.random.SeedSequence(entropy=self.recipe.seed, spawn_key=(3, self.epoch, self.group.rank))
        torch.manual_seed(int(key.generate_state(1)[0]))
        done, total = 0, len(self.split.train)
        sums = torch.zeros(3, dtype=torch.float64)
        augmented = self.augmentation.each(self._batches(), self.optimisation.step, ahead=self.ahead)
        for frames, parts in augmented:
            loss = self.optimisation.update(parts, (self.epoch + done / total) / self.recipe.epochs)
            values = torch.stack([loss.total, loss.displacement, loss.force]).detach().double().cpu()
            if not bool(torch.isfinite(values).all()):
                raise DivergedError(f"epoch {self.epoch}: the loss is not finite")
            sums += values * frames
            done = min(done + frames * self.group.world, total)
            self._report(done, None)
        means = [self.group.mean(float(v)) * self.group.world / max(done, 1) for v in sums]
        return dict(zip(("train_loss", "train_displacement_mm", "train_force"), means, strict=True))

    @torch.no_grad()
    def _validate(self) -> dict[str, float]:
        assert self.validation is not None
        kept = self.optimisation.ema.eval()
        scenes = self.scenes_validation.scenes
        encode = functools.cache(lambda k: kept.encode(scenes[k], self.prepared[k]))
        sums, frames = torch.zeros(3, dtype=torch.float64), 0
        for batch in self.validation.batches(64):
            for k, _, part in self.scenes_validation.parts(batch.to(self.group.device)):
                found = kept.decode(encode(k), pokes_of(part))
                loss = loss_of([(found, part, scenes[k])], self.recipe, self.statistics)
                distance = (found.displacement - part.displacement).norm(dim=2).mean() * 1e3
                wrong = ((found.force - part.force).abs() / part.force).mean()
                values: Tensor = torch.stack([loss.total, distance, wrong])
                sums += values.double().cpu() * len(part)
                frames += len(part)
        names = ("validation_loss", "validation_mean_mm", "validation_force_relative")
        return dict(zip(names, (float(v) / frames for v in sums), strict=True))

    def _check(self, line: dict[str, Any]) -> None:
        if not math.isfinite(line["validation_loss"]):
            raise DivergedError(f"epoch {self.epoch}: the validation loss is not finite")
        self.first = min(self.first, line["train_loss"]) if self.epoch else line["train_loss"]
        if line["train_loss"] > _DIVERGED * self.first:
            raise DivergedError(
                f"epoch {self.epoch}: the loss is {line['train_loss'] / self.first:.0f} times its best"
            )

    def _report(self, frames: int, line: dict[str, Any] | None) -> None:
        done = self.epoch + frames / len(self.split.train)
        self.on_progress(Progress(stage="training", done=done, total=self.recipe.epochs, values=line))

    def _save(self, line: dict[str, Any]) -> None:
        about = {
            "version": MODELS[self.recipe.model].version,
            "uuid": self.store.uuid,
            "law": self.store.law,
            "location": self.store.address,
            "recipe": self.recipe.model_dump(mode="json"),
            "statistics": self.statistics.as_dict(),
            "groups": self.split.groups,
            "seen": self.seen,
            "epoch": self.epoch,
            "domain": self.domain.model_dump(mode="json"),
        }
        if line["validation_loss"] < self.best:
            self.best = line["validation_loss"]
            save_checkpoint(self.folder / BEST, {**about, "model": self.optimisation.ema.state_dict()})
        state = {
            "model": self.model.state_dict(),
            "averaged": self.optimisation.ema.state_dict(),
            "optimiser": self.optimisation.optimiser.state_dict(),
            "step": self.optimisation.step,
            "best": self.best,
            "first": self.first,
        }
        save_checkpoint(self.folder / LAST, {**about, **state})

    def _checkpoint(self, resume: bool) -> dict[str, Any] | None:
        """Checkpoint to resume from; InputError if it is another run's, or would be overwritten."""
        path = self.folder / LAST
        if not resume:
            if path.exists():
                raise InputError(
                    f"{self.folder}: a run is there already; --resume goes on, or choose another --out"
                )
            self._check_best()
            return None
        content = load_checkpoint(path)
        if not (self.folder / BEST).is_file():
            raise InputError(
                f"{self.folder / BEST}: missing beside {LAST}, expected both (the best epoch so far is in it)"
            )
        check_dataset(content["uuid"], path, self.store)
        before, now = recipe_of(content, path).model_dump(), self.recipe.model_dump()
        seen = content.get("seen", self.seen)
        frames = content["statistics"]["frames"], len(self.split.train)
        if content["groups"] != self.split.groups or seen != self.seen or frames[0] != frames[1]:
            raise InputError(
                f"{path}: was trained on {frames[0]} frames of {self.store.location}, which now has"
                f" {frames[1]} to train on, or others (the store was not complete, or the rule has changed):"
                " train it again with another --out"
            )
        different = [key for key in now if before[key] != now[key]]
        if different:
            key = different[0]
            raise InputError(f"{path}: was trained with {key} {before[key]}, the recipe now has {now[key]}")
        return content

    def _check_best(self) -> None:
        """Raise InputError if weights of another run would be overwritten, kept without its `last.pt`."""
        path = self.folder / BEST
        if not path.exists():
            return
        content = load_checkpoint(path)
        # what a stop between the two files of the first epoch leaves is this run's
        own = content["recipe"] == self.recipe.model_dump(mode="json") and content["uuid"] == self.store.uuid
        if not own or content["epoch"] > 1:
            raise InputError(
                f"{self.folder}: the {BEST} of another training is there, without the {LAST} from which it"
                " would go on: choose another --out"
            )

    def _restore(self, content: dict[str, Any]) -> None:
        path = self.folder / LAST
        load_weights(self.model, content["model"], path, self.recipe.model)
        load_weights(self.optimisation.ema, content["averaged"], path, self.recipe.model)
        try:
            self.optimisation.optimiser.load_state_dict(content["optimiser"])
        except (ValueError, KeyError, TypeError, RuntimeError) as error:
            raise InputError(
                f"{path}: not a readable checkpoint ({' '.join(str(error).split())[:120]})"
            ) from None
        self.optimisation.step, self.epoch = content["step"], content["epoch"]
        self.best, self.first = content["best"], content["first"]
