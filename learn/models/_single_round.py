"""One round of messages of a single poke (`learn.models.single_poke`), on memory that all rounds share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import silu

from learn.models._encoder import RADII, Gathered, Sparse, Stencil
from learn.models.invariant_gnn import _Messages

Floats = NDArray[np.float32]


class Round:
    """`_Messages` of one poke.

    With r from the contact, mean((x_j - x_i) v_j) = mean(r_j v_j) - r_i mean(v_j): one sparse product gives
    means and slopes at all scales. Codes are passed without the biases of earlier rounds' last layers
    (`shift`), which the layers that read them include in their own. `x` is the memory that the rounds share:
    a row of ones, the code, and what else a round reads. `axes` is the number of axes along which the surface
    extends: slopes along others are 0, and are not computed.
    """

    def __init__(
        self,
        part: _Messages,
        stencils: tuple[Stencil, ...],
        unit: float,
        shift: Tensor,
        x: Tensor,
        axes: int,
    ) -> None:
        hidden, d = part.back.out_features, part.directions
        m, scales = part.thin.out_features - d, len(part.scales)
        self._m, self._d = m, d
        self._means = _stacked([stencils[k].mean for k in part.scales])
        n = self._means.shape[1]
        self._over_radius = np.array([unit / RADII[k] for k in part.scales], dtype=np.float32)[:, None]
        self._thin, self._back = biased(part.thin, shift), part.back.weight.contiguous()
        self._whole, self._mix = part.whole.weight.numpy(), biased(part.mix)
        self._bias = (part.mix.bias + part.mix.weight[:, :hidden] @ shift + part.whole(shift)).numpy()
        # memory common to torch and NumPy
        self._x, self._biased_h = x[: 1 + part.mix.in_features], x[: 1 + hidden]
        self._h, carried = x[1 : 1 + hidden], channels(m + d + axes * d, n)
        self._mixed = channels(hidden, n)
        self._thinned, self._carried = carried[: m + d], carried.numpy()
        self._moved = carried[m + d :].unflatten(0, (axes, d)).numpy()
        beside = self._x[1 + hidden :].unflatten(0, (scales, m + 2 * d)).numpy()
        self._of_means, self._of_unit, self._of_push = np.split(beside, [m, m + d], axis=1)

    def __call__(self, r: Floats, unit: Floats, push: Floats, near: Floats) -> Floats:
        """Write the new code in place of the old one; return the slopes (axes, scales x directions, n).

        `r`, `unit`, `push` are those of the contact (`learn.models.single_poke`), `near` (n,) the weights of
        the points for the widest mean around it.
        """
        m, d, axes = self._m, self._d, len(r)
        thin = torch.mm(self._thin, self._biased_h, out=self._thinned).numpy()
        np.multiply(r[:, None], thin[m:], out=self._moved)
        wanted = torch.from_numpy(np.ascontiguousarray(self._carried.T))
        found = np.ascontiguousarray(torch.mm(self._means, wanted).numpy().T)
        found = found.reshape(len(found), *self._of_means.shape[::2])  # (channels, scales, n)
        self._of_means[:] = found[:m].swapaxes(0, 1)
        slope = found[m + d :].reshape(axes, d, *found.shape[1:])
        slope -= r[:, None, None] * found[m : m + d]
        slope *= self._over_radius
        self._of_unit[:] = (slope * unit[:, None, None]).sum(axis=0).swapaxes(0, 1)
        self._of_push[:] = (push @ slope.reshape(axes, -1)).reshape(slope.shape[1:]).swapaxes(0, 1)
        self._mix.numpy()[:, 0] = self._bias + self._whole @ (self._h.numpy() @ near)
        mixed = silu(torch.mm(self._mix, self._x, out=self._mixed), inplace=True)
        self._h.addmm_(self._back, mixed)
        return slope.swapaxes(1, 2).reshape(axes, -1, slope.shape[-1])


def channels(count: int, n: int) -> Tensor:
    """Allocate channels of n points.

    Rows that begin a multiple of 4 KiB apart, as for 1,024 points, would map to the same sets of the
    processor's cache.
    """
    return torch.empty(count, n + 16)[:, :n]


def biased(layer: nn.Linear, shift: Tensor | None = None) -> Tensor:
    """Matrix of a linear layer W (x + shift) + b, applied to a row of ones above those of x."""
    bias = layer.bias if shift is None else layer.bias + layer.weight @ shift
    return torch.cat([bias[:, None], layer.weight], dim=1)


def _stacked(operators: Sequence[Sparse | Gathered]) -> Tensor:
    """Matrices stacked by rows, with 32-bit indices, to which each product would convert longer ones."""
    matrices = [operator.matrix for operator in operators if isinstance(operator, Sparse)]
    assert len(matrices) == len(operators)
    rows = [torch.zeros(1, dtype=torch.int32)]
    for m in matrices:
        rows.append(m.crow_indices()[1:].int() + rows[-1][-1])
    return torch.sparse_csr_tensor(
        torch.cat(rows),
        torch.cat([m.col_indices().int() for m in matrices]),
        torch.cat([m.values() for m in matrices]),
        size=(sum(m.shape[0] for m in matrices), matrices[0].shape[1]),
        check_invariants=False,
    )
