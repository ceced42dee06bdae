"""Fine-tuning: a trained network goes on learning, from the few pokes of another dataset.

All weights are trained, from those of the run, at a low rate and for few epochs. These are too few to learn
that all forces are larger by a factor, as those of another law are: the unit of the force is corrected by
that factor first. The closed form and the other statistics stay those of the run.

How long is a question of the pokes: where they are few and the run is right already, more epochs do harm. The
network is therefore given after several numbers of epochs (`stages`), among which `learn.adaptation` chooses
by cross-validation; there is no validation part, which few pokes cannot spare.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import MemoryDataset, Statistics, Store
from learn.errors import InputError
from learn.models import Model, Scenes, make_model, pokes_of
from learn.training.augmentation import Augmentation
from learn.training.loop import DivergedError
from learn.training.optimisation import Optimisation
from learn.training.process_group import ProcessGroup
from learn.training.recipe import Recipe
from learn.training.run_folder import Run


class Tuned(NamedTuple):
    """A network in evaluation mode, and the statistics that it is made with."""

    model: Model
    statistics: Statistics


class FineTuning:
    """Fine-tuning of one run on parts of one dataset.

    Parameters
    ----------
    run : the run that is begun from; it is left as it is.
    store : the dataset; InputError if the run's network does not take its inputs (`check_inputs`).
    recipe : epochs, batches, optimiser and augmentation.
    device : where it is computed.
    """

    def __init__(self, run: Run, store: Store, recipe: Recipe, *, device: torch.device | str = "cpu") -> None:
        check_inputs(run, store)
        self._run, self._store, self._recipe = run, store, recipe
        self._group = ProcessGroup(0, 1, torch.device(device))
        self.scenes = Scenes.of(store).to(self._group.device)
        self.prepared = [run.model.prepare(scene) for scene in self.scenes.scenes]

    def steps(self, rows: NDArray[np.int64], epochs: int) -> int:
        """Number of steps of so many epochs on these frames."""
        return epochs * math.ceil(len(rows) / self._recipe.batch)

    def stages(
        self, rows: NDArray[np.int64], epochs: Sequence[int], *, on_step: Callable[[], None] = lambda: None
    ) -> Iterator[Tuned]:
        """The run's network after each of these numbers of epochs on these frames.

        Parameters
        ----------
        rows : frames of the store.
        epochs : increasing numbers of epochs; after 0 only the unit of the force is corrected.
        on_step : called after each step.

        Raises
        ------
        DivergedError
            If the loss is not finite.
        """
        store, recipe, run = self._store, self._recipe, self._run
        data = MemoryDataset(store, rows)
        mean = run.statistics.log_force_mean + self._log_ratio(data)
        statistics = replace(run.statistics, frames=len(rows), log_force_mean=mean)
        torch.manual_seed(recipe.seed)
        model = make_model(recipe.model, statistics)
        model.load_state_dict(run.model.state_dict())
        model = model.to(self._group.device).train()
        optimisation = Optimisation(model, recipe, statistics, self._group)
        scenes = self.scenes.only(store.geometry[store.frame_poke[rows]])
        augmentation = Augmentation(
            store, recipe, rows, scenes=scenes, prepared=self.prepared, prepare=model.prepare
        )
        total, epoch = self.steps(rows, recipe.epochs), 0
        for last in epochs:
            while epoch < last:
                batches = data.batches(recipe.batch, seed=recipe.seed, epoch=epoch)
                for _, parts in augmentation.each(batches, optimisation.step):
                    loss = optimisation.update(parts, optimisation.step / total)
                    if not bool(torch.isfinite(loss.total)):
                        raise DivergedError(f"step {optimisation.step}: the loss is not finite")
                    on_step()
                epoch += 1
            yield Tuned(copy.deepcopy(optimisation.ema).eval(), statistics)

    @torch.no_grad()
    def _log_ratio(self, data: MemoryDataset) -> float:
        """Mean of ln(true force / force predicted by the run) over all frames with a force above 0 N."""
        model = self._run.model.to(self._group.device)
        logs = []
        for batch in data.batches(64):
            for k, _, part in self.scenes.parts(batch.to(self._group.device)):
                scene = self.scenes.scenes[k]
                force = model.decode(model.encode(scene, self.prepared[k]), pokes_of(part)).force
                logs.append(torch.log(part.force[force > 0.0] / force[force > 0.0]).double())
        model.cpu()
        every = torch.cat(logs)
        return float(every.mean()) if len(every) else 0.0


def check_inputs(run: Run, store: Store) -> None:
    """Raise InputError if a run cannot be fine-tuned on a dataset: its network would not see what differs."""
    where = f"{store.location}: {run.folder}"
    if run.members:
        raise InputError(f"{run.folder}: expected one run, this is an ensemble")
    if run.pretrained is not None:
        raise InputError(
            f"{run.folder}: was adapted already, expected the run that it was adapted from"
            f" ({run.pretrained.folder})"
        )
    if run.uuid == store.uuid:
        raise InputError(f"{where} was trained on this dataset itself, expected another one")
    timed = run.statistics.log_time_mean is not None
    if timed != (store.clock is not None):
        raise InputError(
            f"{where} was trained {'with' if timed else 'without'} time, expected a dataset of that kind"
        )
    levels = np.unique(store.softness[store.done])
    if run.statistics.log_modulus_mean is None and not store.scales_with_modulus and len(levels) > 1:
        raise InputError(
            f"{where} was trained on materials that differ in modulus alone, and these differ in more:"
            " expected one softness level"
        )
