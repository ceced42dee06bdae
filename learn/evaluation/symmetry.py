"""How far a model is from turning with its scene."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from scipy.stats import special_ortho_group

from learn.evaluation.cases import Answers
from learn.models import Pokes, Scene


@dataclass(frozen=True)
class TurnError:
    """Largest over points, pokes and rotations: displacement [mm]; force relative to its size."""

    displacement_mm: float
    force: float


@torch.no_grad()
def turn_error(
    model: Answers, scene: Scene, pokes: Pokes, *, about_normal: bool = False, rotations: int = 5
) -> TurnError:
    """Against random rotations about any axis and translations by up to 0.1 m.

    about_normal: quarter turns about the vertical alone and no translation, as the paper tests.
    """
    random = np.random.default_rng(0)
    still = model.decode(model.encode(scene, model.prepare(scene)), pokes)
    worst, worst_force = 0.0, 0.0
    for k in range(3 if about_normal else rotations):
        if about_normal:
            turn = np.linalg.matrix_power(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), k + 1)
            shift = np.zeros(3)
        else:
            turn, shift = special_ortho_group.rvs(3, random_state=random), random.uniform(-0.1, 0.1, 3)
        q, t = torch.from_numpy(turn), torch.from_numpy(shift)
        turned = replace(scene, points=scene.points @ q.T + t, normals=scene.normals @ q.T)
        rod = replace(pokes, start=pokes.start @ q.T + t, direction=pokes.direction @ q.T)
        moved = model.decode(model.encode(turned, model.prepare(turned)), rod)
        apart = (moved.displacement.double() - still.displacement.double() @ q.T).norm(dim=2).max()
        worst = max(worst, float(apart) * 1e3)
        worst_force = max(worst_force, float(((moved.force - still.force) / still.force).abs().max()))
    return TurnError(worst, worst_force)
