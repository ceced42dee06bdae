"""`InvariantGnn.decode` of one poke over one interior, in operations that are fast in a browser.

Results agree to rounding. In a browser's runtime the cost is dominated by the number of operations and by
arrays of few columns, so: quantities of all points are rows (k, n); features are concatenated once and enter
one product; a round of messages gathers its neighbours once for means and slopes.
`learn.models.single_poke` is the counterpart on NumPy.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn.functional import silu, softplus

from learn.models import InvariantGnn, Scene, _ahead, _contact, _prior
from learn.models._contact import RINGS, WIDTHS, Place
from learn.models._encoder import Encoded, Gathered, Stencil, gathered
from learn.models.invariant_gnn import _Messages

# columns of `Contact.point` in the order in which `_features` makes them, with their signs
_PLAIN = [(0, 1), (1, 1), (2, 1), (3, 1), (4, 1), (5, 1), (8, 1), (9, 1)]
_EXP = [*((10 + k, 1) for k in range(len(RINGS))), (21, 1), (22, 1), (25, 1)]
_TANH = [(23, -1), (24, -1), (20, 1), (30, 1)]
_UNDER = [(26, 1), (27, 1), (28, 1), (29, 1), (31, 1)]
_OF_POKE = (6, 7)  # the same at all points


def interior_codes(model: InvariantGnn, encoded: Encoded) -> dict[str, Tensor]:
    """Inputs of `RowNetwork` for the first inclusion of a scene.

    Returns
    -------
    base (n, hidden), looked (n, SEEN), vectors (3, v, n), clear (n,) in float64, layers (n, LAYERS + 1).
    """
    code = encoded.code[:, 0]
    return {
        "base": model.from_code(code),
        "looked": model.look(code),
        "vectors": encoded.vectors[:, :, 0].transpose(1, 2).contiguous(),
        "clear": encoded.clear[:, 0].double(),
        "layers": encoded.layers[:, 0].contiguous(),
    }


class RowNetwork(nn.Module):
    """Network of one poke, from a model trained without time; `stencils` is `model.prepare(scene)`."""

    def __init__(self, model: InvariantGnn, scene: Scene, stencils: tuple[Stencil, ...]) -> None:
        super().__init__()
        self.model = model
        self.radius, self.edge = scene.rod_radius, scene.rod_edge / scene.rod_radius
        self.column, self.height = model.column(scene), scene.height
        self.points = (scene.points / self.radius).T.contiguous()
        self.normals = scene.normals.T.contiguous()
        self.log_area = torch.log(scene.area)
        weight = model.from_point.weight.detach().T
        order = [*_PLAIN, *_EXP, *_TANH, *_UNDER]
        self.own = torch.stack([sign * weight[column] for column, sign in order])
        looked = len(WIDTHS) * model.look.out_features
        first = _contact.N_POINT
        self.toward = weight[first : first + looked].contiguous()
        self.of_vectors = weight[first + looked :].contiguous()
        self.of_depth = weight[list(_OF_POKE)].contiguous()
        self.widths = torch.tensor([[-0.5 * (self.radius / w) ** 2] for w in WIDTHS], dtype=torch.float64)
        self.moments = torch.tensor([[[2.5e-3 / w]] for w in WIDTHS], dtype=torch.float64)
        self.rings = RINGS[:, None].double() * len(RINGS)
        self.cores = torch.tensor([[a * a] for a in _prior.CORES], dtype=torch.float64)
        self.ranges = torch.tensor([[-1 / length] for length in _prior.RANGES], dtype=torch.float64)
        used = sorted({k for part in model.rounds if isinstance(part, _Messages) for k in part.scales})
        self.near = nn.ModuleList([_Near(stencils[k]) for k in used])
        self.place = {k: place for place, k in enumerate(used)}

    def forward(
        self, base: Tensor, looked: Tensor, vectors: Tensor, clear: Tensor, layers: Tensor, start: Tensor,
        push64: Tensor, depth: Tensor, modulus: Tensor,
    ) -> tuple[Tensor, Tensor]:  # fmt: skip
        """Displacement (n, 3) [m] and force [N]; arguments of the interior from `interior_codes`."""
        model = self.model
        r64 = self.points - (start / self.radius)[:, None]
        deep64 = (depth / self.radius).clamp(min=_contact.TOUCH)
        square = (r64 * r64).sum(dim=0)
        # in float64 up to the network's inputs, so that rounding does not depend on the runtime
        near64 = torch.softmax(self.widths * square + self.log_area, dim=1)  # (w, n)
        here = near64[:1] @ self.normals.T  # (1, 3)
        looked64 = looked.double()
        moments = (self.moments * near64[:, None] * r64).reshape(-1, r64.shape[1]) @ looked64
        toward = moments.reshape(len(WIDTHS), 3, -1).permute(1, 0, 2).reshape(3, -1)
        log_deep = torch.log(deep64 + _contact.SHALLOW)
        facing = (here[0] * push64).sum()
        both = torch.cat([push64[None], here]) @ toward
        about = [
            torch.stack([deep64 / 4, log_deep, facing, facing * deep64 / 4]),
            (near64 @ looked64).reshape(-1),
        ]
        about.append(both.reshape(-1))
        inverse = 1 / clear.clamp(min=_contact.LEAST_CLEAR)
        cover = self.column / (near64[0] * inverse).sum()
        about.append(torch.stack(_contact.of_cover(cover, deep64, facing)))
        offset, push = (self.radius * r64).T[:, None], push64[None]
        blocked = _ahead.blocked(offset, self.normals.T, self.log_area, layers[:, None], push, self.height)
        about.append(torch.stack(_ahead.of_path(blocked[:, 0].double(), deep64, self.radius)))
        if model.log_modulus is not None:
            about.append((torch.log(modulus) - model.log_modulus)[None])
        of_poke = torch.cat(about)[None].float()

        far = torch.rsqrt(square + 1)
        unit64 = r64 * far
        along = (push64[:, None] * r64).sum(dim=0)
        off = r64 - along * push64[:, None]
        aside = torch.sqrt((off * off).sum(dim=0) + 1e-6)
        rows = self._features(square, far, unit64, push64, along, off, aside, deep64)
        unit, push, near, normals = unit64.float(), push64.float(), near64.float(), self.normals.float()
        seen = [*rows, unit, (vectors * unit[:, None]).sum(dim=0), (vectors * push[:, None, None]).sum(dim=0)]
        weight = torch.cat([self.own, toward.float() @ self.toward, self.of_vectors])
        depths = torch.stack([deep64 / 4, log_deep])[None].float() @ self.of_depth
        h = silu(torch.cat(seen).T @ weight + (base + (model.from_poke(of_poke) + depths)))
        h = silu(model.enter(h))
        frame = torch.stack([unit.T, push.expand(len(h), 3)], dim=1)  # (n, 2, 3)
        slopes: list[Tensor] = []
        for round_ in model.rounds:
            assert isinstance(round_, _Messages)
            h, slopes = self._round(round_, h, frame, near[2:])
        out = model.leave(h)
        amounts = (model.coefficients(out)).T  # (outputs, n)
        gates = torch.sigmoid(amounts[-_contact.N_GATES :]).T

        turned = [slope.permute(1, 2, 0) for slope in slopes]
        basis = torch.cat(
            [normals[:, None], unit[:, None], push[:, None, None].expand(3, 1, len(h)), vectors, *turned], 1
        )
        own = (basis * amounts[: -_contact.N_GATES]).sum(dim=1) * far.float()
        soft = (near64[0] * clear).sum()
        lean = (here[0] * push64).sum() + 0.8
        smooth = self._smooth(r64, push64, deep64, soft, lean)
        at = Place(r64.T, push64, deep64[None], along, aside, self.edge)
        u = _contact.held(at, smooth.T, own.T.double(), gates.double()).float()

        pooled = (near[:2] @ out).reshape(1, -1)
        kappa = model.force_head(torch.cat([pooled, of_poke], dim=1))[0, 0]
        pressed = depth.clamp(min=0.0)  # no response without contact
        unit_force = (modulus * pressed).float() * (self.radius * model.force_unit)
        return u * pressed.float(), unit_force * softplus(kappa)

    def _features(
        self, square: Tensor, far: Tensor, unit: Tensor, push: Tensor, along: Tensor, off: Tensor,
        aside: Tensor, deep: Tensor,
    ) -> list[Tensor]:  # fmt: skip
        """Rows of `Contact.point` in the order of `_PLAIN`, `_EXP`, `_TANH`, `_UNDER`; inputs in float64."""
        lift, lean = (unit * self.normals).sum(dim=0), (push[:, None] * self.normals).sum(dim=0)
        turn = along * far
        flat = turn - lift * lean
        plain = torch.stack([far, torch.log(far), lift, lean, turn, flat, far * deep, flat * far])
        ring = torch.log1p(torch.sqrt(square + 1e-6) * (self.radius * 500)) * (len(RINGS) / math.log1p(20.0))
        narrow = (aside / 1.5) ** 2
        beside = torch.stack([aside, aside * 0.5, aside / (1 + 0.5 * deep), narrow])
        exp = torch.exp((-0.5 * torch.cat([ring - self.rings, beside]) ** 2).float())
        go, over = deep - along, (off * self.normals).sum(dim=0)
        tanh = torch.tanh(
            torch.stack([go, go * 0.25, 2 - 2 * aside, over, go, 4 * go, go / deep, 3 * over / aside]).float()
        )
        near = exp[-1:]
        return [plain.float(), exp[:-1], tanh[:4], near, near * tanh[4:]]

    def _round(self, part: _Messages, h: Tensor, frame: Tensor, near: Tensor) -> tuple[Tensor, list[Tensor]]:
        """`_Messages` of one poke: new h (n, hidden), and the slopes (n, 3, directions) of each scale."""
        n, directions = len(h), part.directions
        thin = part.thin(h)
        parts, slopes = [h], []
        for k in part.scales:
            found = self.near[self.place[k]](thin)  # (n, 4, messages + directions)
            slope = found[:, 1:, -directions:]
            parts += [found[:, 0, :-directions], torch.matmul(frame, slope).reshape(n, -1)]
            slopes.append(slope)
        whole = part.whole(near @ h)
        return h + part.back(silu(part.mix(torch.cat(parts, dim=1)) + whole)), slopes

    def _smooth(self, r: Tensor, push: Tensor, deep: Tensor, soft: Tensor, lean: Tensor) -> Tensor:
        """Closed form (3, n) as in `Prior.forward`, in float64, since large terms nearly cancel."""
        square = (r * r).sum(dim=0)
        cores = torch.rsqrt(square + self.cores)
        falls = torch.exp(torch.sqrt(square + 1e-6) * self.ranges)
        radial = (cores[:, None] * falls).reshape(-1, r.shape[1])
        part = deep / 4
        factors = torch.stack(
            [torch.ones_like(deep), lean, part, soft, part * lean, part * part, part * soft]
        )
        c = self.model.prior.coefficients
        mixed = (c[:, :-1] * factors[:, None]).sum(dim=1).T  # (3, k)
        amounts = torch.cat([mixed, c[:, -1].T]) @ radial
        unit = r * torch.rsqrt(square + 1)
        a = amounts[:3] + amounts[3:] * (push[:, None] * unit).sum(dim=0)
        return a[:1] * self.normals + a[1:2] * unit + a[2:] * push[:, None]


class _Near(nn.Module):
    """Means and slopes of one scale at once: (n, c) -> (n, 4, c), the mean first."""

    def __init__(self, stencil: Stencil) -> None:
        super().__init__()
        found = gathered(stencil)
        mean, slope = found.mean, found.slope
        assert isinstance(mean, Gathered)
        assert isinstance(slope, Gathered)
        self.index, self.count = mean.index.reshape(-1), mean.index.shape[1]
        self.weight = torch.cat([mean.weight, slope.weight], dim=1)

    def forward(self, values: Tensor) -> Tensor:
        """Mean and slopes of `values` (n, c)."""
        near = values.index_select(0, self.index).reshape(len(values), self.count, -1)
        return torch.matmul(self.weight, near)
