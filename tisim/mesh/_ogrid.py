"""Plane grid under a rod: a butterfly disc, fine rings under the rod's edge, graded rings to the border."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._columns import graded

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


SAMPLES = 60


@dataclass(frozen=True, kw_only=True)
class PlaneGrid:
    """A grid of quadrilaterals in the plane.

    Attributes
    ----------
    points : positions [m], shape (n, 2).
    cells : point indices, counter-clockwise, shape (m, 4).
    border : indices of the points on the rectangle's border, shape (b,).
    """

    points: Floats
    cells: Ints
    border: Ints


@dataclass(frozen=True, kw_only=True)
class Focus:
    """A disc in which rays and rings should be at most `spacing` apart: centre, radius `reach` [m]."""

    centre: Floats
    reach: float
    spacing: float


def butterfly(m: int) -> tuple[Floats, Ints, Ints]:
    """Unit disc of m x m quadrilaterals inside one ring of 4 m quadrilaterals.

    Returns points (n, 2), cells (c, 4) and the indices of the outer circle's 4 m points, counter-clockwise
    from -135 degrees, evenly spaced.
    """
    s = np.linspace(-1.0, 1.0, m + 1)
    x, y = np.meshgrid(s, s, indexing="xy")
    square = np.stack([x.ravel(), y.ravel()], axis=1)
    # the core is half way between square and circle, so that its corner cells are not flat
    norm_inf = np.abs(square).max(axis=1)
    angle = np.where(
        np.abs(square[:, 0]) >= np.abs(square[:, 1]),
        np.pi / 4 * square[:, 1] / np.where(square[:, 0] == 0, 1, square[:, 0]) + np.pi * (square[:, 0] < 0),
        np.pi / 2 * np.sign(square[:, 1])
        - np.pi / 4 * square[:, 0] / np.where(square[:, 1] == 0, 1, square[:, 1]),
    )
    disc = norm_inf[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner = (m / (m + 1.6)) * (0.45 * disc + 0.55 * np.sqrt(0.5) * square)
    grid = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
    cells = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4)
    rim = np.concatenate([grid[0, :-1], grid[:-1, -1], grid[-1, :0:-1], grid[:0:-1, 0]])
    turn = -0.75 * np.pi + 2 * np.pi * np.arange(4 * m) / (4 * m)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    outer = len(inner) + np.arange(4 * m)
    return np.concatenate([inner, circle]), np.concatenate([cells, band(rim, outer)]), outer


def band(inner: Ints, outer: Ints) -> Ints:
    """Quadrilaterals between two closed counter-clockwise rings with equal numbers of nodes."""
    return np.stack([inner, outer, np.roll(outer, -1), np.roll(inner, -1)], axis=1)


def border_points(site: Floats, half: Floats, n: int, focus: Focus | None = None) -> Floats:
    """n points on the border of |x| <= half[0], |y| <= half[1], counter-clockwise, shape (n, 2).

    The corners are among them. Their density is the mean of a uniform density in the angle about the site and
    one in the length along the border, increased in the direction of the focus.
    """
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half
    t = np.linspace(0.0, 1.0, SAMPLES + 1)[None, :, None]
    line = corners[:, None] + t * (np.roll(corners, -1, axis=0) - corners)[:, None]  # (4, SAMPLES + 1, 2)
    seen = line - site
    bearing = np.arctan2(seen[..., 1], seen[..., 0])
    angle = np.mod(np.diff(bearing, axis=1), 2 * np.pi)
    length = np.linalg.norm(np.diff(line, axis=1), axis=2)
    share = 0.5 * angle / angle.sum() + 0.5 * length / length.sum()
    if focus is not None:
        extra, off, width = _toward(site, half, n, focus, bearing)
        bump = np.maximum(0.0, 1.0 - 0.5 * (off / width) ** 2)[:, :-1] * angle
        if extra > 0.0 and bump.sum() > 0.0:
            share = share * (1.0 - extra) + bump * (extra / bump.sum())
    wanted = n * share.sum(axis=1)
    counts = np.maximum(2, np.floor(wanted).astype(int))
    while counts.sum() < n:
        counts[np.argmax(wanted - counts)] += 1
    while counts.sum() > n:
        counts[np.argmax(np.where(counts > 2, counts - wanted, -np.inf))] -= 1
    out = []
    for k in range(4):
        rise = np.concatenate([[0.0], np.cumsum(share[k])])
        at = np.interp(np.arange(counts[k]) * rise[-1] / counts[k], rise, t[0, :, 0])
        out.append(corners[k] + at[:, None] * (corners[(k + 1) % 4] - corners[k]))
    return np.concatenate(out)


def _toward(site: Floats, half: Floats, n: int, focus: Focus, bearing: Floats) -> tuple[float, Floats, float]:
    """Fraction of the rays to concentrate on the focus, angles from its direction, its half width [rad]."""
    way = focus.centre - site
    distance = float(np.hypot(*way))
    off = np.abs(np.mod(bearing - np.arctan2(way[1], way[0]) + np.pi, 2 * np.pi) - np.pi)
    if distance < 1.3 * focus.reach:
        return 0.0, off, 1.0
    width = float(np.arcsin(focus.reach / distance)) * 1.15
    # rays are straight: a concentration on the border results in a smaller one at the focus
    room = np.where(way > 0, half - site, half + site) / np.maximum(np.abs(way), 1e-12)
    part = max(0.35, 1.0 / float(room.min()))
    wanted = 2.0 * focus.reach / focus.spacing + 1.0
    return float(np.clip((wanted / n - width / np.pi) / part, 0.0, 0.3)), off, width


def _split_rings(rings: Floats, focus: Focus) -> Floats:
    """Rings (k, n_theta, 2) with additional ones if they are farther apart at the focus than its spacing."""
    out = [rings[:1]]
    for inner, outer in pairwise(rings):
        way = outer - inner
        length = np.linalg.norm(way, axis=1)
        t = np.clip(np.sum((focus.centre - inner) * way, axis=1) / np.maximum(length, 1e-12) ** 2, 0.0, 1.0)
        near = np.linalg.norm(inner + t[:, None] * way - focus.centre, axis=1) < 1.1 * focus.reach
        widest = float(length[near].max(initial=0.0))
        parts = int(np.clip(np.ceil(widest / focus.spacing - 0.3), 1, 12))
        steps = np.arange(1, parts + 1) / parts
        out.append(np.where((steps == 1.0)[:, None, None], outer, inner + steps[:, None, None] * way))
    return np.concatenate(out)


def o_grid(
    *,
    site: Floats,
    half: Floats,
    flat: float,
    rings: Floats,
    azimuth: float,
    stretch: float,
    n_theta: int,
    n_outer: int,
    focus: Focus | None = None,
    turn: float = 0.0,
) -> PlaneGrid:
    """The grid around `site` in a rectangle.

    Parameters
    ----------
    site : ndarray of float, shape (2,)
        Centre of the grid (x, y) [m].
    half : ndarray of float, shape (2,)
        Half sides of the rectangle [m].
    flat, rings : float and ndarray of float, shape (k,)
        Radius of the disc and rising radii of the fine rings [m].
    azimuth, stretch : float
        Direction [rad] in which disc and fine rings are stretched, and the factor: a tilted rod intersects
        the surface in an ellipse.
    n_theta : int
        Number of rays, a multiple of 4.
    n_outer : int
        Number of rings from the last fine one to the border.
    focus : Focus, optional
        Another part that should be fine.
    turn : float
        Rotation of the rays about the rod, as a fraction of their spacing.
    """
    disc, cells, outer = butterfly(n_theta // 4)
    border = border_points(site, half, n_theta, focus)
    # turn the disc so that its rays are directed at the border's points as closely as possible
    seen = border - site
    bearing = np.unwrap(np.arctan2(seen[:, 1], seen[:, 0]))
    even = 2 * np.pi * np.arange(n_theta) / n_theta
    start = float(np.mean(bearing - even)) + turn * 2 * np.pi / n_theta
    c, s = np.cos(start + 0.75 * np.pi), np.sin(start + 0.75 * np.pi)
    disc = disc @ np.array([[c, s], [-s, c]])

    direction = disc[outer]
    axis = np.array([np.cos(azimuth), np.sin(azimuth)])
    radii = np.asarray(rings)[:, None, None] * direction
    local = [flat * disc, radii.reshape(-1, 2)]
    local = [p + (stretch - 1.0) * (p @ axis)[:, None] * axis for p in local]
    last = site + local[1][-n_theta:]
    first = float(rings[-1] - rings[-2]) * 1.25
    way = border - last
    length = np.hypot(way[:, 0], way[:, 1])
    at = graded(length, first, n_outer)[:, 1:] / length[:, None]
    far = last[None] + at.T[:, :, None] * way[None]
    far[-1] = border
    if focus is not None:
        far = _split_rings(np.concatenate([last[None], far]), focus)[1:]

    points = np.concatenate([site + local[0], site + local[1], far.reshape(-1, 2)])
    n_ring = len(rings) + len(far)
    ring_nodes = np.concatenate([outer[None], len(disc) + np.arange(n_ring * n_theta).reshape(-1, n_theta)])
    bands = [band(a, b) for a, b in pairwise(ring_nodes)]
    return PlaneGrid(points=points, cells=np.concatenate([cells, *bands]), border=ring_nodes[-1])
