"""The response at any points of the top face, such as a lab's markers.

A network knows clouds as dense and as even as the grid that it was trained on: on scattered points its errors
are larger, the more so the denser they lie (studies/learning/at-points.md). So each point takes the place of
the grid point in whose cell it lies, in as many clouds as the fullest cell has points. The force is that of
the grid, whatever the points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import Setup
from learn.data.clouds import nearest_columns
from learn.models.base import Model
from learn.models.scene import Pokes, Response, Scene, over_same_columns

Floats = NDArray[np.float64]
_SAME = 1e-9  # m; a point this near to the grid's is that point


@dataclass(frozen=True, eq=False, kw_only=True)
class Placement:
    """Clouds like the grid that hold n points among them.

    Attributes
    ----------
    clouds : the grid, and the grid with some of its points replaced, each (grid points, 3) [m].
    cloud, index : the cloud of each point, and its place in it, both (n,).
    """

    clouds: list[Floats]
    cloud: NDArray[np.int64]
    index: NDArray[np.int64]

    def pick(self, values: Sequence[NDArray[np.generic]]) -> NDArray[np.generic]:
        """Values of the points, (b, n, ...), from those of each cloud, (b, grid points, ...)."""
        out = np.empty((len(values[0]), len(self.cloud), *values[0].shape[2:]), dtype=values[0].dtype)
        for k in np.unique(self.cloud):
            mine = self.cloud == k
            out[:, mine] = values[k][:, self.index[mine]]
        return out


def place(setup: Setup, points: Floats) -> Placement:
    """Place points (n, 3) of the top face [m] among those of the grid."""
    cell = nearest_columns(setup, points)
    cloud = np.zeros(len(points), dtype=np.int64)
    moved = np.flatnonzero(np.abs(points - setup.points[cell]).max(axis=1, initial=0.0) > _SAME)
    order = moved[np.argsort(cell[moved], kind="stable")]
    cloud[order] = 1 + np.arange(len(order)) - np.searchsorted(cell[order], cell[order])
    clouds = [setup.points]
    for k in range(1, int(cloud.max(initial=0)) + 1):
        clouds.append(setup.points.copy())
        clouds[-1][cell[cloud == k]] = points[cloud == k]
    return Placement(clouds=clouds, cloud=cloud, index=cell)


@torch.no_grad()
def respond_at(model: Model, setup: Setup, scene: Scene, pokes: Pokes, points: Floats) -> Response:
    """Response at points (n, 3) of the top face [m]; `scene` is that of the setup's grid, on the CPU."""
    placed = place(setup, points)
    found = [model(over_same_columns(scene, setup, cloud), pokes) for cloud in placed.clouds]

    def picked(values: list[torch.Tensor]) -> torch.Tensor:
        return torch.from_numpy(placed.pick([v.numpy() for v in values]))

    spread = [one.spread for one in found if one.spread is not None]
    return replace(
        found[0],
        displacement=picked([one.displacement for one in found]),
        spread=picked(spread) if spread else None,
    )
