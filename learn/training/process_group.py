"""One process, or several that torchrun started: each takes its part of every batch."""

from __future__ import annotations

import os
from dataclasses import dataclass

import torch
import torch.distributed as dist
from torch import nn

from learn.errors import InputError


@dataclass(frozen=True)
class ProcessGroup:
    """Process `rank` of `world`; device: of this process."""

    rank: int
    world: int
    device: torch.device

    @property
    def is_main(self) -> bool:
        return self.rank == 0

    def average_gradients(self, model: nn.Module) -> None:
        """Every process's gradient becomes the mean of all."""
        if self.world == 1:
            return
        gradients = [p.grad for p in model.parameters() if p.grad is not None]
        flat = torch.cat([g.reshape(-1) for g in gradients])
        dist.all_reduce(flat)
        flat /= self.world
        for g, part in zip(gradients, flat.split([g.numel() for g in gradients]), strict=True):
            g.copy_(part.reshape(g.shape))

    def all_true(self, value: bool) -> bool:
        """True where it is for every process: none may wait for a batch that another does not have."""
        if self.world == 1:
            return value
        vote = torch.tensor(float(value), device=self.device)
        dist.all_reduce(vote, op=dist.ReduceOp.MIN)
        return bool(vote)

    def mean(self, value: float) -> float:
        """Mean over the processes."""
        if self.world == 1:
            return value
        total = torch.tensor(value, dtype=torch.float64, device=self.device)
        dist.all_reduce(total)
        return float(total) / self.world

    def wait(self) -> None:
        if self.world > 1:
            dist.barrier()

    def close(self) -> None:
        if self.world > 1:
            dist.destroy_process_group()


def make_process_group(device: str = "auto") -> ProcessGroup:
    """From torchrun's environment; device "auto" is this process's GPU where there is one.

    InputError where torch does not know the device, or it is not there.
    """
    world, rank = int(os.environ.get("WORLD_SIZE", "1")), int(os.environ.get("RANK", "0"))
    cuda = torch.cuda.is_available() if device == "auto" else device.startswith("cuda")
    try:
        chosen = torch.device(device if device != "auto" else "cuda" if cuda else "cpu")
    except RuntimeError:
        raise InputError(f"device {device}: expected auto, cpu or cuda") from None
    if chosen.type == "cuda" and not torch.cuda.is_available():
        raise InputError(f"device {device}: torch sees no GPU here, expected auto or cpu")
    if cuda and world > 1:
        chosen = torch.device("cuda", int(os.environ.get("LOCAL_RANK", "0")))
        torch.cuda.set_device(chosen)
    if world > 1:
        dist.init_process_group("nccl" if cuda else "gloo")
    return ProcessGroup(rank, world, chosen)
