"""The paper's model as ONNX, in double precision.

It chooses neighbours anew in each layer, and its answer jumps where they change: in single precision another
runtime's rounding is enough for that, somewhere on a grid of a thousand points. In double precision both
choose alike, so that what is written and what it is checked against are the model with its weights in double.
"""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from learn.models import Pokes, Scene
from learn.models.cegnn import Cegnn

INPUTS = ["profile", "start", "direction", "depth"]


class CegnnPart(nn.Module):
    """`Cegnn` of one poke with plain tensors in and out, for a fixed cloud; profile (n, levels)."""

    def __init__(self, model: Cegnn, scene: Scene) -> None:
        super().__init__()
        self.model, self.scene = model, scene

    def forward(
        self, profile: Tensor, start: Tensor, direction: Tensor, depth: Tensor
    ) -> tuple[Tensor, Tensor]:
        scene = replace(self.scene, profile=profile[None])
        pokes = Pokes(
            geometry=torch.zeros(1, dtype=torch.int64),
            start=start[None],
            direction=direction[None],
            depth=depth[None],
            modulus=torch.ones(1, dtype=torch.float64),  # the profile's codes tell it of softness
        )
        found = self.model.decode(self.model.encode(scene), pokes)
        return found.displacement[0], found.force[0]


def in_double(model: Cegnn) -> Cegnn:
    """The model with its weights in double precision."""
    return copy.deepcopy(model).double().eval()


def example(scene: Scene) -> tuple[Tensor, ...]:
    """Inputs of one poke."""
    down = torch.tensor([0.0, 0.0, -1.0], dtype=torch.float64)
    return scene.profile[0], scene.points.mean(dim=0), down, torch.tensor(5e-3, dtype=torch.float64)


def difference(session: Any, model: Cegnn, scene: Scene, pokes: Pokes) -> float:
    """Of a session of onnxruntime from torch in double precision, relative to each poke's largest
    displacement, and to its force."""
    with torch.no_grad():
        found = in_double(model)(scene, pokes)
    worst = 0.0
    for k in range(len(pokes.depth)):
        rod = {name: getattr(pokes, name)[k].numpy() for name in INPUTS[1:]}
        u, force = session.run(None, {"profile": scene.profile[pokes.geometry[k]].numpy(), **rod})
        truth = found.displacement[k].numpy()
        worst = max(worst, float(np.abs(u - truth).max() / np.linalg.norm(truth, axis=1).max()))
        worst = max(worst, abs(float(force) / float(found.force[k]) - 1))
    return worst
