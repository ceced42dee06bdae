"""The geometry encoder: the interior under and around each point, computed once per geometry.

Messages are weighted means over neighbourhoods, and means of directions (slopes). The weight falls smoothly
to zero at the neighbourhood's edge, so that rounding in a rotated scene has no effect on which points
contribute there, and a mean over a denser cloud tends to the same integral.
"""

from __future__ import annotations

import functools
import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
import torch
from numpy.typing import NDArray
from scipy.spatial import KDTree
from torch import Tensor, nn

from learn.models import _ahead
from learn.models.scene import Scene

RADII = (6.2e-3, 12.4e-3, 25e-3)  # [m], radii of the neighbourhoods
BINS = 16  # bins of the profile's levels


class _Product(torch.autograd.Function):
    """A constant sparse matrix times a dense one (torch's own has no fast gradient).

    The product is in float32 even under mixed precision: sums over many neighbours that nearly cancel lose
    their digits in bfloat16, and not every device has sparse products of it.
    """

    @staticmethod
    def forward(ctx: Any, sparse: Sparse, values: Tensor) -> Tensor:
        ctx.sparse = sparse
        with torch.autocast(values.device.type, enabled=False):
            return torch.mm(sparse.matrix, values)

    @staticmethod
    def backward(ctx: Any, *gradient: Tensor) -> tuple[None, Tensor]:
        with torch.autocast(gradient[0].device.type, enabled=False):
            return None, torch.mm(ctx.sparse.transposed, gradient[0].contiguous())


@dataclass(frozen=True, eq=False)
class Sparse:
    """A constant sparse matrix (rows, n), applied to values (n, columns)."""

    matrix: Tensor

    def __call__(self, values: Tensor) -> Tensor:
        product: Tensor = _Product.apply(self, values.float())
        return product

    @functools.cached_property
    def transposed(self) -> Tensor:
        """The transposed matrix, made when a gradient is first asked for: it takes as long as the matrix."""
        m = self.matrix
        parts = (t.cpu().numpy() for t in (m.values(), m.col_indices(), m.crow_indices()))
        found = scipy.sparse.csr_array(tuple(parts), shape=(m.shape[0], m.shape[1])).T.tocsr()
        return _torch(found.data, found.indices, found.indptr, found.shape[1]).to(m.device)

    def to(self, device: torch.device | str) -> Sparse:
        found = Sparse(self.matrix.to(device))
        if torch.device(device).type != "cpu":  # made there, a backward pass would wait for the device
            vars(found)["transposed"] = self.transposed.to(device)
        return found


@dataclass(frozen=True, eq=False)
class Gathered:
    """The product of `Sparse` by gathering neighbours, for runtimes without sparse products (ONNX).

    `index` (n, neighbours) and `weight` (n, parts, neighbours) are padded with weights of zero: rows k,
    k + n, ... of the matrix (`parts` of them) have the same neighbours, which are gathered once.
    """

    index: Tensor
    weight: Tensor

    def __call__(self, values: Tensor) -> Tensor:
        n, k = self.index.shape
        near = values.index_select(0, self.index.reshape(-1)).reshape(n, k, -1)
        found = torch.matmul(self.weight, near)  # (n, parts, columns)
        return found.permute(1, 0, 2).reshape(-1, values.shape[1])

    def to(self, device: torch.device | str) -> Gathered:
        return Gathered(self.index.to(device), self.weight.to(device))


@dataclass(frozen=True, eq=False)
class Stencil:
    """Neighbourhoods of one radius.

    `mean`: (n, c) -> (n, c). `slope`: (n, c) -> (3 n, c), the components of the mean of (x_j - x_i) / radius
    times the value at j, x of all points first.
    """

    mean: Sparse | Gathered
    slope: Sparse | Gathered

    def to(self, device: torch.device | str) -> Stencil:
        return Stencil(self.mean.to(device), self.slope.to(device))


def stencil(points: NDArray[np.float64], radius: float, area: NDArray[np.float64]) -> Stencil:
    """Stencil of a cloud (n, 3) [m]: each point and its neighbours within `radius` [m], area-weighted."""
    n = len(points)
    pairs = KDTree(points).query_pairs(radius, output_type="ndarray")
    own = np.arange(n)
    row = np.concatenate([pairs[:, 0], pairs[:, 1], own])
    column = np.concatenate([pairs[:, 1], pairs[:, 0], own])
    # sorted by row and column once: the mean and the three slopes have the same neighbours
    row, column = np.divmod(np.sort(row * n + column), n)
    start = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=n))])
    # component by component: a gather of whole points takes four times as long
    offset = np.stack([(x[column] - x[row]) / radius for x in np.ascontiguousarray(points.T)])
    away = offset[0] ** 2 + (offset[1] ** 2 + offset[2] ** 2)
    weight = area[column] * (1 - np.minimum(away, 1)) ** 2
    weight /= np.bincount(row, weight, minlength=n)[row]
    starts = np.concatenate([start[:-1] + k * len(row) for k in range(3)] + [[3 * len(row)]])
    slope = (weight * offset).ravel()
    mean = _torch(weight.astype(np.float32), column, start, n)
    three = _torch(slope.astype(np.float32), np.tile(column, 3), starts, n)
    return Stencil(Sparse(mean), Sparse(three))


def gathered(s: Stencil) -> Stencil:
    """Convert a stencil of sparse matrices to one that gathers."""
    assert isinstance(s.mean, Sparse)
    assert isinstance(s.slope, Sparse)
    mean = s.mean.matrix
    n = mean.shape[0]
    start, column = mean.crow_indices().numpy(), mean.col_indices().numpy()
    counts = np.diff(start)
    index = np.zeros((n, counts.max()), dtype=np.int64)
    place = np.arange(index.shape[1])[None, :] < counts[:, None]
    index[place] = column
    weight = np.zeros((n, 4, index.shape[1]), dtype=np.float32)
    weight[:, 0][place] = mean.values().numpy()
    # a row of the slope has the mean's neighbours, in the same order
    slope = s.slope.matrix.values().numpy().reshape(3, -1)
    for k in range(3):
        weight[:, k + 1][place] = slope[k]
    where, w = torch.from_numpy(index), torch.from_numpy(weight)
    return Stencil(Gathered(where, w[:, :1].contiguous()), Gathered(where, w[:, 1:].contiguous()))


def _torch(values: NDArray[np.float32], column: NDArray[Any], start: NDArray[Any], columns: int) -> Tensor:
    """Matrix of rows that are sorted by column, each from its `start`."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Sparse CSR tensor support is in beta")
        # torch 2.7 to 2.12 warn whatever `check_invariants` is
        warnings.filterwarnings("ignore", "Sparse invariant checks are implicitly disabled")
        return torch.sparse_csr_tensor(
            torch.from_numpy(start.astype(np.int64, copy=False)),
            torch.from_numpy(column.astype(np.int64, copy=False)),
            torch.from_numpy(values),
            size=(len(start) - 1, columns),
            check_invariants=False,
        )


@dataclass(frozen=True, eq=False)
class Encoded:
    """Encoded scene of k inclusions under n points.

    `code` (n, k, c) is invariant, `vectors` (3, n, k, v) rotate with the scene, `clear` (n, k) is the
    fraction of each column above the inclusion, `layers` (n, k, LAYERS + 1) the rigid fraction of its layers;
    `stencils` are the cloud's neighbourhoods at `RADII`.
    """

    scene: Scene
    stencils: tuple[Stencil, ...]
    code: Tensor
    vectors: Tensor
    clear: Tensor
    layers: Tensor


def stencils_of(scene: Scene) -> tuple[Stencil, ...]:
    """The cloud's neighbourhoods; they depend on its points alone."""
    points, area = scene.points.cpu().numpy(), scene.area.cpu().numpy()
    return tuple(stencil(points, radius, area).to(scene.points.device) for radius in RADII)


class GeometryEncoder(nn.Module):
    """Two rounds of messages over three scales, then the slopes of the code as vectors.

    `height` [m] is the unit of depths below the surface, so that blocks of different heights are told apart;
    None: the height of each block itself.
    """

    def __init__(
        self, *, profile: int = 8, code: int = 24, vectors: int = 8, height: float | None = None
    ) -> None:
        super().__init__()
        self.height = height
        self.profile = nn.Sequential(nn.Linear(BINS + 2, 32), nn.SiLU(), nn.Linear(32, profile))
        wide = profile + 1
        self.first = _Round(wide, 16)
        self.second = _Round(16 + 1, code)
        self.narrow = nn.Linear(code, vectors)
        self.n_code, self.n_vectors = code, vectors * 2

    def forward(self, scene: Scene, stencils: tuple[Stencil, ...]) -> Encoded:
        """Codes and vectors of every inclusion of the scene."""
        levels = scene.rigid.shape[2]
        units = scene.height / (self.height or scene.height)
        rigid = scene.rigid if math.isclose(units, 1.0) else _to_height(scene.rigid, units)
        binned = rigid.reshape(*rigid.shape[:2], BINS, levels // BINS).mean(dim=3)
        # thickness of the column above the inclusion, and of the rigid part
        clear = (scene.rigid.cumsum(dim=2) < 0.5).float().mean(dim=2, keepdim=True) * units
        share = scene.rigid.mean(dim=2, keepdim=True) * units
        values = self.profile(torch.cat([binned, clear, share], dim=2)).permute(1, 0, 2)
        normals = scene.normals.float().T[:, :, None, None]
        # a constant channel, whose slope marks the edge of the cloud
        h = torch.nn.functional.silu(self.first(_with_one(values), stencils, normals))
        code = self.second(_with_one(h), stencils, normals)
        thin = self.narrow(code)
        vectors = torch.cat([slopes(s, thin) for s in stencils[1:]], dim=3)
        layers = _ahead.layers_of(scene.rigid)
        return Encoded(scene, stencils, code, vectors, clear[..., 0].T, layers)


def _to_height(rigid: Tensor, units: float) -> Tensor:
    """Masks (k, n, levels) of a column `units` high at the levels of one of unit height.

    Below the block, on whose base the tissue is fixed, everything is rigid.
    """
    levels = rigid.shape[2]
    level = ((torch.arange(levels, device=rigid.device) + 0.5) / units).long()
    found = rigid.index_select(2, level.clamp(max=levels - 1))
    return torch.where(level < levels, found, torch.ones_like(found))


class _Round(nn.Module):
    """Round of messages: means and slopes at every scale enter a small network at each point."""

    def __init__(self, wide: int, out: int) -> None:
        super().__init__()
        self.mix = nn.Sequential(nn.Linear(wide * (1 + 3 * len(RADII)), 48), nn.SiLU(), nn.Linear(48, out))

    def forward(self, values: Tensor, stencils: tuple[Stencil, ...], normals: Tensor) -> Tensor:
        parts = [values]
        for s in stencils:
            slope = slopes(s, values)
            parts += [means(s, values), slope.square().sum(dim=0), (slope * normals).sum(dim=0)]
        out: Tensor = self.mix(torch.cat(parts, dim=2))
        return out


def means(s: Stencil, values: Tensor) -> Tensor:
    """Neighbourhood means of (n, b, c)."""
    n, b, c = values.shape
    return s.mean(values.reshape(n, b * c)).reshape(n, b, c)


def slopes(s: Stencil, values: Tensor) -> Tensor:
    n, b, c = values.shape
    return s.slope(values.reshape(n, b * c)).reshape(3, n, b, c)


def _with_one(values: Tensor) -> Tensor:
    return torch.cat([values, torch.ones_like(values[..., :1])], dim=2)
