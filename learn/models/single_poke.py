"""Fast prediction of one poke at a time over one interior, for haptic loops.

Results equal those of `InvariantGnn.decode` to rounding. It is faster for these reasons: everything that does
not depend on the poke is computed once; a channel is a row of all points, so that each operation runs along
them, and products write where the next one reads; small arrays use NumPy, whose operations cost a quarter of
torch's, products use torch; the rod's surface is evaluated near the rod alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import silu

from learn.errors import InputError
from learn.models import _ahead, _contact, _prior
from learn.models._contact import RINGS, WIDTHS
from learn.models._encoder import RADII, Encoded, Gathered, Sparse, Stencil
from learn.models.invariant_gnn import InvariantGnn, _Messages

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

# columns of `Contact.point` in the rows of the buffer, with their signs
_PLAIN = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (8, 1), (9, 1)]
_BUMPS = [(10 + k, 1) for k in range(10)]
_EXP = [(21, 1), (22, 1), (25, 1), (26, 1)]
_TANH = [(23, -1), (24, -1), (20, 1), (30, 1)]
_UNDER = [(27, 1), (28, 1), (29, 1), (31, 1)]
_OF_POKE = (6, 7)  # the same at all points
_DIGITS = 6.0  # standard deviations beyond which a column has no weight in single precision


class SinglePoke:
    """Predictor of single pokes; `encoded` is on the CPU, `inclusion` is a row of `encoded.scene.rigid`."""

    @torch.inference_mode()
    def __init__(self, model: InvariantGnn, encoded: Encoded, inclusion: int = 0) -> None:
        if model.takes_clock:
            raise InputError("a model that was trained with time is not offered one poke at a time")
        scene = encoded.scene
        self._radius, self._edge = scene.rod_radius, scene.rod_edge / scene.rod_radius
        self._log_modulus, self._force_unit = model.log_modulus, model.force_unit
        self._log_area = torch.log(scene.area).float().numpy()
        self._points = np.ascontiguousarray((scene.points / self._radius).numpy().T)
        self._normals = np.ascontiguousarray(scene.normals.float().numpy().T)
        n = self._points.shape[1]
        code = encoded.code[:, inclusion]
        self._looked = model.look(code).numpy()
        self._code = model.from_code(code).T.contiguous()
        self._clear = encoded.clear[:, inclusion].double().numpy()
        self._per_clear = 1 / np.maximum(self._clear, _contact.LEAST_CLEAR)
        self._column = model.column(scene)
        self._path = _Path(encoded, inclusion)
        vectors = encoded.vectors[:, :, inclusion].transpose(1, 2)  # (3, v, n)
        self._vectors = np.ascontiguousarray(vectors.numpy())
        prior = model.prior.coefficients.numpy()  # (radial, factors, 3)
        self._prior_of_poke = np.ascontiguousarray(prior[:, :-1].transpose(2, 0, 1))
        self._prior = np.concatenate([np.zeros_like(prior[:, 0].T), prior[:, -1].T])  # (6, radial)

        weight = model.from_point.weight.T
        picked = [row for part in (_PLAIN, _BUMPS, _EXP, _TANH, _UNDER) for row in part]
        mine = torch.stack([sign * weight[column] for column, sign in picked])
        v, seen = len(self._vectors[0]), len(WIDTHS) * self._looked.shape[1]
        first = weight.shape[0] - 2 * v - seen
        self._toward = weight[first : first + seen].numpy()
        self._of_depth = weight[list(_OF_POKE)].numpy()
        self._of_poke = model.from_poke.weight.numpy()
        nothing = torch.zeros(4, weight.shape[1])  # for the direction from the contact, and for the poke
        self._first = torch.cat([mine, nothing, weight[first + seen :]]).T.contiguous()
        self._own = len(mine)  # the column at which those four begin
        # memory common to torch and NumPy
        self._rows_there = _channels(self._first.shape[1], n).fill_(1.0)
        self._rows, self._first_here = self._rows_there.numpy(), self._first.numpy()
        self._entered = _channels(len(self._first), n)

        self._rings = (RINGS[:, None] * len(RINGS)).numpy()
        self._widths = np.array([[-0.5 * (self._radius / w) ** 2] for w in WIDTHS], dtype=np.float32)
        self._scales = np.array([[[2.5e-3 / w]] for w in WIDTHS], dtype=np.float32)
        self._rounds: list[_Round] = []
        shift = torch.zeros(model.enter.out_features)
        slopes = 0
        for part in model.rounds:
            assert isinstance(part, _Messages)
            slopes = part.directions * len(part.scales)
            self._rounds.append(_Round(part, encoded.stencils, self._radius, shift))
            shift = shift + part.back.bias
        # vectors that the outputs weight: the constant ones, and memory for those of a poke
        self._basis = np.empty((3, 3 + v + slopes, n), dtype=np.float32)
        self._basis[:, 0], self._basis[:, 3 : 3 + v] = self._normals, self._vectors
        self._products = np.empty_like(self._basis)
        leave, head, last = model.leave[0], model.force_head[0], model.force_head[2]
        assert isinstance(leave, nn.Linear)
        assert isinstance(head, nn.Linear)
        assert isinstance(last, nn.Linear)
        self._enter, self._leave = _Layer(model.enter), _Layer(leave, shift)
        self._out, self._out_bias = model.coefficients.weight, model.coefficients.bias[:, None]
        self._head = tuple(t.numpy() for t in (head.weight, head.bias, last.weight[0], last.bias))

    @torch.inference_mode()
    def __call__(
        self, start: Doubles, direction: Doubles, depth: float, modulus: float
    ) -> tuple[Floats, float]:
        """Displacement of the points (n, 3) [m] and magnitude of the force [N].

        `start`: rod's tip at first contact (3,) [m]; `direction`: unit vector (3,), both float64; `depth`
        [m]; `modulus`: small-strain shear modulus [Pa].
        """
        deep = max(depth / self._radius, _contact.TOUCH)
        r64 = self._points - (start / self._radius)[:, None]
        r, push = r64.astype(np.float32), direction.astype(np.float32)
        square64 = (r64 * r64).sum(axis=0)
        square = square64.astype(np.float32)
        near = np.exp(self._widths * (square - square.min()) + self._log_area)
        near /= near.sum(axis=1, keepdims=True)  # (w, n)
        here = self._normals @ near[0]
        log_deep = math.log(deep + _contact.SHALLOW)
        ahead = _ahead.of_path(self._path(r64, start, direction), np.float64(deep), self._radius)
        about, toward = self._about(r, near, here, push, (deep, log_deep, modulus), ahead)

        unit, along, aside = self._fill(r, square, push, deep)
        k = self._own
        self._first_here[:, k : k + 3] = (toward @ self._toward).T
        of_depth = deep / 4 * self._of_depth[0] + log_deep * self._of_depth[1]
        self._first_here[:, k + 3] = self._of_poke @ about + of_depth
        h = silu(torch.addmm(self._code, self._first, self._rows_there, out=self._entered), inplace=True)
        h = silu(self._enter(h, self._rounds[0].input), inplace=True)
        seen = _Seen(r, unit, push, near[2])
        for k, round_ in enumerate(self._rounds, start=1):
            later = self._rounds[k].input if k < len(self._rounds) else self._entered
            h, slopes = round_(seen, later)
        out = silu(self._leave(h), inplace=True)
        amounts = torch.addmm(self._out_bias, self._out, out).numpy()  # (outputs, n)
        gates, basis = _contact.N_GATES, self._basis
        basis[:, 1], basis[:, 2] = unit, push[:, None]
        basis[:, 3 + self._vectors.shape[1] :] = slopes
        np.multiply(basis, amounts[:-gates], out=self._products)
        own = self._products.sum(axis=1)
        own *= self._rows[0]

        soft = float(near[0] @ self._clear)
        smooth = self._smooth(square64, unit, push, (deep, soft, float(here @ push)))
        u = own + smooth
        beside = np.flatnonzero(aside < _contact.LAND[1])
        if len(beside):
            place = _contact.Place(
                r.T[beside], push, _column(deep)[0], along[beside], aside[beside], self._edge
            )
            gate = 1 / (1 + np.exp(-amounts[-gates:, beside].T))
            u[:, beside] = _contact.held(place, smooth.T[beside], own.T[beside], gate, _OfFew).T
        pooled = [out.numpy() @ weight for weight in near[:2]]
        weight, bias, last, last_bias = self._head
        hidden = weight @ np.concatenate([*pooled, about]) + bias
        kappa = float(last @ (hidden / (1 + np.exp(-hidden))) + last_bias[0])
        depth = max(depth, 0.0)
        force = modulus * depth * self._radius * self._force_unit * float(np.logaddexp(0, kappa))
        return np.ascontiguousarray((u * np.float32(depth)).T), force

    def _about(
        self,
        r: Floats,
        near: Floats,
        here: Floats,
        push: Floats,
        poke: tuple[float, float, float],
        ahead: list[float],
    ) -> tuple[Floats, Floats]:
        """Invariants of the poke, and first moments (3, c) of the code about the contact, as `Contact.seen`.

        `poke`: depth over radius, its logarithm as in `Contact`, modulus [Pa]; `ahead`: `_ahead.of_path`.
        """
        deep, log_deep, modulus = poke
        facing = float(here @ push)
        of_poke = np.array([deep / 4, log_deep, facing, facing * deep / 4], dtype=np.float32)
        cover = self._column / float(near[0] @ self._per_clear)
        known = [_contact.of_cover(cover, deep, facing, np), ahead]
        known += [] if self._log_modulus is None else [[math.log(modulus) - self._log_modulus]]
        means = near @ self._looked
        moments = ((self._scales * near[:, None] * r).reshape(-1, r.shape[1]) @ self._looked).reshape(
            len(WIDTHS), 3, -1
        )
        toward = moments.transpose(1, 0, 2).reshape(3, -1)
        parts = [of_poke, means.reshape(-1), push @ toward, here @ toward, *known]
        return np.concatenate(parts, dtype=np.float32), toward

    def _fill(self, r: Floats, square: Floats, push: Floats, deep: float) -> tuple[Floats, Floats, Floats]:
        """Fill in the features of all points; return direction from contact, distances along and aside."""
        rows = self._rows
        far = np.divide(1, np.sqrt(square + 1), out=rows[0])
        unit, along = r * far, push @ r
        off = r - along * push[:, None]
        aside = np.sqrt((off * off).sum(axis=0) + np.float32(1e-6))
        np.log(far, out=rows[1])
        lift = np.sum(unit * self._normals, axis=0, out=rows[2])
        lean = np.matmul(push, self._normals, out=rows[3])
        turn = np.multiply(along, far, out=rows[4])
        flat = np.subtract(turn, lift * lean, out=rows[5])
        np.multiply(far, np.float32(deep), out=rows[6])
        np.multiply(flat, far, out=rows[7])
        ring = np.log(1 + np.sqrt(square + np.float32(1e-6)) * np.float32(self._radius * 500))
        e = 8 + len(_BUMPS)
        np.subtract(ring * np.float32(len(RINGS) / math.log1p(20.0)), self._rings, out=rows[8:e])
        np.multiply(aside, _column(1, 0.5, 1 / (1 + 0.5 * deep)), out=rows[e : e + 3])
        np.square(aside / np.float32(1.5), out=rows[e + 3])
        exp = rows[8 : e + 4]
        exp *= exp
        exp *= np.float32(-0.5)
        np.exp(exp, out=exp)
        t = e + 4
        go, over = np.float32(deep) - along, (off * self._normals).sum(axis=0)
        np.multiply(go, _column(1, 0.25), out=rows[t : t + 2])
        np.subtract(2, aside + aside, out=rows[t + 2])
        rows[t + 3] = over
        np.multiply(go, _column(1, 4, 1 / deep), out=rows[t + 4 : t + 7])
        np.divide(3 * over, aside, out=rows[t + 7])
        np.tanh(rows[t : t + 8], out=rows[t : t + 8])
        rows[t + 4 : t + 8] *= rows[e + 3]
        rows[self._own : self._own + 3] = unit
        v, w = self._own + 4, len(self._vectors[0])
        turned = np.multiply(self._vectors, unit[:, None], out=self._products[:, :w])
        np.sum(turned, axis=0, out=rows[v : v + w])
        rows[v + w :] = (push @ self._vectors.reshape(3, -1)).reshape(w, -1)
        return unit, along, aside

    def _smooth(
        self, square: Doubles, unit: Floats, push: Floats, poke: tuple[float, float, float]
    ) -> Floats:
        """The closed form (3, n), as `Prior.forward`: sums of terms that nearly cancel, in float64.

        `square`: squared distance from the contact; `poke`: depth, soft fraction of the column, and component
        of the push along the normal.
        """
        deep, soft, facing = poke
        size = np.sqrt(square + 1e-6)
        cores = 1 / np.sqrt(square + np.array([[a * a] for a in _prior.CORES]))
        falls = np.exp(size / np.array([[-length] for length in _prior.RANGES]))
        radial = (cores[:, None] * falls).reshape(-1, len(size))
        lean, part = facing + 0.8, deep / 4
        factors = np.array([1, lean, part, soft, part * lean, part * part, part * soft])
        self._prior[:3] = self._prior_of_poke @ factors
        amounts = (self._prior @ radial).astype(np.float32)
        a = amounts[:3] + amounts[3:] * self._rows[4]
        return np.asarray(a[0] * self._normals + a[1] * unit + a[2] * push[:, None])


class _Path:
    """`_ahead.blocked` of one poke; a poke that only goes deeper has that of the last call."""

    def __init__(self, encoded: Encoded, inclusion: int) -> None:
        scene = encoded.scene
        self._normals = np.ascontiguousarray(scene.normals.numpy().T)
        self._log_area = torch.log(scene.area).numpy()
        self._layers = np.ascontiguousarray(encoded.layers[:, inclusion].numpy())
        self._height, self._radius = scene.height, scene.rod_radius
        self._last: tuple[tuple[float, ...], Floats] | None = None

    def __call__(self, r: Doubles, start: Doubles, push: Doubles) -> Floats:
        """Fraction of the tissue about the axis that is rigid, (widths, samples); `r` in rod radii (3, n)."""
        key = (*start, *push)
        if self._last is None or self._last[0] != key:
            self._last = key, self._blocked(self._radius * r, push)
        return self._last[1]

    def _blocked(self, offset: Doubles, push: Doubles) -> Floats:
        way = _ahead.WAY
        down, sink, along = (offset * self._normals).sum(axis=0), -(push @ self._normals), push @ offset
        whole = (offset * offset).sum(axis=0)
        # columns that are too far from the axis for any digit of the means
        nearest = np.clip((along + sink * down) / np.maximum(1 - sink * sink, 1e-12), way[0], way[-1])
        square, *ends = (
            whole + at * (at - 2 * along) - (down + sink * at) ** 2 for at in (nearest, way[0], way[-1])
        )
        limit = max(end.min() for end in ends) + (_DIGITS * _ahead.WIDTHS[-1]) ** 2
        few = np.flatnonzero(square <= limit)
        down, sink, along, whole = (v[few, None] for v in (down, sink, along, whole))
        z = down + sink * way
        square = whole + way * (way - 2 * along) - z * z
        place = np.clip(z * (_ahead.LAYERS / self._height) - 0.5, 0, _ahead.LAYERS)
        low = np.minimum(place.astype(np.int64), _ahead.LAYERS - 1)
        part, layers = (place - low).astype(np.float32), self._layers[few]
        rows = np.arange(len(few))[:, None]
        rigid = layers[rows, low] * (1 - part) + layers[rows, low + 1] * part
        found = np.empty((len(_ahead.WIDTHS), len(way)), dtype=np.float32)
        for k, width in enumerate(_ahead.WIDTHS):
            log = self._log_area[few, None] - square / (2 * width**2)
            weight = np.exp((log - log.max(axis=0)).astype(np.float32))
            found[k] = (weight * rigid).sum(axis=0) / weight.sum(axis=0)
        return np.maximum.accumulate(found, axis=1)


def _column(*values: float) -> Floats:
    return np.array(values, dtype=np.float32)[:, None]


def _channels(count: int, n: int) -> Tensor:
    """Allocate channels of n points.

    Rows that begin a multiple of 4 KiB apart, as for 1,024 points, would map to the same sets of the
    processor's cache.
    """
    return torch.empty(count, n + 16)[:, :n]


class _Seen(NamedTuple):
    """Points relative to the contact, in rod radii: r and unit (3, n), push (3,), weights near (n,)."""

    r: Floats
    unit: Floats
    push: Floats
    near: Floats


class _OfFew:
    """NumPy functions for `_contact.held`; `np.clip` takes as long as five operations on a few points."""

    sqrt, maximum, minimum, where, tanh = np.sqrt, np.maximum, np.minimum, np.where, np.tanh

    @staticmethod
    def clip(x: Any, low: float | None, high: float | None) -> Any:
        x = x if low is None else np.maximum(x, low)
        return x if high is None else np.minimum(x, high)


class _Layer:
    """Linear layer W (x + shift) + b, of x (c, n)."""

    def __init__(self, layer: nn.Linear, shift: Tensor | None = None) -> None:
        bias = layer.bias if shift is None else layer.bias + layer.weight @ shift
        self.weight, self.bias = layer.weight.contiguous(), bias[:, None].contiguous()

    def __call__(self, x: Tensor, out: Tensor | None = None) -> Tensor:
        return torch.addmm(self.bias, self.weight, x, out=out)


class _Round:
    """`_Messages` of one poke.

    With r from the contact, mean((x_j - x_i) v_j) = mean(r_j v_j) - r_i mean(v_j): one sparse product gives
    means and slopes at all scales. Codes are passed without the biases of earlier rounds' last layers
    (`shift`), which the layers that read them include in their own.

    Attributes
    ----------
    input : memory for the input code (hidden, n).
    """

    def __init__(self, part: _Messages, stencils: tuple[Stencil, ...], unit: float, shift: Tensor) -> None:
        hidden, d = part.back.out_features, part.directions
        m, scales = part.thin.out_features - d, len(part.scales)
        self._m, self._d = m, d
        self._means = _stacked([stencils[k].mean for k in part.scales])
        n = self._means.shape[1]
        self._over_radius = np.array([unit / RADII[k] for k in part.scales], dtype=np.float32)[:, None]
        self._thin, self._back = _Layer(part.thin, shift), part.back.weight.contiguous()
        self._whole, self._mix = part.whole.weight.numpy(), part.mix.weight.contiguous()
        bias = part.mix.bias + part.mix.weight[:, :hidden] @ shift + part.whole(shift)
        self._mix_bias = bias.numpy()
        # memory common to torch and NumPy
        self._x, self._carried = _channels(part.mix.in_features, n), _channels(m + 4 * d, n)
        self._mixed = _channels(hidden, n)
        self.input, self._thinned = self._x[:hidden], self._carried[: m + d]
        self._carried_here = self._carried.numpy()
        self._moved = self._carried[m + d :].unflatten(0, (3, d)).numpy()
        beside = self._x[hidden:].unflatten(0, (scales, m + 2 * d)).numpy()
        self._of_means, self._of_unit, self._of_push = np.split(beside, [m, m + d], axis=1)

    def __call__(self, seen: _Seen, out: Tensor) -> tuple[Tensor, Floats]:
        """The new code, in `out` (hidden, n), and the slopes (3, scales x directions, n)."""
        m, d = self._m, self._d
        thin = self._thin(self.input, self._thinned).numpy()
        np.multiply(seen.r[:, None], thin[m:], out=self._moved)
        wanted = torch.from_numpy(np.ascontiguousarray(self._carried_here.T))
        found = np.ascontiguousarray(torch.mm(self._means, wanted).numpy().T)
        found = found.reshape(m + 4 * d, *self._of_means.shape[::2])  # (channels, scales, n)
        self._of_means[:] = found[:m].swapaxes(0, 1)
        slope = found[m + d :].reshape(3, d, *found.shape[1:])
        slope -= seen.r[:, None, None] * found[m : m + d]
        slope *= self._over_radius
        slope = np.ascontiguousarray(slope.swapaxes(1, 2))  # (3, scales, d, n)
        np.sum(slope * seen.unit[:, None, None], axis=0, out=self._of_unit)
        self._of_push[:] = (seen.push @ slope.reshape(3, -1)).reshape(self._of_push.shape)
        bias = self._mix_bias + self._whole @ (self.input.numpy() @ seen.near)
        mixed = torch.addmm(torch.from_numpy(bias)[:, None], self._mix, self._x, out=self._mixed)
        torch.addmm(self.input, self._back, silu(mixed, inplace=True), out=out)
        return out, slope.reshape(3, -1, slope.shape[-1])


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
