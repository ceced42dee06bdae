"""Invariants of each point with respect to the rod, and the geometry seen from the contact."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from learn.models._rod import Place, under_end

RINGS = torch.linspace(0, 1, 10)  # centres of bumps in log(1 + distance / 2 mm), from 0 to 40 mm
WIDTHS = (5e-3, 12e-3, 25e-3)  # m; neighbourhoods of the contact
N_POINT = 10 + len(RINGS) + 12
N_POKE = 5


class Exact(NamedTuple):
    """What `Contact` calls r, push, normal and depth, in float64."""

    r: Tensor
    push: Tensor
    normal: Tensor
    depth: Tensor


class Contact:
    """b pokes at n points; made once a prediction. All lengths in rod radii unless said otherwise.

    r: from first touch to the points (n, b, 3); unit: r / sqrt(|r|^2 + 1); far: 1 / sqrt(|r|^2 + 1).
    push: direction (b, 3). point: invariants (n, b, N_POINT); poke: invariants (b, N_POKE).
    near: one weight a point for each of WIDTHS, summing to 1 over the points, (w, n, b).
    """

    def __init__(
        self, points: Tensor, normals: Tensor, pokes: tuple[Tensor, ...], radius: float, edge: float
    ) -> None:
        start, direction, depth, modulus = pokes
        # differences in float64: a scene far from the origin loses nothing
        self.exact = Exact(
            (points[:, None] - start[None]) / radius, direction, normals[:, None], depth / radius
        )
        self.r, self.push, self.normal, self.depth = (t.float() for t in self.exact)
        square = self.r.square().sum(dim=2)
        self.far = torch.rsqrt(square + 1)
        self.unit = self.r * self.far[..., None]
        distance = torch.sqrt(square + 1e-6)
        millimetres = radius * 1e3
        self.near = torch.stack([torch.softmax(-0.5 * square * (radius / w) ** 2, dim=0) for w in WIDTHS])
        self.edge = edge / radius
        self.along = along = (self.r * self.push).sum(dim=2)
        off = self.r - along[..., None] * self.push
        self.aside = aside = torch.sqrt(off.square().sum(dim=2) + 1e-6)
        over = (off * self.normal).sum(dim=2)
        under = under_end(along, aside, self.depth)
        lift = (self.unit * self.normal).sum(dim=2)
        lean = (self.push * self.normal).sum(dim=2).expand_as(lift)
        turn = (self.unit * self.push).sum(dim=2)
        deep = self.depth.expand_as(lift)
        ring = torch.log1p(distance * (millimetres / 2)) / torch.log1p(torch.tensor(20.0)) * 1.0
        bumps = torch.exp(-0.5 * ((ring[..., None] - RINGS.to(ring.device)) * len(RINGS)).square())
        beside = torch.stack(
            [
                torch.tanh(2 * (1 - aside)),
                torch.exp(-0.5 * aside.square()),
                torch.exp(-0.5 * (aside / 2).square()),
                torch.tanh(along - deep),
                torch.tanh((along - deep) / 4),
                torch.exp(-0.5 * (aside / (1 + 0.5 * deep)).square()),
                *under,
                torch.tanh(over),
                torch.tanh(over / aside * 3) * under[0],
            ],
            dim=2,
        )
        plain = torch.stack(
            [
                self.far,
                torch.log(self.far),
                lift,
                lean,
                turn,
                turn - lift * lean,
                deep / 4,
                torch.log(deep),
                self.far * deep,
                ((self.unit - lift[..., None] * self.normal) * self.push).sum(dim=2) * self.far,
            ],
            dim=2,
        )
        self.point = torch.cat([plain, bumps, beside], dim=2)
        # the surface's normal where the rod touches
        here = torch.einsum("nb,nk->bk", self.near[0], normals.float())
        facing = (here * self.push).sum(dim=1)
        self.poke = torch.stack(
            [self.depth / 4, torch.log(self.depth), facing, facing * self.depth / 4, modulus.float()], dim=1
        )
        self.here = here

    @property
    def place(self) -> Place:
        """What the rod's surface wants to know."""
        return Place(self.r, self.push, self.depth, self.along, self.aside, self.edge)

    def vectors(self) -> tuple[Tensor, Tensor, Tensor]:
        """Normal, unit direction and push at each point, each (n, b, 3)."""
        return self.normal.expand_as(self.unit), self.unit, self.push.expand_as(self.unit)

    def seen(self, code: Tensor) -> tuple[Tensor, Tensor]:
        """A code (n, b, c) as seen from the contact: invariants of the poke (b, 9 c) and vectors (3, b, 3 c).

        Each width gives the code's mean near the contact and the mean of position times code, a vector
        that points to where the code is large.
        """
        scalars, vectors = [], []
        for near, width in zip(self.near, WIDTHS, strict=True):
            weighted = near[..., None] * code
            scalars.append(weighted.sum(dim=0))
            scale = 2.5e-3 / width
            v = torch.einsum("nbk,nbc->kbc", self.r * scale, weighted)
            vectors.append(v)
        v = torch.cat(vectors, dim=2)
        along = torch.einsum("kbc,bk->bc", v, self.push)
        up = torch.einsum("kbc,bk->bc", v, self.here)
        return torch.cat([*scalars, along, up], dim=1), v
