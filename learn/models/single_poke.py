"""Fast prediction of one poke at a time over one interior, for haptic loops.

Results equal those of `InvariantGnn.decode` to rounding. It is faster for these reasons: what does not depend
on the poke is computed once, and what depends on the contact alone (first contact and direction of the push)
once for all depths (`_Touch`); a channel is a row of all points, so that each operation runs along them, and
products write where the next one reads; small arrays use NumPy, whose operations cost a quarter of torch's,
products use torch; the rod's surface is evaluated near the rod alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import silu

from learn.errors import InputError
from learn.models import _ahead, _contact, _prior
from learn.models._contact import RINGS, WIDTHS
from learn.models._encoder import Encoded
from learn.models._single_round import Round, biased, channels
from learn.models.invariant_gnn import InvariantGnn, _Messages

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

# Columns of `Contact.point`, with their signs: those of the contact, in groups that one call of a function
# makes, and those of the depth. Columns 6 and 7 are the same at all points.
_PLAIN = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (9, 1)]
_GAUSS = [(10 + k, 1) for k in range(10)] + [(21, 1), (22, 1), (26, 1)]
_TANH = [(20, 1), (30, 1), (31, 1)]
_OF_DEPTH = [(8, 1), (25, 1), (23, -1), (24, -1), (27, 1), (28, 1), (29, 1)]
_OF_POKE = (6, 7)
# exp of less is 0 beside any other feature; subnormal numbers would make the products a hundred times slower
_LEAST_EXPONENT = np.float32(-60)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Touch:
    """What depends on first contact and push alone, of n points; lengths in rod radii.

    `entered` is memory of the predictor, so that only its last contact is valid.

    Attributes
    ----------
    r, unit : from first contact to the points, and divided by sqrt(|r|^2 + 1); components along the `a` axes
        along which the surface extends, each (a, n).
    push : those components of the unit direction (a,), float32.
    facing : component of the push along the normal at the contact.
    far : 1 / sqrt(|r|^2 + 1); `along`, `aside`, the distances along the axis and from it; `under`, the weight
        of points under the rod's end; each (n,).
    near : weights of the points for each of `WIDTHS`, (w, n).
    place : of the points beside the rod, whose numbers are `beside`; its depth is that of no poke.
    radial, fixed : radial functions of the closed form (cores x ranges, n), and the part of its three
        amounts that does not depend on depth (3, n), float64; `soft`, the soft fraction below the contact.
    entered : what enters the trunk from code, vectors and the contact's columns (hidden, n).
    seen : code's means near the contact, and first moments along push and normal.
    cover : thickness of the soft tissue below the contact.
    blocked, clear : of the way ahead (`_ahead`).
    """

    r: Floats
    unit: Floats
    push: Floats
    facing: float
    far: Floats
    along: Floats
    aside: Floats
    under: Floats
    near: Floats
    place: _contact.Place
    beside: NDArray[np.intp]
    radial: Doubles
    fixed: Doubles
    soft: float
    entered: Tensor
    seen: Floats
    cover: float
    blocked: Floats
    clear: Doubles


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
        self._axes = np.flatnonzero(np.ptp(self._points, axis=1) > 0.0)
        code = encoded.code[:, inclusion]
        self._looked = model.look(code).numpy()
        self._clear = encoded.clear[:, inclusion].double().numpy()
        self._per_clear = 1 / np.maximum(self._clear, _contact.LEAST_CLEAR)
        self._column = model.column(scene)
        self._ahead = _ahead.OneContact(scene, encoded.layers[:, inclusion])
        vectors = encoded.vectors[:, :, inclusion].transpose(1, 2)  # (3, v, n)
        self._vectors = np.ascontiguousarray(vectors.numpy())
        prior = model.prior.coefficients.numpy()  # (radial, factors, 3)
        self._prior_of_poke = np.ascontiguousarray(prior[:, :-1].transpose(2, 0, 1))
        self._prior_of_turn = np.ascontiguousarray(prior[:, -1].T)  # (3, radial)

        weight = model.from_point.weight.T
        self._code = model.from_code(code).T.contiguous()
        v, seen = len(self._vectors[0]), len(WIDTHS) * self._looked.shape[1]
        first = weight.shape[0] - 2 * v - seen
        self._toward = weight[first : first + seen].numpy()
        self._of_depth = weight[list(_OF_POKE)].numpy()
        self._of_poke = model.from_poke.weight.numpy()
        nothing = torch.zeros(3, weight.shape[1])  # for the direction from the contact
        fixed = [*_of(weight, [*_PLAIN, *_GAUSS, *_TANH]), nothing, weight[first + seen :]]
        self._fixed = torch.cat(fixed).T.contiguous()
        self._own = len(_PLAIN) + len(_GAUSS) + len(_TANH)  # the row at which the direction begins
        self._moving = torch.cat([*_of(weight, _OF_DEPTH), nothing[:1]]).T.contiguous()
        # memory common to torch and NumPy
        self._fixed_rows, self._moving_rows = (
            channels(w.shape[1], n).fill_(1.0) for w in (self._fixed, self._moving)
        )
        hidden = len(self._fixed)
        self._entered_fixed = channels(hidden, n)
        self._entered = channels(1 + hidden, n).fill_(1.0)  # row 0 is of ones, times which are the biases
        self._rings = (RINGS[:, None] * len(RINGS)).numpy()
        self._widths = np.array([[-0.5 * (self._radius / w) ** 2] for w in WIDTHS], dtype=np.float32)
        self._scales = np.array([[[2.5e-3 / w]] for w in WIDTHS], dtype=np.float32)
        parts = [part for part in model.rounds if isinstance(part, _Messages)]
        assert len(parts) == len(model.rounds)
        # the code in rows 1 to `hidden`, which a round adds to; what it reads beside the code after those
        x = channels(1 + max(part.mix.in_features for part in parts), n).fill_(1.0)
        self._x, self._h = x[: 1 + hidden], x[1 : 1 + hidden]
        self._rounds: list[Round] = []
        shift = torch.zeros(hidden)
        for part in parts:
            self._rounds.append(Round(part, encoded.stencils, self._radius, shift, x, len(self._axes)))
            shift = shift + part.back.bias
        slopes = parts[-1].directions * len(parts[-1].scales)
        # vectors that the outputs weight: the constant ones, and memory for those of a poke
        self._basis = np.zeros((3, 3 + v + slopes, n), dtype=np.float32)
        self._basis[:, 0], self._basis[:, 3 : 3 + v] = self._normals, self._vectors
        leave, head, last = model.leave[0], model.force_head[0], model.force_head[2]
        assert isinstance(leave, nn.Linear)
        assert isinstance(head, nn.Linear)
        assert isinstance(last, nn.Linear)
        self._enter, self._leave = biased(model.enter), biased(leave, shift)
        self._out = biased(model.coefficients)
        self._head = tuple(t.numpy() for t in (head.weight, head.bias, last.weight[0], last.bias))
        self._last: tuple[tuple[float, ...], _Touch] | None = None

    @torch.inference_mode()
    def __call__(
        self, start: Doubles, direction: Doubles, depth: float, modulus: float
    ) -> tuple[Floats, float]:
        """Displacement of the points (n, 3) [m] and magnitude of the force [N].

        `start`: rod's tip at first contact (3,) [m]; `direction`: unit vector (3,), both float64; `depth`
        [m]; `modulus`: small-strain shear modulus [Pa]. The next poke is faster if it only goes deeper, or
        less deep.
        """
        key = (*start, *direction)
        if self._last is None or self._last[0] != key:
            self._last = key, self._touch(start, direction)
        at = self._last[1]
        deep = max(depth / self._radius, _contact.TOUCH)
        about, of_depth = self._about(at, deep, modulus)
        self._fill(at, deep)
        self._moving.numpy()[:, -1] = self._of_poke @ about + of_depth  # times a row of ones
        h = self._entered[1:]
        silu(torch.addmm(at.entered, self._moving, self._moving_rows, out=h), inplace=True)
        silu(torch.mm(self._enter, self._entered, out=self._h), inplace=True)
        for round_ in self._rounds:
            slopes = round_(at.r, at.unit, at.push, at.near[2])
        out = silu(torch.mm(self._leave, self._x, out=h), inplace=True)
        amounts = torch.mm(self._out, self._entered).numpy()  # (outputs, n)
        gates, amounts = amounts[-_contact.N_GATES :], amounts[: -_contact.N_GATES]
        amounts *= at.far
        smooth = self._smooth(at, deep)
        amounts[:3] += smooth
        self._basis[self._axes, 3 + self._vectors.shape[1] :] = slopes
        u = np.einsum("kcn,cn->kn", self._basis, amounts)
        if len(at.beside):
            some = at.beside
            of_smooth = (smooth[:, some] * self._basis[:, :3, some]).sum(axis=1)
            gate = 1 / (1 + np.exp(-gates[:, some].T))
            place = at.place._replace(depth=_column(deep)[0])
            u[:, some] = _contact.held(place, of_smooth.T, (u[:, some] - of_smooth).T, gate, _OfFew).T
        pooled = [out.numpy() @ weight for weight in at.near[:2]]
        weight, bias, last, last_bias = self._head
        hidden = weight @ np.concatenate([*pooled, about]) + bias
        kappa = float(last @ (hidden / (1 + np.exp(-hidden))) + last_bias[0])
        depth = max(depth, 0.0)
        force = modulus * depth * self._radius * self._force_unit * float(np.logaddexp(0, kappa))
        return np.ascontiguousarray((u * np.float32(depth)).T), force

    def _touch(self, start: Doubles, direction: Doubles) -> _Touch:
        """What depends on the contact alone; also writes directions to the vectors that outputs weight."""
        r64 = self._points - (start / self._radius)[:, None]
        r, push = r64.astype(np.float32), direction.astype(np.float32)
        square64 = (r64 * r64).sum(axis=0)
        square = square64.astype(np.float32)
        near = self._widths * (square - square.min()) + self._log_area
        near = _exp(near - near.max(axis=1, keepdims=True))
        near /= near.sum(axis=1, keepdims=True)
        here = self._normals @ near[0]
        moments = (self._scales * near[:, None] * r).reshape(-1, r.shape[1]) @ self._looked
        toward = moments.reshape(len(WIDTHS), 3, -1).transpose(1, 0, 2).reshape(3, -1)

        far = 1 / np.sqrt(square + 1)
        unit, along = r * far, push @ r
        off = r - along * push[:, None]
        aside = np.sqrt((off * off).sum(axis=0) + np.float32(1e-6))
        over = (off * self._normals).sum(axis=0)
        rows, g = self._fixed_rows.numpy(), len(_PLAIN)
        lift, lean, turn = (unit * self._normals).sum(axis=0), push @ self._normals, along * far
        flat = turn - lift * lean
        rows[:g] = far, np.log(far), lift, lean, turn, flat, flat * far
        ring = np.log(1 + np.sqrt(square + np.float32(1e-6)) * np.float32(self._radius * 500))
        t, o = g + len(_GAUSS), self._own
        rows[g : t - 3] = ring * np.float32(len(RINGS) / math.log1p(20.0)) - self._rings
        rows[t - 3 : t] = aside, aside / 2, np.square(aside / np.float32(1.5))
        gauss = rows[g:t]
        gauss *= gauss
        gauss *= np.float32(-0.5)
        _exp(gauss, out=gauss)
        under = rows[t - 1].copy()
        rows[t:o] = 2 - 2 * aside, over, 3 * over / aside
        np.tanh(rows[t:o], out=rows[t:o])
        rows[o - 1] *= under
        v = len(self._vectors[0])
        rows[o : o + 3] = unit
        rows[o + 3 : o + 3 + v] = (self._vectors * unit[:, None]).sum(axis=0)
        rows[o + 3 + v :] = (push @ self._vectors.reshape(3, -1)).reshape(v, -1)
        self._fixed.numpy()[:, o : o + 3] = (toward @ self._toward).T
        self._basis[:, 1], self._basis[:, 2] = unit, push[:, None]

        size = np.sqrt(square64 + 1e-6)
        cores = 1 / np.sqrt(square64 + np.array([[a * a] for a in _prior.CORES]))
        falls = np.exp(size / np.array([[-length] for length in _prior.RANGES]))
        radial = (cores[:, None] * falls).reshape(-1, len(size))
        beside = np.flatnonzero(aside < _contact.LAND[1])
        place = _contact.Place(r.T[beside], push, None, along[beside], aside[beside], self._edge)
        blocked = self._ahead(self._radius * r64, direction)
        return _Touch(
            r=r[self._axes],
            unit=unit[self._axes],
            push=push[self._axes],
            facing=float(here @ push),
            far=far,
            along=along,
            aside=aside,
            under=under,
            near=near,
            place=place,
            beside=beside,
            radial=radial,
            fixed=(self._prior_of_turn @ radial) * turn,
            soft=float(near[0] @ self._clear),
            entered=torch.addmm(self._code, self._fixed, self._fixed_rows, out=self._entered_fixed),
            seen=np.concatenate([(near @ self._looked).reshape(-1), push @ toward, here @ toward]),
            cover=self._column / float(near[0] @ self._per_clear),
            blocked=blocked,
            clear=_ahead.clear(blocked, self._radius),
        )

    def _about(self, at: _Touch, deep: float, modulus: float) -> tuple[Floats, Floats]:
        """Invariants of the poke, and what those of its depth add to the trunk's input."""
        log_deep = math.log(deep + _contact.SHALLOW)
        of_poke = [deep / 4, log_deep, at.facing, at.facing * deep / 4]
        known = _contact.of_cover(at.cover, deep, at.facing, np)
        beyond = np.clip(deep * self._radius + np.array(_ahead.BEYOND), _ahead.WAY[0], _ahead.WAY[-1])
        there = np.array([np.interp(beyond, _ahead.WAY, row) for row in at.blocked])
        known += _ahead.invariants(at.clear, deep, there, np)
        known += [] if self._log_modulus is None else [math.log(modulus) - self._log_modulus]
        about = np.concatenate([of_poke, at.seen, known], dtype=np.float32, casting="same_kind")
        return about, deep / 4 * self._of_depth[0] + log_deep * self._of_depth[1]

    def _fill(self, at: _Touch, deep: float) -> None:
        """Fill in the features of all points that depend on the depth."""
        rows = self._moving_rows.numpy()
        np.multiply(at.far, np.float32(deep), out=rows[0])
        _exp(np.float32(-0.5) * np.square(at.aside * np.float32(1 / (1 + 0.5 * deep))), out=rows[1])
        np.multiply(np.float32(deep) - at.along, _column(1, 0.25, 1, 4, 1 / deep), out=rows[2:7])
        np.tanh(rows[2:7], out=rows[2:7])
        rows[4:7] *= at.under

    def _smooth(self, at: _Touch, deep: float) -> Floats:
        """The closed form's amounts of normal, direction from the contact and push, (3, n).

        As in `Prior.forward`: sums of terms that nearly cancel, in float64.
        """
        lean, part, soft = at.facing + 0.8, deep / 4, at.soft
        factors = np.array([1, lean, part, soft, part * lean, part * part, part * soft])
        amounts = (self._prior_of_poke @ factors) @ at.radial
        amounts += at.fixed
        return amounts.astype(np.float32)


def _column(*values: float) -> Floats:
    return np.array(values, dtype=np.float32)[:, None]


def _exp(x: Floats, out: Floats | None = None) -> Floats:
    return np.asarray(np.exp(np.maximum(x, _LEAST_EXPONENT, out=out), out=out))


def _of(weight: Tensor, columns: Sequence[tuple[int, int]]) -> list[Tensor]:
    """Rows of a transposed weight matrix that read these columns, with their signs, each (1, hidden)."""
    return [sign * weight[column : column + 1] for column, sign in columns]


class _OfFew:
    """NumPy functions for `_contact.held`; `np.clip` takes as long as five operations on a few points."""

    sqrt, maximum, minimum, where, tanh = np.sqrt, np.maximum, np.minimum, np.where, np.tanh

    @staticmethod
    def clip(x: Any, low: float | None, high: float | None) -> Any:
        x = x if low is None else np.maximum(x, low)
        return x if high is None else np.minimum(x, high)
