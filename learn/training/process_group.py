"""One process, or several started by torchrun, each with an equal fraction of every batch."""

from __future__ import annotations

import os
from dataclasses import dataclass

import torch
import torch.distributed as dist
from torch import nn

from learn.errors import InputError


@dataclass(frozen=True)
class ProcessGroup:
    """Process `rank` of `world`, on `device`; `joined` if torchrun started it, alone or with others."""

    rank: int
    world: int
    device: torch.device
    joined: bool = False

    @property
    def is_main(self) -> bool:
        return self.rank == 0

    def average_gradients(self, model: nn.Module) -> None:
        """Replace the gradients of every process by the mean over all processes."""
        if not self.joined:
            return
        gradients = [p.grad for p in model.parameters() if p.grad is not None]
        flat = torch.cat([g.reshape(-1) for g in gradients])
        dist.all_reduce(flat)
        flat /= self.world
        for g, part in zip(gradients, flat.split([g.numel() for g in gradients]), strict=True):
            g.copy_(part.reshape(g.shape))

    def all_true(self, value: bool) -> bool:
        """True if `value` is true in every process: none may wait for a batch that another does not have."""
        if not self.joined:
            return value
        vote = torch.tensor(float(value), device=self.device)
        dist.all_reduce(vote, op=dist.ReduceOp.MIN)
        return bool(vote)

    def mean(self, value: float) -> float:
        """Mean over the processes."""
        if not self.joined:
            return value
        total = torch.tensor(value, dtype=torch.float64, device=self.device)
        dist.all_reduce(total)
        return float(total) / self.world

    def wait(self) -> None:
        if self.joined:
            dist.barrier()

    def close(self) -> None:
        if self.joined:
            dist.destroy_process_group()


def make_process_group(device: str = "auto") -> ProcessGroup:
    """Make the process group of torchrun's environment; device "auto" is this process's GPU if there is one.

    InputError if torch does not know the device, it is missing, or two processes would share a GPU.
    """
    joined = "WORLD_SIZE" in os.environ
    world, rank = int(os.environ.get("WORLD_SIZE", "1")), int(os.environ.get("RANK", "0"))
    chosen = make_device(device)
    if joined and chosen.type == "cuda":
        local = int(os.environ.get("LOCAL_RANK", "0"))
        if local >= torch.cuda.device_count():
            raise InputError(
                f"--nproc-per-node: {local + 1} processes or more want a GPU each, of which "
                f"{torch.cuda.device_count()} are here: expected as many processes as GPUs, or --device cpu"
            )
        chosen = torch.device("cuda", local)
        torch.cuda.set_device(chosen)
        dist.init_process_group("nccl", device_id=chosen)
    elif joined:
        dist.init_process_group("gloo")
    return ProcessGroup(rank, world, chosen, joined)


def make_device(device: str = "auto") -> torch.device:
    """The device of that name; "auto" is the GPU if there is one.

    InputError if torch does not know the device, or it is missing.
    """
    if device == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        chosen = torch.device(device)
    except RuntimeError:
        chosen = torch.device("meta")
    if chosen.type not in ("cpu", "cuda"):
        raise InputError(f"device {device}: expected auto, cpu or cuda")
    if chosen.type == "cuda" and not torch.cuda.is_available():
        raise InputError(f"device {device}: torch sees no GPU here, expected auto or cpu")
    if chosen.type == "cuda" and (chosen.index or 0) >= torch.cuda.device_count():
        count = torch.cuda.device_count()
        raise InputError(
            f"device {device}: expected a number below {count}, of the GPUs that torch sees here"
        )
    return chosen
