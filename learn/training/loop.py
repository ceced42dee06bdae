"""Training, epoch by epoch; after each the run can be stopped and taken up again to the same result."""

from __future__ import annotations

import contextlib
import copy
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from learn.data import Batch, MemoryDataset, Split, Statistics, Store, StreamDataset, split_pokes, statistics
from learn.errors import InputError
from learn.models import VERSIONS, Scene, make_model, pokes_of, scene_of
from learn.training._distributed import Team
from learn.training._log import Log
from learn.training.checkpoint import (
    BEST,
    LAST,
    check_dataset,
    check_version,
    load_checkpoint,
    save_checkpoint,
)
from learn.training.losses import Loss, loss_of
from learn.training.recipe import Recipe

_DIVERGED = 10.0  # times the first epoch's loss
_WARM_FRAMES = 600  # for what is fitted before training
_THINNEST = 0.4  # of the points
_FLOOR = 0.01  # of the rate, at the end of a cosine

Watch = Callable[["Progress"], None]


class DivergedError(Exception):
    """The loss ran away; the last good checkpoint stands. Its text is one sentence."""


@dataclass(frozen=True)
class Progress:
    """Where a run is: epochs done of all, frames done of this epoch's, and the last epoch's log line."""

    epoch: int
    epochs: int
    frames: int
    frames_all: int
    line: dict[str, Any] | None = None


class Trainer:
    """One run in `folder`. The work: `train()`."""

    def __init__(
        self, store: Store, recipe: Recipe, folder: Path, *, team: Team, resume: bool, watch: Watch
    ) -> None:
        self.store, self.recipe, self.folder, self.team, self.watch = store, recipe, folder, team, watch
        kept = self._found(resume)
        self.split: Split = split_pokes(
            store,
            fold=recipe.fold,
            by=recipe.split,
            train_softness=recipe.train_softness,
            train_depth=recipe.train_depth_mm * 1e-3 if recipe.train_depth_mm else None,
        )
        self.train_data = self._dataset()
        self.validation = MemoryDataset(store, self.split.validation) if team.leads else None
        if kept is None:
            self.statistics = statistics(self._ordered(), store.rod_radius)
        else:
            self.statistics = Statistics(**kept["statistics"])
        torch.manual_seed(recipe.seed)
        self.model = make_model(recipe.model, self.statistics).to(team.device)
        if kept is None:
            self._warm_start()
        self.averaged = copy.deepcopy(self.model).requires_grad_(False)
        self.optimiser = torch.optim.Adam(self.model.parameters(), lr=recipe.rate)
        self.step, self.epoch, self.best, self.first = 0, 0, math.inf, math.inf
        torch.manual_seed(recipe.seed + 1 + team.rank)  # dropout
        if kept is not None:
            self._take_up(kept)
        scene = scene_of(store).to(team.device)
        self.scene = scene.only(store.geometry[store.frame_poke[self.split.train]])
        self.scene_validation = scene.only(store.geometry[store.frame_poke[self.split.validation]])
        # neighbourhoods are of the points alone, which all scenes share
        self.prepared = self.model.prepare(scene)

    def train(self) -> None:
        """To the recipe's last epoch. DivergedError where the loss is not finite or ten times the first."""
        if self.team.leads:
            self.folder.mkdir(parents=True, exist_ok=True)
        log = Log(self.folder, epochs_done=self.epoch) if self.team.leads else None
        try:
            while self.epoch < self.recipe.epochs:
                begun = time.perf_counter()
                losses = self._epoch()
                seconds = time.perf_counter() - begun
                line = {"epoch": self.epoch, "step": self.step, **losses, "rate": self._rate(0.0)}
                if self.team.leads:
                    line |= self._validate()
                    self._check(line)
                self.epoch += 1
                if self.team.leads and log is not None:
                    self._save(line)
                    line |= {"seconds": seconds, "samples_per_second": len(self.split.train) / seconds}
                    log.add(line)
                self.team.wait()
                self._tell(0, line)
        finally:
            if log is not None:
                log.close()

    def _warm_start(self) -> None:
        rows = self.split.train
        some = rows[np.linspace(0, len(rows) - 1, min(len(rows), _WARM_FRAMES)).astype(int)]
        scene = scene_of(self.store).only(self.store.geometry[self.store.frame_poke[rows]])
        self.model.cpu().warm_start(MemoryDataset(self.store, some).batches(8), scene)
        self.model.to(self.team.device)

    def _dataset(self) -> MemoryDataset | StreamDataset:
        if self.recipe.data == "memory":
            return MemoryDataset(self.store, self.split.train)
        return StreamDataset(
            self.store,
            self.split.train,
            batch=self._share(),
            pool=self.recipe.pool,
            seed=self.recipe.seed,
            rank=self.team.rank,
            world=self.team.world,
        )

    def _share(self) -> int:
        """Frames of a batch that come to this process."""
        if self.recipe.batch % self.team.world:
            raise InputError(
                f"recipe {self.recipe.name}: key batch: {self.recipe.batch} frames cannot be shared among "
                f"{self.team.world} processes"
            )
        return self.recipe.batch // self.team.world

    def _ordered(self) -> Iterator[Batch]:
        if isinstance(self.train_data, MemoryDataset):
            return self.train_data.batches(256)
        return iter(StreamDataset(self.store, self.split.train, batch=256, pool=1, seed=None))

    def _batches(self) -> Iterator[Batch]:
        data, team = self.train_data, self.team
        if isinstance(data, MemoryDataset):
            yield from data.batches(
                self._share(), seed=self.recipe.seed, epoch=self.epoch, rank=team.rank, world=team.world
            )
            return
        data.epoch = self.epoch
        source = iter(data)
        while True:
            batch = next(source, None)
            if not team.all_agree(batch is not None):
                return
            assert batch is not None
            yield batch

    def _epoch(self) -> dict[str, float]:
        self.model.train()
        done, total = 0, len(self.split.train)
        sums = torch.zeros(3, dtype=torch.float64)
        for batch in self._batches():
            loss = self._update(batch.to(self.team.device), done / total)
            parts = torch.stack([loss.total, loss.displacement, loss.force]).detach().double().cpu()
            if not bool(torch.isfinite(parts).all()):
                raise DivergedError(f"epoch {self.epoch}: the loss is not finite")
            sums += parts * len(batch)
            done = min(done + len(batch) * self.team.world, total)
            self._tell(done, None)
        means = [self.team.mean(float(v)) * self.team.world / max(done, 1) for v in sums]
        return dict(zip(("train_loss", "train_displacement_mm", "train_force"), means, strict=True))

    def _update(self, batch: Batch, within: float) -> Loss:
        for group in self.optimiser.param_groups:
            group["lr"] = self._rate(within)
        scene, prepared, batch = self._thinned(batch)
        mixed = self.recipe.mixed_precision and self.team.device.type == "cuda"
        with torch.autocast("cuda", torch.bfloat16) if mixed else contextlib.nullcontext():
            prediction = self.model.decode(self.model.encode(scene, prepared), pokes_of(batch))
        loss = loss_of(prediction, batch, scene, self.recipe, self.statistics)
        self.optimiser.zero_grad(set_to_none=True)
        loss.total.backward()
        self.team.average_gradients(self.model)
        if self.recipe.clip:
            nn.utils.clip_grad_norm_(self.model.parameters(), self.recipe.clip)
        self.optimiser.step()
        self.step += 1
        self._average()
        return loss

    def _thinned(self, batch: Batch) -> tuple[Scene, Any, Batch]:
        """The batch as it is, or on some of its points; a function of seed and step alone."""
        if not self.recipe.thin:
            return self.scene, self.prepared, batch
        key = np.random.SeedSequence(entropy=self.recipe.seed, spawn_key=(1, self.step))
        random = np.random.default_rng(key)
        if random.uniform() >= self.recipe.thin:
            return self.scene, self.prepared, batch
        n = len(self.scene.points)
        some = np.sort(random.choice(n, int(n * random.uniform(_THINNEST, 1)), replace=False))
        scene = self.scene.at(some)
        index = torch.from_numpy(some).to(batch.displacement.device)
        return scene, self.model.prepare(scene), replace(batch, displacement=batch.displacement[:, index])

    def _rate(self, within: float) -> float:
        """The rate at a share of the current epoch: warm-up, then constant or a cosine."""
        recipe = self.recipe
        share = (self.epoch + within) / recipe.epochs
        if share < recipe.warmup:
            return recipe.rate * max(share / recipe.warmup, _FLOOR)
        if recipe.schedule == "constant":
            return recipe.rate
        turn = (share - recipe.warmup) / (1 - recipe.warmup)
        return recipe.rate * (_FLOOR + (1 - _FLOOR) * 0.5 * (1 + math.cos(math.pi * turn)))

    @torch.no_grad()
    def _average(self) -> None:
        decay = min(self.recipe.average, (1 + self.step) / (10 + self.step)) if self.recipe.average else 0.0
        for mean, now in zip(self.averaged.parameters(), self.model.parameters(), strict=True):
            mean.lerp_(now, 1 - decay)

    @torch.no_grad()
    def _validate(self) -> dict[str, float]:
        assert self.validation is not None
        self.averaged.eval()
        encoded = self.averaged.encode(self.scene_validation, self.prepared)
        sums, frames = torch.zeros(3, dtype=torch.float64), 0
        for batch in self.validation.batches(64):
            batch = batch.to(self.team.device)
            found = self.averaged.decode(encoded, pokes_of(batch))
            loss = loss_of(found, batch, self.scene_validation, self.recipe, self.statistics)
            distance = (found.displacement - batch.displacement).norm(dim=2).mean() * 1e3
            wrong = ((found.force - batch.force).abs() / batch.force).mean()
            values: Tensor = torch.stack([loss.total, distance, wrong])
            sums += values.double().cpu() * len(batch)
            frames += len(batch)
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

    def _tell(self, frames: int, line: dict[str, Any] | None) -> None:
        self.watch(Progress(self.epoch, self.recipe.epochs, frames, len(self.split.train), line))

    def _save(self, line: dict[str, Any]) -> None:
        about = {
            "version": VERSIONS[self.recipe.model],
            "uuid": self.store.uuid,
            "law": self.store.law,
            "location": self.store.location,
            "recipe": self.recipe.model_dump(mode="json"),
            "statistics": self.statistics.as_dict(),
            "groups": self.split.groups,
            "epoch": self.epoch,
        }
        if line["validation_loss"] < self.best:
            self.best = line["validation_loss"]
            save_checkpoint(self.folder / BEST, {**about, "model": self.averaged.state_dict()})
        state = {
            "model": self.model.state_dict(),
            "averaged": self.averaged.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "random": torch.get_rng_state(),
            "step": self.step,
            "best": self.best,
            "first": self.first,
        }
        save_checkpoint(self.folder / LAST, {**about, **state})

    def _found(self, resume: bool) -> dict[str, Any] | None:
        """The checkpoint to go on from; InputError where it is another run's, or would be overwritten."""
        path = self.folder / LAST
        if not resume:
            if path.exists():
                raise InputError(
                    f"{self.folder}: a run is there already; --resume goes on, or choose another --out"
                )
            return None
        content = load_checkpoint(path)
        check_dataset(content, path, self.store)
        check_version(content, path)
        mine = self.recipe.model_dump(mode="json")
        different = [key for key in mine if content["recipe"].get(key) != mine[key]]
        if different:
            key = different[0]
            raise InputError(
                f"{path}: was trained with {key} {content['recipe'].get(key)}, the recipe now has {mine[key]}"
            )
        return content

    def _take_up(self, content: dict[str, Any]) -> None:
        self.model.load_state_dict(content["model"])
        self.averaged.load_state_dict(content["averaged"])
        self.optimiser.load_state_dict(content["optimiser"])
        torch.set_rng_state(content["random"])
        self.step, self.epoch = content["step"], content["epoch"]
        self.best, self.first = content["best"], content["first"]
