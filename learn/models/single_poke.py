"""One poke at a time over one interior, as fast as torch and NumPy go: what a haptic loop calls.

The same numbers as `InvariantGnn.decode` but for rounding. What makes it faster: everything that does not
depend on the poke is made once; features are rows of one buffer that feeds one product; nothing is
concatenated; small arrays are NumPy's, whose operations cost a quarter of torch's, products are torch's; the
rod's surface is looked at near the rod alone.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import silu

from learn.errors import InputError
from learn.models import _contact, _prior
from learn.models._contact import RINGS, WIDTHS
from learn.models._encoder import Encoded, Gathered, Sparse
from learn.models.invariant_gnn import InvariantGnn, _Messages

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

# rows of the buffer: columns of `Contact.point` that they stand for, with their signs
_PLAIN = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (8, 1), (9, 1)]
_BUMPS = [(10 + k, 1) for k in range(10)]
_EXP = [(21, 1), (22, 1), (25, 1), (26, 1)]
_TANH = [(23, -1), (24, -1), (20, 1), (30, 1)]
_UNDER = [(27, 1), (28, 1), (29, 1), (31, 1)]
_OF_POKE = (6, 7)  # the same at all points


class SinglePoke:
    """model: trained; encoded: of the scene, on the CPU; inclusion: row of `encoded.scene.rigid`."""

    @torch.inference_mode()
    def __init__(self, model: InvariantGnn, encoded: Encoded, inclusion: int = 0) -> None:
        if model.takes_clock:
            raise InputError("a model that was trained with time is not offered one poke at a time")
        scene = encoded.scene
        self._matrices = tuple((_matrix(s.mean), _matrix(s.slope)) for s in encoded.stencils)
        self._radius, self._edge = scene.rod_radius, scene.rod_edge / scene.rod_radius
        self._log_modulus, self._force_unit = model.log_modulus, model.force_unit
        self._log_area = torch.log(scene.area).float().numpy()
        self._points = np.ascontiguousarray((scene.points / self._radius).numpy().T)
        self._normals64 = np.ascontiguousarray(scene.normals.numpy().T)
        self._normals = self._normals64.astype(np.float32)
        n = self._points.shape[1]
        code = encoded.code[:, inclusion]
        self._looked = model.look(code).numpy()
        self._code = model.from_code(code)
        self._clear = encoded.clear[:, inclusion].double().numpy()
        vectors = encoded.vectors[:, :, inclusion].transpose(1, 2)  # (3, v, n)
        self._vectors = np.ascontiguousarray(vectors.numpy())
        self._prior = model.prior.coefficients.numpy()

        weight = model.from_point.weight.T
        picked = [row for part in (_PLAIN, _BUMPS, _EXP, _TANH, _UNDER) for row in part]
        mine = torch.stack([sign * weight[column] for column, sign in picked])
        v, seen = len(self._vectors[0]), len(WIDTHS) * self._looked.shape[1]
        first = weight.shape[0] - 2 * v - seen
        self._toward = weight[first : first + seen].numpy()
        self._of_depth = weight[list(_OF_POKE)].numpy()
        self._of_poke = model.from_poke.weight.numpy()
        nothing = torch.zeros(4, weight.shape[1])  # of the direction from the contact, and of the poke
        self._first = torch.cat([mine, nothing, weight[first + seen :]]).contiguous()
        self._own = len(mine)  # the row at which those four begin
        self._ones = np.ones(weight.shape[1], dtype=np.float32)  # a sum by a product
        # one memory, seen from both sides
        self._rows = np.ones((len(self._first), n), dtype=np.float32)
        self._rows_there, self._first_here = torch.from_numpy(self._rows), self._first.numpy()

        self._rings = (RINGS[:, None] * len(RINGS)).numpy()
        self._widths = np.array([[-0.5 * (self._radius / w) ** 2] for w in WIDTHS], dtype=np.float32)
        self._scales = np.array([[[2.5e-3 / w]] for w in WIDTHS], dtype=np.float32)
        self._rounds = [_Round(part, n) for part in model.rounds if isinstance(part, _Messages)]
        leave, head, last = model.leave[0], model.force_head[0], model.force_head[2]
        assert isinstance(leave, nn.Linear)
        assert isinstance(head, nn.Linear)
        assert isinstance(last, nn.Linear)
        self._enter, self._leave = _Layer(model.enter), _Layer(leave)
        self._out, self._out_bias = model.coefficients.weight, model.coefficients.bias[:, None]
        self._head = tuple(t.numpy() for t in (head.weight, head.bias, last.weight[0], last.bias))

    @torch.inference_mode()
    def __call__(
        self, start: Doubles, direction: Doubles, depth: float, modulus: float
    ) -> tuple[Floats, float]:
        """Displacement of the points (n, 3) [m] and size of the force [N].

        start: of the rod's tip at first contact (3,) [m]; direction: unit (3,), both float64; depth [m];
        modulus: small-strain shear modulus [Pa].
        """
        deep = max(depth / self._radius, _contact.TOUCH)
        r64 = self._points - (start / self._radius)[:, None]
        r, push = r64.astype(np.float32), direction.astype(np.float32)
        square = (r * r).sum(axis=0)
        near = np.exp(self._widths * (square - square.min()) + self._log_area)
        near /= near.sum(axis=1, keepdims=True)  # (w, n)
        here = self._normals @ near[0]
        log_deep = math.log(deep + _contact.SHALLOW)
        about, toward = self._about(r, near, here, push, (deep, log_deep, modulus))

        unit, along, aside = self._fill(r, square, push, deep)
        k = self._own
        self._first_here[k : k + 3] = toward @ self._toward
        of_depth = deep / 4 * self._of_depth[0] + log_deep * self._of_depth[1]
        self._first_here[k + 3] = self._of_poke @ about + of_depth
        h = silu(torch.addmm(self._code, self._rows_there.T, self._first), inplace=True)
        h = silu(self._enter(h), inplace=True)
        unit_there, push_there, near_there = (torch.from_numpy(a) for a in (unit, push, near))
        slopes: list[Tensor] = []
        for round_ in self._rounds:
            h, slopes = round_(h, self._matrices, unit_there, push_there, near_there[2:])
        out = silu(self._leave(h), inplace=True)
        amounts = torch.addmm(self._out_bias, self._out, out.T).numpy()  # (outputs, n)
        gates, middle = _contact.N_GATES, 3 + self._vectors.shape[1]
        own = amounts[0] * self._normals + amounts[1] * unit + amounts[2] * push[:, None]
        own += (self._vectors * amounts[3:middle]).sum(axis=1)
        for slope, amount in zip(slopes, np.split(amounts[middle:-gates], len(slopes)), strict=True):
            each = slope.numpy() * np.ascontiguousarray(amount.T)
            own += (each.reshape(-1, each.shape[2]) @ self._ones[: each.shape[2]]).reshape(own.shape)
        own *= self._rows[0]

        soft = float(near[0] @ self._clear)
        smooth = self._smooth(r64, direction, deep, soft, float(here @ push)).astype(np.float32)
        u = own + smooth
        beside = np.flatnonzero(aside < _contact.LAND[1])
        if len(beside):
            place = _contact.Place(
                r.T[beside], push, _column(deep)[0], along[beside], aside[beside], self._edge
            )
            gate = 1 / (1 + np.exp(-amounts[-gates:, beside].T))
            u[:, beside] = _contact.held(place, smooth.T[beside], own.T[beside], gate, np).T
        pooled = (near_there[:2] @ out).numpy().reshape(-1)
        weight, bias, last, last_bias = self._head
        hidden = weight @ np.concatenate([pooled, about]) + bias
        kappa = float(last @ (hidden / (1 + np.exp(-hidden))) + last_bias[0])
        depth = max(depth, 0.0)
        force = modulus * depth * self._radius * self._force_unit * float(np.logaddexp(0, kappa))
        return np.ascontiguousarray((u * np.float32(depth)).T), force

    def _about(
        self, r: Floats, near: Floats, here: Floats, push: Floats, poke: tuple[float, float, float]
    ) -> tuple[Floats, Floats]:
        """Invariants of the poke, and the vectors to where the code is large (3, c), as `Contact.seen`.

        poke: depth over radius, its logarithm as `Contact` has it, modulus [Pa].
        """
        deep, log_deep, modulus = poke
        facing = float(here @ push)
        of_poke = np.array([deep / 4, log_deep, facing, facing * deep / 4], dtype=np.float32)
        known = [] if self._log_modulus is None else [[math.log(modulus) - self._log_modulus]]
        means = near @ self._looked
        moments = ((self._scales * near[:, None] * r).reshape(-1, r.shape[1]) @ self._looked).reshape(
            len(WIDTHS), 3, -1
        )
        toward = moments.transpose(1, 0, 2).reshape(3, -1)
        parts = [of_poke, means.reshape(-1), push @ toward, here @ toward, *known]
        return np.concatenate(parts, dtype=np.float32), toward

    def _fill(self, r: Floats, square: Floats, push: Floats, deep: float) -> tuple[Floats, Floats, Floats]:
        """The features of all points, a row each; direction from the contact, distances along and aside."""
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
        ring = np.log1p(np.sqrt(square + np.float32(1e-6)) * np.float32(self._radius * 500))
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
        np.sum(self._vectors * unit[:, None], axis=0, out=rows[v : v + w])
        np.matmul(push, self._vectors.reshape(3, -1), out=rows[v + w :].reshape(-1))
        return unit, along, aside

    def _smooth(self, r: Doubles, push: Doubles, deep: float, soft: float, facing: float) -> Doubles:
        """The closed form (3, n), as `Prior.forward`."""
        square = (r * r).sum(axis=0)
        size = np.sqrt(square + 1e-6)
        cores = 1 / np.sqrt(square + np.array([[a * a] for a in _prior.CORES]))
        falls = np.exp(size / np.array([[-length] for length in _prior.RANGES]))
        radial = (cores[:, None] * falls).reshape(-1, len(size))
        lean, part = facing + 0.8, deep / 4
        factors = np.array([1, lean, part, soft, part * lean, part * part, part * soft])
        mixed = np.tensordot(self._prior[:, :-1], factors, axes=(1, 0)).T  # (vectors, radial)
        amounts = np.concatenate([mixed, self._prior[:, -1].T]) @ radial
        unit = r / np.sqrt(square + 1)
        a = amounts[:3] + amounts[3:] * (push @ unit)
        return np.asarray(a[0] * self._normals64 + a[1] * unit + a[2] * push[:, None])


def _column(*values: float) -> Floats:
    return np.array(values, dtype=np.float32)[:, None]


def _matrix(operator: Sparse | Gathered) -> Tensor:
    """Its matrix, with indices of 32 bits, which the product would make of longer ones at every call."""
    assert isinstance(operator, Sparse)
    m = operator.matrix
    rows, columns = m.crow_indices().int(), m.col_indices().int()
    return torch.sparse_csr_tensor(rows, columns, m.values(), size=m.shape, check_invariants=False)


class _Layer:
    """x W + b, the weights as the product wants them."""

    def __init__(self, layer: nn.Linear) -> None:
        self.weight, self.bias = layer.weight.T.contiguous(), layer.bias

    def __call__(self, x: Tensor) -> Tensor:
        return torch.addmm(self.bias, x, self.weight)


class _Round:
    """`_Messages` of one poke."""

    def __init__(self, part: _Messages, n: int) -> None:
        d, hidden = part.directions, part.back.out_features
        self._scales, self._whole = part.scales, part.whole.weight.T.contiguous()
        self._thin, self._mix, self._back = _Layer(part.thin), _Layer(part.mix), _Layer(part.back)
        self._x = torch.empty(n, part.mix.in_features)
        self._hidden, self._m, self._d = hidden, part.thin.out_features - d, d

    def __call__(
        self, h: Tensor, matrices: tuple[tuple[Tensor, Tensor], ...], unit: Tensor, push: Tensor, near: Tensor
    ) -> tuple[Tensor, list[Tensor]]:
        """New h (n, hidden), and the slopes (3, n, directions) of each scale."""
        n, m, d, x = len(h), self._m, self._d, self._x
        x[:, : self._hidden] = h
        thin = self._thin(h)
        scalar, vector = thin[:, :m].contiguous(), thin[:, m:].contiguous()
        u = unit[..., None]
        at, slopes = self._hidden, []
        for k in self._scales:
            mean, slope_of = matrices[k]
            x[:, at : at + m] = torch.mm(mean, scalar)
            slope = torch.mm(slope_of, vector).reshape(3, n, d)
            turned = torch.mul(slope[0], u[0], out=x[:, at + m : at + m + d])
            turned.addcmul_(slope[1], u[1]).addcmul_(slope[2], u[2])
            x[:, at + m + d : at + m + 2 * d] = (push @ slope.reshape(3, -1)).reshape(n, d)
            at += m + 2 * d
            slopes.append(slope)
        whole = near @ h @ self._whole
        mixed = torch.addmm(self._mix.bias + whole[0], x, self._mix.weight)
        new = torch.addmm(h, silu(mixed, inplace=True), self._back.weight).add_(self._back.bias)
        return new, slopes
