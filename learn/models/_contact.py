"""Invariants of each point with respect to the indenter, and the indenter's surface.

The first part gives the features: distances, angles and depths, and the geometry's code seen from the
contact. The second is the kinematics of contact. A network of smooth functions cannot locate the edge of the
tip to a hundredth of a millimetre, but the poke determines it. So the displacement under the indenter is a
mixture of the network's and of motion with the indenter since contact, and points that end near its surface
are then moved onto it. The weights of both (gates) are learned and fade out beside the indenter.

Lengths are in indenter radii unless stated otherwise. `xp` is torch, or NumPy, whose operations on a few
numbers cost a quarter; arrays are of the same library.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import torch
from torch import Tensor

from learn.models.scene import Pokes, Scene

RINGS = torch.linspace(0, 1, 10)  # centres of bumps in log(1 + distance / 2 mm), from 0 to 40 mm
WIDTHS = (5e-3, 12e-3, 25e-3)  # m; neighbourhoods of the contact
N_POINT = 10 + len(RINGS) + 12
N_POKE = 4
N_COVER = 3
LEAST_CLEAR = 1 / 256  # least fraction of a column that is soft, for the mean of its inverse


# At first contact displacement and force over depth tend to a limit, and so must the network's inputs: TOUCH
# is the least depth, and SHALLOW is added to the depth under the logarithm.
TOUCH, SHALLOW = 1e-3, 0.05
N_GATES = 2
# undeformed distances from the axis at which a gate begins to fade and has faded:
STICK = (1.0, 1.8)  # moving with the rod
LAND = (2.0, 3.5)  # moving onto the surface
_REACH = 0.5  # the largest move onto the surface


class Exact(NamedTuple):
    """The quantities r, push, normal and depth of `Contact`, in float64."""

    r: Tensor
    push: Tensor
    normal: Tensor
    depth: Tensor


class Contact:
    """Geometry of b pokes at n points, computed once per prediction; lengths are in rod radii.

    r: from first contact to the points (n, b, 3); unit: r / sqrt(|r|^2 + 1); far: 1 / sqrt(|r|^2 + 1).
    push: direction (b, 3). point: invariants (n, b, N_POINT); poke: invariants (b, N_POKE).
    near: weights of the points for each of WIDTHS (w, n, b), proportional to their area, summing to 1 over
    the points.
    """

    def __init__(self, scene: Scene, pokes: Pokes) -> None:
        radius = scene.rod_radius
        # differences in float64: a scene far from the origin loses nothing
        self.exact = Exact(
            (scene.points[:, None] - pokes.start[None]) / radius,
            pokes.direction,
            scene.normals[:, None],
            (pokes.depth / radius).clamp(min=TOUCH),
        )
        self.r, self.push, self.normal, self.depth = (t.float() for t in self.exact)
        square = self.r.square().sum(dim=2)
        self.far = torch.rsqrt(square + 1)
        self.unit = self.r * self.far[..., None]
        distance = torch.sqrt(square + 1e-6)
        millimetres = radius * 1e3
        size = torch.log(scene.area).float()[:, None]
        self.near = torch.stack(
            [torch.softmax(size - 0.5 * square * (radius / w) ** 2, dim=0) for w in WIDTHS]
        )
        self.edge = scene.rod_edge / radius
        self.along = along = (self.r * self.push).sum(dim=2)
        off = self.r - along[..., None] * self.push
        self.aside = aside = torch.sqrt(off.square().sum(dim=2) + 1e-6)
        over = (off * self.normal).sum(dim=2)
        under = under_end(along, aside, self.depth)
        lift = (self.unit * self.normal).sum(dim=2)
        lean = (self.push * self.normal).sum(dim=2).expand_as(lift)
        turn = (self.unit * self.push).sum(dim=2)
        deep, log_deep = self.depth.expand_as(lift), torch.log(self.depth + SHALLOW)
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
                log_deep.expand_as(lift),
                self.far * deep,
                ((self.unit - lift[..., None] * self.normal) * self.push).sum(dim=2) * self.far,
            ],
            dim=2,
        )
        self.point = torch.cat([plain, bumps, beside], dim=2)
        # the surface's normal where the rod touches
        here = torch.einsum("nb,nk->bk", self.near[0], scene.normals.float())
        facing = (here * self.push).sum(dim=1)
        self.poke = torch.stack([self.depth / 4, log_deep, facing, facing * self.depth / 4], dim=1)
        self.here = here

    @property
    def place(self) -> Place:
        """Arguments of the functions of the rod's surface."""
        return Place(self.r, self.push, self.depth, self.along, self.aside, self.edge)

    def vectors(self) -> tuple[Tensor, Tensor, Tensor]:
        """Normal, unit direction and push at each point, each (n, b, 3)."""
        return self.normal.expand_as(self.unit), self.unit, self.push.expand_as(self.unit)

    def seen(self, code: Tensor) -> tuple[Tensor, Tensor]:
        """A code (n, b, c) relative to the contact: invariants of the poke (b, 9 c), vectors (3, b, 3 c).

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


def of_cover(cover: Any, depth: Any, facing: Any, xp: Any = torch) -> list[Any]:
    """Invariants of the soft tissue's thickness below the contact.

    A layer that is thinner than the rod is wide is the stiffer the thinner it is (Hayes et al., J. Biomech.
    5, 1972), and stiffens without limit as the rod nears what is rigid. `facing`: component of the push
    along the normal, less than 0.
    """
    return [xp.log(cover / 4), 1 / cover, -facing * depth / cover]


class Place(NamedTuple):
    """Undeformed points relative to the rod.

    `r` from first contact (n, b, 3), its components along the push and aside (n, b); `push` (b, 3), `depth`
    (b,), `edge`.
    """

    r: Any
    push: Any
    depth: Any
    along: Any
    aside: Any
    edge: float


def under_end(along: Tensor, aside: Tensor, depth: Tensor) -> list[Tensor]:
    """Features (n, b): position under the rod's end, and travel of the rod after it meets the point."""
    near = torch.exp(-0.5 * (aside / 1.5).square() ** 2)
    go = depth - along
    return [near, near * torch.tanh(go), near * torch.tanh(4 * go), near * torch.tanh(go / depth)]


def distance(ahead: Any, aside: Any, edge: float, xp: Any = torch) -> tuple[Any, Any, Any]:
    """Signed distance from the rod, less than 0 in it, and its derivatives with respect to both arguments.

    `ahead`: distance beyond the tip's plane, along the push; `aside`: distance from the axis; `edge`: radius
    of the rounded edge.
    """
    da, ds = ahead + edge, aside - (1 - edge)
    out_a, out_s = xp.clip(da, 0.0, None), xp.clip(ds, 0.0, None)
    corner = xp.sqrt(out_a * out_a + out_s * out_s + 1e-12)
    inner = xp.maximum(da, ds)
    inside = inner <= 0
    of_a = xp.where(inside, (da > ds) * 1.0, out_a / corner)
    of_s = xp.where(inside, (da <= ds) * 1.0, out_s / corner)
    return xp.where(inside, inner, corner) - edge, of_a, of_s


def travel(place: Place, xp: Any = torch) -> Any:
    """Travel of the rod after it meets a point that stays at rest, 0 if it does not meet it (n, b).

    It is at most the depth: a point beside an inclined rod may lie behind its tip from the start.
    """
    edge = place.edge
    over = xp.clip(place.aside - (1 - edge), 0.0, edge)
    rounded = edge - xp.sqrt(xp.clip(edge * edge - over * over, 1e-12, None))
    return xp.minimum(xp.clip(place.depth - place.along - rounded, 0.0, None), place.depth)


def held(place: Place, smooth: Any, learned: Any, gates: Any, xp: Any = torch) -> Any:
    """Displacement (n, b, 3) over depth: closed form or motion with the rod, and the learned displacement.

    `gates` (n, b, 2) from 0 to 1: fraction of motion with the rod, and fraction of the gap to the rod's
    surface that is closed.
    """
    stick = gates[..., 0] * fade(place.aside, STICK, xp)
    land = gates[..., 1] * fade(place.aside, LAND, xp)
    push, depth = place.push, place.depth[:, None]
    with_rod = (travel(place, xp) / place.depth)[..., None] * push
    u = smooth + learned + stick[..., None] * (with_rod - smooth)
    now = place.r + depth * u
    along = (now * push).sum(-1)
    off = now - along[..., None] * push
    aside = xp.sqrt((off * off).sum(-1) + 1e-12)
    gap, of_a, of_s = distance(along - place.depth, aside, place.edge, xp)
    reach = xp.clip(place.depth, None, _REACH)  # at most the travel of the rod
    step = land * reach * xp.tanh(gap / reach) / place.depth
    return u - step[..., None] * (of_a[..., None] * push + (of_s / aside)[..., None] * off)


def fade(x: Any, limits: tuple[float, float], xp: Any = torch) -> Any:
    """1 below the limits, 0 above, smooth between."""
    t = xp.clip((x - limits[0]) / (limits[1] - limits[0]), 0.0, 1.0)
    return 1 - t * t * (3 - 2 * t)
