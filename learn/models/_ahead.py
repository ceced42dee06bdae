"""Rigid fraction and distance of the interior ahead of the indenter, along the direction of the push.

The cover below the contact does not say what an inclined indenter meets, nor whether one that goes down near
a rim meets the inclusion or passes it. `blocked` takes samples along the push, each a mean over the columns
near the axis; `of_path` makes invariants of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from learn.models.scene import Scene

WIDTHS = (1.5e-3, 3e-3)  # m; standard deviations of the means over columns near the axis
STEP = 1e-3  # m between samples along the push
WAY = (np.arange(30) + 0.5) * STEP  # m from first contact to each sample
BEYOND = (0.0, 1e-3, 2e-3, 4e-3, 8e-3)  # m beyond the indenter's tip, where the invariants look
N_AHEAD = len(WIDTHS) * (3 + len(BEYOND))
_DIGITS = 6.0  # standard deviations beyond which a column has no weight in single precision
LAYERS = 32  # of a column; the stored levels are averaged over them

# The mean of 1 / s over the axis's neighbourhood, s the way to what is rigid: if a fraction B_k of it is
# blocked at sample k, the sum of (B_k - B_(k-1)) / s_k with s_k between the two samples. What is free counts
# as blocked right after the last.
_BETWEEN = np.append(STEP / 4, WAY + STEP / 2)
_FALL = 1 / _BETWEEN[:-1] - 1 / _BETWEEN[1:]
_END = 1 / _BETWEEN[-1]
_WAY32, _FALL32, _BEYOND32 = (np.asarray(v, dtype=np.float32) for v in (WAY, _FALL, BEYOND))


def layers_of(rigid: Tensor) -> Tensor:
    """Rigid fraction of each layer of each column, (n, k, LAYERS + 1), from masks (k, n, levels).

    The last layer is the base, which is rigid.
    """
    k, n, levels = rigid.shape
    mean = rigid.reshape(k, n, LAYERS, levels // LAYERS).mean(dim=3)
    return torch.cat([mean, torch.ones_like(mean[..., :1])], dim=2).permute(1, 0, 2).contiguous()


def blocked(
    offset: Tensor, normals: Tensor, log_area: Tensor, layers: Tensor, push: Tensor, height: float
) -> Tensor:
    """Fraction of the tissue about the axis that is rigid at or before each sample of the way.

    Parameters
    ----------
    offset : vector from first contact to each point [m], shape (n, b, 3), float64.
    normals : normals of the points, shape (n, 3), float64.
    log_area : logarithms of the points' areas, shape (n,), float64.
    layers : rigid fractions under the points, shape (n, b, LAYERS + 1).
    push : unit directions, shape (b, 3), float64.
    height : height of the columns [m].

    Returns
    -------
    Tensor, shape (len(WIDTHS), b, len(WAY)), float32
    """
    way = torch.as_tensor(WAY, device=offset.device)
    down = (offset * normals[:, None]).sum(dim=2)[..., None]  # depth of first contact below each point
    sink = -(normals[:, None] * push).sum(dim=2)[..., None]  # depth over way
    along = (offset * push).sum(dim=2)[..., None]
    z = down + sink * way  # (n, b, s)
    square = offset.square().sum(dim=2)[..., None] - 2 * along * way + way.square() - z.square()
    place = (z * (LAYERS / height) - 0.5).clamp(0, LAYERS)
    low = place.floor().clamp(max=LAYERS - 1)
    part, low = (place - low).float(), low.long()
    rigid = torch.gather(layers, 2, low) * (1 - part) + torch.gather(layers, 2, low + 1) * part
    found = []
    for width in WIDTHS:
        weight = torch.softmax((log_area[:, None, None] - square / (2 * width**2)).float(), dim=0)
        found.append((weight * rigid).sum(dim=0))
    rigid = torch.stack(found)
    before = torch.ones(len(WAY), len(WAY), dtype=torch.bool, device=rigid.device).tril()
    return (rigid[:, :, None] * before).amax(dim=3)  # a running maximum; ONNX has no operation for it


class OneContact:
    """`blocked` of one contact at a time over one interior, in NumPy.

    Parameters
    ----------
    scene : the points above the interior.
    layers : rigid fractions under the points, shape (n, LAYERS + 1).
    """

    def __init__(self, scene: Scene, layers: Tensor) -> None:
        self._normals = np.ascontiguousarray(scene.normals.numpy().T)
        self._roughly = self._normals.astype(np.float32)
        self._area = scene.area.float().numpy()[:, None]
        rigid = layers.numpy()
        # of each layer of each column, in one row: rigid fraction, and what the next layer adds to it
        self._layers = np.ascontiguousarray(rigid[:, :-1]).reshape(-1)
        self._more = np.ascontiguousarray(np.diff(rigid, axis=1)).reshape(-1)
        self._per_height = LAYERS / scene.height
        widths = np.array(WIDTHS)[:, None, None]
        self._exponents = (-0.5 / widths**2).astype(np.float32)

    def __call__(self, offset: NDArray[np.float64], push: NDArray[np.float64]) -> NDArray[np.float32]:
        """Fraction of the tissue about the axis that is rigid, (widths, samples); `offset` (3, n) [m]."""
        way, few = WAY, self._near(offset.astype(np.float32), push.astype(np.float32))
        offset, normals = offset[:, few], self._normals[:, few]
        down, sink, along = ((offset * normals).sum(axis=0), -(push @ normals), push @ offset)
        whole = (offset * offset).sum(axis=0)[:, None]
        z = down[:, None] + sink[:, None] * way
        square = whole + way * (way - 2 * along[:, None]) - z * z
        place = np.minimum(np.maximum(z * self._per_height - 0.5, 0), LAYERS)
        low = np.minimum(place.astype(np.intp), LAYERS - 1)
        part = (place - low).astype(np.float32)
        low += few[:, None] * LAYERS
        rigid = self._layers.take(low, mode="clip") + part * self._more.take(low, mode="clip")
        apart = (square - square.min(axis=0)).astype(np.float32)
        weight = np.exp(apart * self._exponents) * self._area[few]
        found = (weight * rigid).sum(axis=1) / weight.sum(axis=1)
        return np.asarray(np.maximum.accumulate(found, axis=1))

    def _near(self, offset: NDArray[np.float32], push: NDArray[np.float32]) -> NDArray[np.intp]:
        """Columns near the axis; the others are too far from it for any digit of the means."""
        first, last = np.float32(WAY[0]), np.float32(WAY[-1])
        down, sink, along = (offset * self._roughly).sum(axis=0), -(push @ self._roughly), push @ offset
        whole = (offset * offset).sum(axis=0)
        nearest = (along + sink * down) / np.maximum(1 - sink * sink, np.float32(1e-6))
        nearest = np.minimum(np.maximum(nearest, first), last)
        square, *ends = (
            whole + at * (at - 2 * along) - np.square(down + sink * at) for at in (nearest, first, last)
        )
        limit = max(end.min() for end in ends) + (_DIGITS * WIDTHS[-1]) ** 2
        return np.flatnonzero(square <= limit)


def clear(blocked: Any, radius: float) -> Any:
    """Way to what is rigid, in indenter radii: a harmonic mean, as of the cover, (len(WIDTHS), ...)."""
    fall: Any = _FALL32 if isinstance(blocked, np.ndarray) else torch.as_tensor(_FALL32).to(blocked)
    return 1 / (((blocked * fall).sum(-1) + _END) * radius)


def of_path(blocked: Tensor, depth: Tensor, radius: float) -> list[Tensor]:
    """Invariants of what lies ahead, lengths in indenter radii, N_AHEAD tensors shaped as `depth`.

    Parameters
    ----------
    blocked : shape (len(WIDTHS), ..., len(WAY)).
    depth : travel since first contact in indenter radii, shape (...).
    radius : radius of the indenter [m].
    """
    way, beyond = (torch.as_tensor(v).to(blocked) for v in (_WAY32, _BEYOND32))
    at = torch.clip((depth * radius)[..., None] + beyond, WAY[0], WAY[-1])
    hat = torch.clip(1 - abs(way - at[..., None]) / STEP, 0.0, None)  # interpolates between two samples
    return invariants(clear(blocked, radius), depth, (blocked[..., None, :] * hat).sum(-1))


def invariants(clear: Any, depth: Any, there: Any, xp: Any = torch) -> list[Any]:
    """Invariants from the way to what is rigid, the depth, and what is rigid at `BEYOND`, as in `of_path`."""
    return [
        value
        for log, inverse, over, seen in zip(xp.log(clear / 4), 1 / clear, depth / clear, there, strict=True)
        for value in (log, inverse, over, *(seen[..., k] for k in range(len(BEYOND))))
    ]
