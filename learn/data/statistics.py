"""Statistics of displacement, depth and force, from the training part alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import torch

from learn.data.loaders import Batch
from learn.data.store import Store
from learn.errors import InputError


@dataclass(frozen=True)
class Statistics:
    """Statistics of a training part.

    Attributes
    ----------
    frames : number of frames.
    displacement : root mean square of its magnitude over all points [m].
    depth_mean, depth_max : mean and largest depth [m].
    log_force_mean, log_force_sd : mean and standard deviation of
        ln(force / (shear modulus x rod radius x depth)).
    force_rms : root mean square of the force [N].
    log_modulus_mean : mean of ln(modulus / Pa); None if the modulus only scales the forces
        (`Store.scales_with_modulus`).
    block_height : mean height of the blocks [m]; None in checkpoints of before 2026-11-28.
    log_time_mean, log_speed_mean : means of ln(time since contact / s) and ln(speed of approach / (m/s));
        None if the dataset has no time.
    """

    frames: int
    displacement: float
    depth_mean: float
    depth_max: float
    log_force_mean: float
    log_force_sd: float
    force_rms: float
    log_modulus_mean: float | None = None
    block_height: float | None = None
    log_time_mean: float | None = None
    log_speed_mean: float | None = None

    def as_dict(self) -> dict[str, Any]:
        return {name: value for name, value in asdict(self).items() if value is not None}


def statistics(batches: Iterable[Batch], store: Store) -> Statistics:
    """Compute statistics in one pass over a training part. InputError if it is empty or has a zero force."""
    squares = 0.0
    points = 0
    depth, force, modulus, clock, geometry = [], [], [], [], []
    for batch in batches:
        squares += float(batch.displacement.double().square().sum())
        points += batch.displacement.shape[0] * batch.displacement.shape[1]
        depth.append(batch.depth)
        force.append(batch.force.double())
        modulus.append(batch.modulus)
        clock.append(batch.clock)
        geometry.append(batch.geometry)
    if not depth:
        raise InputError("the training part is empty")
    d, f, g = torch.cat(depth), torch.cat(force), torch.cat(modulus)
    if not bool((f > 0).all()):
        raise InputError("a training frame has a rod force of zero")
    scaled = torch.log(f / (g * store.rod_radius * d))
    heights = np.array([setup.block_size[2] for setup in store.setups])[store.setup_index]
    times = torch.cat(clock)
    timed = {}
    if times.shape[1]:
        timed = {
            "log_time_mean": float(torch.log(times[:, 0]).mean()),
            "log_speed_mean": float(torch.log(times[:, 2]).mean()),
        }
    return Statistics(
        frames=len(d),
        displacement=(squares / points) ** 0.5,
        depth_mean=float(d.mean()),
        depth_max=float(d.max()),
        log_force_mean=float(scaled.mean()),
        log_force_sd=float(scaled.std(unbiased=False)),
        force_rms=float(f.square().mean().sqrt()),
        block_height=float(heights[torch.cat(geometry).numpy()].mean()),
        log_modulus_mean=None if store.scales_with_modulus else float(torch.log(g).mean()),
        **timed,
    )
