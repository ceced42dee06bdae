"""A batch of frames as tensors."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from learn.data.store import Store


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """b frames on one grid of n points. SI units; positions in float64, so that moving the scene far from
    the origin costs no digits.

    frame: rows of the store (b,); geometry: rows of the store's profile (b,). start: rod tip at first
    touch (b, 3); direction: unit, of the push (b, 3); depth: travel since (b,); modulus: small-strain shear
    modulus [Pa] (b,). displacement (b, n, 3) float32; force: size of the rod's force [N], (b,) float32.
    """

    frame: Tensor
    geometry: Tensor
    start: Tensor
    direction: Tensor
    depth: Tensor
    modulus: Tensor
    displacement: Tensor
    force: Tensor

    def __len__(self) -> int:
        return len(self.frame)

    def to(self, device: torch.device | str) -> Batch:
        """The same batch on a device."""
        return Batch(**{f.name: getattr(self, f.name).to(device, non_blocking=True) for f in fields(self)})


def make_batch(store: Store, rows: NDArray[np.int64], displacement: NDArray[np.float32]) -> Batch:
    """The batch of these frames; displacement: theirs, (b, n, 3), not copied."""
    poke = store.frame_poke[rows]
    return Batch(
        frame=torch.from_numpy(rows),
        geometry=torch.from_numpy(store.geometry[poke]),
        start=torch.from_numpy(store.path_start[poke]),
        direction=torch.from_numpy(store.direction[poke]),
        depth=torch.from_numpy(store.depth[rows]),
        modulus=torch.from_numpy(store.modulus[poke]),
        displacement=torch.from_numpy(displacement),
        force=torch.from_numpy(np.linalg.norm(store.rod_force[rows], axis=1).astype(np.float32)),
    )
