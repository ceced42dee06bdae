"""One poke at a time over one interior, as fast as plain torch goes: what a haptic loop calls.

The same numbers as `Surrogate.decode` but for rounding. What makes it faster: everything that does not
depend on the poke is made once; points are the last axis of all small arrays, so that features are rows of
one buffer that feeds one product; nothing is concatenated; the rod's surface is looked at near the rod alone.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn.functional import silu, softplus

from learn.models import _prior, _rod
from learn.models._contact import RINGS, WIDTHS
from learn.models._geometry import Encoded
from learn.models._stencil import Gathered, Sparse
from learn.models.ours import Surrogate, _Messages

# rows of the buffer, and the columns of `Contact.point` that they stand for, with their signs
_PLAIN = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (8, 1), (9, 1)]
_BUMPS = [(10 + k, 1) for k in range(10)]
_EXP = [(21, 1), (22, 1), (25, 1), (26, 1)]
_TANH = [(23, -1), (24, -1), (20, 1), (30, 1)]
_UNDER = [(27, 1), (28, 1), (29, 1), (31, 1)]
_OF_POKE = (6, 7)  # the same at all points


class SinglePoke:
    """model: trained; encoded: of the scene, on the CPU; inclusion: row of `encoded.scene.rigid`."""

    @torch.inference_mode()
    def __init__(self, model: Surrogate, encoded: Encoded, inclusion: int = 0) -> None:
        self._model, scene = model, encoded.scene
        self._matrices = tuple((_matrix(s.mean), _matrix(s.slope)) for s in encoded.stencils)
        self._radius, self._edge = scene.rod_radius, scene.rod_edge / scene.rod_radius
        self._points = (scene.points / self._radius).T.contiguous()
        self._normals64 = scene.normals.T.contiguous()
        self._normals = self._normals64.float()
        n = self._points.shape[1]
        code = encoded.code[:, inclusion]
        self._looked = model.look(code)
        self._code = model.from_code(code)
        self._clear = encoded.clear[:, inclusion].double()
        self._vectors = encoded.vectors[:, :, inclusion].transpose(1, 2).contiguous()  # (3, v, n)
        self._prior = model.prior.coefficients
        weight = model.from_point.weight.T
        picked = [row for part in (_PLAIN, _BUMPS, _EXP, _TANH, _UNDER) for row in part]
        mine = torch.stack([sign * weight[column] for column, sign in picked])
        v, seen = self._vectors.shape[1], len(WIDTHS) * self._looked.shape[1]
        first = weight.shape[0] - 2 * v - seen
        self._toward = weight[first : first + seen].contiguous()
        self._of_depth = weight[list(_OF_POKE)]
        nothing = torch.zeros(4, weight.shape[1])  # of the direction to the contact, and of the poke
        self._first = torch.cat([mine, nothing, weight[first + seen :]]).contiguous()
        self._rows = torch.ones(len(self._first), n)
        self._rings = RINGS[:, None] * len(RINGS)
        self._widths = torch.tensor([-0.5 * (self._radius / w) ** 2 for w in WIDTHS])[:, None]
        self._scales = torch.tensor([2.5e-3 / w for w in WIDTHS])[:, None, None]
        self._rounds = [_Round(part, n) for part in model.rounds if isinstance(part, _Messages)]
        self._enter = _Layer(model.enter)
        leave = model.leave[0]
        assert isinstance(leave, nn.Linear)
        self._leave = _Layer(leave)
        self._out, self._out_bias = model.coefficients.weight, model.coefficients.bias[:, None]

    @torch.inference_mode()
    def __call__(
        self, start: Tensor, direction: Tensor, depth: float, modulus: float
    ) -> tuple[Tensor, float]:
        """Displacement of the points (n, 3) [m] and size of the force [N].

        start: of the rod's tip at first touch (3,) [m]; direction: unit (3,), both float64; depth [m];
        modulus: small-strain shear modulus [Pa].
        """
        radius, model = self._radius, self._model
        deep = depth / radius
        r64 = self._points - (start / radius)[:, None]
        push64, push = direction, direction.float()
        r = r64.float()
        square = (r * r).sum(dim=0)
        near = torch.softmax(self._widths * square, dim=1)  # (w, n)
        here = self._normals @ near[0]
        facing = float(here @ push)
        log_deep, stiff = math.log(deep), math.log(modulus) - model.log_modulus
        of_poke = torch.tensor([deep / 4, log_deep, facing, facing * deep / 4, stiff])
        # the code as the contact sees it
        weights = torch.cat([near[:, None], self._scales * near[:, None] * r], dim=1)  # (w, 4, n)
        seen = (weights.reshape(-1, weights.shape[2]) @ self._looked).reshape(len(WIDTHS), 4, -1)
        toward = seen[:, 1:].transpose(0, 1).reshape(3, -1)
        about = torch.cat([of_poke, seen[:, 0].reshape(-1), push @ toward, here @ toward])

        unit, along, aside = self._fill(r, square, push, deep)
        code = self._first
        k = len(code) - 2 * self._vectors.shape[1] - 4
        code[k : k + 3] = toward @ self._toward
        code[k + 3] = (
            model.from_poke.weight @ about + deep / 4 * self._of_depth[0] + log_deep * self._of_depth[1]
        )
        h = silu(torch.addmm(self._code, self._rows.T, code), inplace=True)
        h = silu(self._enter(h), inplace=True)
        slope = h
        for round_ in self._rounds:
            h, slope = round_(h, self._matrices, unit, push, near[2:])
        out = silu(self._leave(h), inplace=True)
        amounts = torch.addmm(self._out_bias, self._out, out.T)  # (outputs, n)

        own = amounts[0] * self._normals + amounts[1] * unit + amounts[2] * push[:, None]
        middle = 3 + self._vectors.shape[1]
        own += (self._vectors * amounts[3:middle]).sum(dim=1)
        own += torch.einsum("knc,cn->kn", slope, amounts[middle : -_rod.N_GATES])
        smooth = self._smooth(r64, push64, deep, float(near[0].double() @ self._clear), here)
        u = own * self._rows[0] + smooth
        beside = torch.nonzero(aside < _rod.LAND[1])[:, 0]
        if len(beside):
            place = _rod.Place(
                r[:, beside].T[:, None], push[None], torch.tensor([deep]),
                along[beside, None], aside[beside, None], self._edge,
            )  # fmt: skip
            gates = torch.sigmoid(amounts[-_rod.N_GATES :, beside]).T[:, None]
            held = _rod.held(place, smooth[:, beside].T[:, None], (u - smooth)[:, beside].T[:, None], gates)
            u[:, beside] = held[:, 0].T
        pooled = (near[:2] @ out).reshape(-1)
        kappa = model.force_head(torch.cat([pooled, about]))
        force = modulus * depth * radius * model.force_unit * float(softplus(kappa))
        return (u * depth).T, force

    def _fill(self, r: Tensor, square: Tensor, push: Tensor, deep: float) -> tuple[Tensor, Tensor, Tensor]:
        """The features of all points, a row each; direction from the contact, distances along and aside."""
        rows = self._rows
        far = torch.rsqrt(square + 1, out=rows[0])
        unit = r * far
        along = push @ r
        off = r - along * push[:, None]
        aside = (off * off).sum(dim=0).add_(1e-6).sqrt_()
        torch.log(far, out=rows[1])
        lift = torch.sum(unit * self._normals, dim=0, out=rows[2])
        lean = torch.mv(self._normals.T, push, out=rows[3])
        turn = torch.mul(along, far, out=rows[4])
        flat = torch.addcmul(turn, lift, lean, value=-1, out=rows[5])
        torch.mul(far, deep, out=rows[6])
        torch.mul(flat, far, out=rows[7])
        ring = torch.sqrt(square + 1e-6).mul_(self._radius * 1e3 / 2).log1p_()
        e = 8 + len(_BUMPS)
        torch.sub(ring * (len(RINGS) / math.log1p(20.0)), self._rings, out=rows[8:e])
        torch.mul(aside, torch.tensor([[1.0], [0.5], [1 / (1 + 0.5 * deep)]]), out=rows[e : e + 3])
        torch.square(aside / 1.5, out=rows[e + 3])
        exp = rows[8 : e + 4]
        exp.square_().mul_(-0.5).exp_()
        near, t = rows[e + 3], e + 4
        go = deep - along
        over = (off * self._normals).sum(dim=0)
        torch.mul(go, torch.tensor([[1.0], [0.25]]), out=rows[t : t + 2])
        torch.sub(2, aside, alpha=2, out=rows[t + 2])
        rows[t + 3] = over
        torch.mul(go, torch.tensor([[1.0], [4.0], [1 / deep]]), out=rows[t + 4 : t + 7])
        torch.div(over, aside, out=rows[t + 7]).mul_(3)
        rows[t : t + 8].tanh_()
        rows[t + 4 : t + 8] *= near
        t += 8
        rows[t : t + 3] = unit
        v = self._vectors.shape[1]
        torch.sum(self._vectors * unit[:, None], dim=0, out=rows[t + 4 : t + 4 + v])
        rows[t + 4 + v :] = (push @ self._vectors.reshape(3, -1)).reshape(v, -1)
        return unit, along, aside

    def _smooth(self, r: Tensor, push: Tensor, deep: float, soft: float, here: Tensor) -> Tensor:
        """The closed form (3, n), as `Prior.forward`."""
        square = (r * r).sum(dim=0)
        size = torch.sqrt(square + 1e-6)
        cores = torch.stack([torch.rsqrt(square + a * a) for a in _prior.CORES])
        falls = torch.stack([torch.exp(size / -length) for length in _prior.RANGES])
        radial = (cores[:, None] * falls).reshape(-1, len(size))
        lean, part = float(here.double() @ push) + 0.8, deep / 4
        factors = torch.tensor([1, lean, part, soft, part * lean, part * part, part * soft], dtype=r.dtype)
        mixed = torch.einsum("f,kfv->vk", factors, self._prior[:, :-1])
        amounts = torch.cat([mixed, self._prior[:, -1].T]) @ radial  # (6, n)
        unit = r * torch.rsqrt(square + 1)
        a = torch.addcmul(amounts[:3], amounts[3:], push @ unit)
        return (a[0] * self._normals64 + a[1] * unit + a[2] * push[:, None]).float()


def _matrix(operator: Sparse | Gathered) -> Tensor:
    assert isinstance(operator, Sparse)
    return operator.matrix


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
        self._scales, self._whole = part.scales, part.whole.weight.T
        weight, bias = part.thin.weight.T, part.thin.bias
        self._scalar, self._vector = weight[:, :-d].contiguous(), weight[:, -d:].contiguous()
        self._scalar_bias, self._vector_bias = bias[:-d], bias[-d:]
        self._mix, self._back = _Layer(part.mix), _Layer(part.back)
        self._x = torch.empty(n, part.mix.in_features)
        self._hidden, self._m, self._d = hidden, weight.shape[1] - d, d

    def __call__(
        self, h: Tensor, matrices: tuple[tuple[Tensor, Tensor], ...], unit: Tensor, push: Tensor, near: Tensor
    ) -> tuple[Tensor, Tensor]:
        """New h (n, hidden), and the slopes (3, n, directions x scales)."""
        n, m, d, x = len(h), self._m, self._d, self._x
        x[:, : self._hidden] = h
        scalar = torch.addmm(self._scalar_bias, h, self._scalar)
        vector = torch.addmm(self._vector_bias, h, self._vector)
        at, slopes = self._hidden, []
        for k in self._scales:
            mean, slope_of = matrices[k]
            x[:, at : at + m] = torch.mm(mean, scalar)
            slope = torch.mm(slope_of, vector).reshape(3, n, d)
            torch.sum(slope * unit[..., None], dim=0, out=x[:, at + m : at + m + d])
            x[:, at + m + d : at + m + 2 * d] = (push @ slope.reshape(3, -1)).reshape(n, d)
            at += m + 2 * d
            slopes.append(slope)
        whole = near @ h @ self._whole
        mixed = torch.addmm(self._mix.bias + whole[0], x, self._mix.weight)
        new = torch.addmm(h, silu(mixed, inplace=True), self._back.weight).add_(self._back.bias)
        return new, torch.cat(slopes, dim=2) if len(slopes) > 1 else slopes[0]
