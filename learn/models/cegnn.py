"""The paper's conditional equivariant graph network, as far as its public description goes: the baseline.

After arXiv 2509.10125 and its successor: k = 5 nearest neighbours counting the point itself, found again at
each of 4 layers that share one set of weights; width 64, SiLU; h of 128 stiffness values and 128 heights.
Not public, and chosen here: coordinates in units of 10 mm in the block's own frame; heights in the same
units; C_h is the columns (values, then heights) under the points nearest to start and end of the rod's path;
outputs in units of the training part's root mean square. It is not equivariant: phi_s, phi_t and the heads
act on coordinates, as published. The first linear map of an edge is applied to its two points before they are
gathered, and that of the head once per poke to the inputs common to all points, which only changes the speed.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn.functional import linear, silu

from learn.data.statistics import Statistics
from learn.models.base import Model, register_model
from learn.models.scene import Pokes, Response, Scene

UNIT = 1e-2  # m
NEIGHBOURS = 5  # the point itself is one
LAYERS = 4
HIDDEN = 64
_TIE = {torch.float32: 1e-7, torch.float64: 1e-14}  # added to squared distances per index, to break ties


@dataclass(frozen=True, eq=False)
class CegnnEncoded:
    """points (n, 3) in units of 10 mm; columns (g, n, 2 levels): stiffness values, then heights."""

    scene: Scene
    points: Tensor
    columns: Tensor


@register_model("cegnn", version=1)
class Cegnn(Model):
    """The paper's model."""

    def __init__(self, statistics: Statistics, *, levels: int = 128, dropout: float = 0.2) -> None:
        super().__init__()
        self.displacement_unit, self.force_unit = statistics.displacement, statistics.force_rms
        wide = 2 * levels
        self.edge_i = nn.Linear(wide, HIDDEN)
        self.edge_j = nn.Linear(wide, HIDDEN, bias=False)
        self.edge_distance = nn.Linear(1, HIDDEN, bias=False)
        self.edge_out = nn.Linear(HIDDEN, HIDDEN)
        self.phi_x = _mlp(HIDDEN, HIDDEN, 1)
        self.phi_h = _mlp(wide + HIDDEN, HIDDEN, wide)
        self.phi_s = _mlp(3, 64, 3)
        self.phi_t = _mlp(3, 64, 3)
        self.head = _mlp(3 * LAYERS + 6 + 2 * wide, 512, 256, 128, 3)
        self.force_point = nn.Sequential(_mlp(3 + wide, 128, 128), nn.SiLU())
        self.force_head = nn.Sequential(
            nn.Linear(256, 512), nn.SiLU(), nn.Dropout(dropout), nn.Linear(512, 256), nn.SiLU(),
            nn.Dropout(dropout), nn.Linear(256, 128), nn.SiLU(), nn.Linear(128, 1),
        )  # fmt: skip

    def encode(self, scene: Scene, prepared: object = None) -> CegnnEncoded:  # noqa: ARG002
        """Columns and coordinates; nothing is learned here."""
        digits = self.edge_i.weight.dtype
        points = (scene.points / UNIT).to(digits)
        heights = ((scene.points[:, 2:] - scene.level_depth) / UNIT).to(digits)
        columns = torch.cat([scene.profile.to(digits), heights[None].expand_as(scene.profile)], dim=2)
        return CegnnEncoded(scene, points, columns)

    def decode(self, encoded: CegnnEncoded, pokes: Pokes) -> Response:
        """Displacement and force of b pokes."""
        b, n = len(pokes.depth), len(encoded.points)
        digits = encoded.points.dtype
        start = (pokes.start / UNIT).to(digits)
        end = ((pokes.start + pokes.depth[:, None] * pokes.direction) / UNIT).to(digits)
        x = encoded.points[None].expand(b, n, 3)
        h = encoded.columns[pokes.geometry]
        at_start, at_end = (h[torch.arange(b), _nearest(encoded.points, c)] for c in (start, end))
        columns, layers = h, []
        for _ in range(LAYERS):
            index = _neighbours(x)
            offset = x[:, :, None] - _gather(x, index)
            first = (
                self.edge_i(h)[:, :, None]
                + _gather(self.edge_j(h), index)
                + self.edge_distance(offset.square().sum(dim=3, keepdim=True))
            )
            message = silu(self.edge_out(silu(first)))
            step = (offset * self.phi_x(message)).sum(dim=2) / (NEIGHBOURS - 1)
            x = x + step + self.phi_s(x - start[:, None]) + self.phi_t(x - end[:, None])
            h = h + self.phi_h(torch.cat([h, message.sum(dim=2)], dim=2))
            layers.append(x)
        path = torch.cat([start, end, at_start, at_end], dim=1)
        u = self._head(torch.cat(layers, dim=2), path) * self.displacement_unit
        moved = encoded.points + u / UNIT - end[:, None]
        around = columns - at_start[:, None]
        points = self.force_point(torch.cat([moved, around], dim=2))
        pooled = torch.cat([points.amax(dim=1), points.mean(dim=1)], dim=1)
        return Response(displacement=u, force=self.force_head(pooled)[:, 0] * self.force_unit)

    def _head(self, layers: Tensor, path: Tensor) -> Tensor:
        """The head of layers (b, n, 12) and path (b, c); the path is mapped once per poke."""
        first, *others = self.head
        assert isinstance(first, nn.Linear)
        of_layers, of_path = first.weight.split([layers.shape[2], path.shape[1]], dim=1)
        u = linear(layers, of_layers) + linear(path, of_path, first.bias)[:, None]
        for part in others:
            u = part(u)
        return u


def _mlp(*widths: int) -> nn.Sequential:
    layers: list[nn.Module] = []
    for a, b in itertools.pairwise(widths):
        layers += [nn.Linear(a, b), nn.SiLU()]
    return nn.Sequential(*layers[:-1])


def _nearest(points: Tensor, places: Tensor) -> Tensor:
    return _squared_distances(places, points).argmin(dim=1)


def _neighbours(x: Tensor) -> Tensor:
    """Indices (b, n, k) of the k nearest points, the point itself among them.

    Ties, which occur at the edge of a grid, go to the lower index and not by rounding.
    """
    order = torch.arange(x.shape[1], dtype=x.dtype, device=x.device) * _TIE[x.dtype]
    with torch.no_grad():  # sample by sample, so that the distances stay in the cache
        found = [
            (_squared_distances(part, part) + order).topk(NEIGHBOURS, dim=1, largest=False).indices
            for part in x.detach()
        ]
    return torch.stack(found)


def _squared_distances(a: Tensor, b: Tensor) -> Tensor:
    """Squared distances (n, m) of points a (n, 3) and b (m, 3), from differences: products lose digits."""
    x, y, z = (a[:, None, k] - b[None, :, k] for k in range(3))
    return x * x + y * y + z * z


def _gather(values: Tensor, index: Tensor) -> Tensor:
    """Values (b, n, c) at neighbours (b, n, k): (b, n, k, c)."""
    b, n, k = index.shape
    flat = index.reshape(b, n * k, 1).expand(-1, -1, values.shape[2])
    return values.gather(1, flat).reshape(b, n, k, -1)
