"""The rod's surface: a rounded cylinder that has gone its depth. What touches it lies on it.

A network of smooth functions cannot know to a hundredth of a millimetre where a tip of a millimetre's edge
is; but that is known. So the displacement under the rod is a mixture of the network's and of "it moves with
the rod from where the rod met it", and the points that come to lie near its surface are then moved onto it.
How much of either is learned, and both fade out beside the rod. Lengths in rod radii. xp: torch, or NumPy,
whose operations on a few numbers cost a quarter; arrays are of its kind.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import torch
from torch import Tensor

N_GATES = 2
# distances from the axis at rest, where it begins to fade and has faded:
STICK = (1.0, 1.8)  # moving with the rod
LAND = (2.0, 3.5)  # moving onto the surface
_REACH = 0.5  # the farthest move onto the surface


class Place(NamedTuple):
    """Points at rest and the rod: r from first touch (n, b, 3), its parts along the push and aside (n, b);
    push (b, 3), depth (b,), edge."""

    r: Any
    push: Any
    depth: Any
    along: Any
    aside: Any
    edge: float


def under_end(along: Tensor, aside: Tensor, depth: Tensor) -> list[Tensor]:
    """Features: whether a point lies under the rod's end, and how far the rod goes on after meeting it."""
    near = torch.exp(-0.5 * (aside / 1.5).square() ** 2)
    go = depth - along
    return [near, near * torch.tanh(go), near * torch.tanh(4 * go), near * torch.tanh(go / depth)]


def distance(ahead: Any, aside: Any, edge: float, xp: Any = torch) -> tuple[Any, Any, Any]:
    """Signed distance from the rod, less than 0 in it, and its derivatives with respect to both arguments.

    ahead: of the tip's plane, along the push; aside: from the axis; edge: radius of the rounded edge.
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
    """How far the rod goes on after it meets a point that stays at rest, 0 where it does not (n, b)."""
    edge = place.edge
    over = xp.clip(place.aside - (1 - edge), 0.0, edge)
    rounded = edge - xp.sqrt(xp.clip(edge * edge - over * over, 1e-12, None))
    return xp.clip(place.depth - place.along - rounded, 0.0, None)


def held(place: Place, smooth: Any, learned: Any, gates: Any, xp: Any = torch) -> Any:
    """The displacement (n, b, 3) over depth: the closed form, or with the rod, and what is learned of either.

    gates: (n, b, 2), numbers from 0 to 1: how much a point moves with the rod; how much of its way to the
    rod's surface it goes.
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
    step = land * _REACH * xp.tanh(gap / _REACH) / place.depth
    return u - step[..., None] * (of_a[..., None] * push + (of_s / aside)[..., None] * off)


def fade(x: Any, limits: tuple[float, float], xp: Any = torch) -> Any:
    """1 below the limits, 0 above, smooth between."""
    t = xp.clip((x - limits[0]) / (limits[1] - limits[0]), 0.0, 1.0)
    return 1 - t * t * (3 - 2 * t)
