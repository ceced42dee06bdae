"""The plane grid under a rod: a butterfly disc, fine rings over the rod's edge, rings growing to a border."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._layers import graded

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class PlaneGrid:
    """A grid of quadrilaterals and triangles in the plane.

    points: shape (n, 2) [m]. cells: shape (m, 4), counter-clockwise; a triangle repeats its last node.
    border: indices of the points on the rectangle's border, shape (b,).
    fixed: points that smoothing leaves where they are (the rod's disc and rings, the border), shape (n,).
    """

    points: Floats
    cells: Ints
    border: Ints
    fixed: NDArray[np.bool_]


def butterfly(m: int) -> tuple[Floats, Ints, Ints]:
    """Unit disc of m x m quadrilaterals inside one ring of 4 m.

    Returns points (n, 2), cells (c, 4) and the indices of the outer circle's 4 m points, counter-clockwise
    from -135 degrees, evenly spaced.
    """
    s = np.linspace(-1.0, 1.0, m + 1)
    x, y = np.meshgrid(s, s, indexing="xy")
    square = np.stack([x.ravel(), y.ravel()], axis=1)
    # rounding the square half way to a circle keeps its corner cells from becoming flat
    norm_inf = np.abs(square).max(axis=1)
    norm_two = np.where(norm_inf > 0, np.hypot(square[:, 0], square[:, 1]), 1.0)
    angle = np.where(
        np.abs(square[:, 0]) >= np.abs(square[:, 1]),
        np.pi / 4 * square[:, 1] / np.where(square[:, 0] == 0, 1, square[:, 0]) + np.pi * (square[:, 0] < 0),
        np.pi / 2 * np.sign(square[:, 1])
        - np.pi / 4 * square[:, 0] / np.where(square[:, 1] == 0, 1, square[:, 1]),
    )
    disc = norm_inf[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    chord = square / np.where(norm_two > 0, 1.0, 1.0)[:, None] * np.sqrt(0.5)
    inner = (m / (m + 1.6)) * (0.45 * disc + 0.55 * chord)
    grid = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
    cells = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4)
    rim = np.concatenate([grid[0, :-1], grid[:-1, -1], grid[-1, :0:-1], grid[:0:-1, 0]])
    turn = -0.75 * np.pi + 2 * np.pi * np.arange(4 * m) / (4 * m)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    outer = len(inner) + np.arange(4 * m)
    return np.concatenate([inner, circle]), np.concatenate([cells, band(rim, outer)]), outer


def band(inner: Ints, outer: Ints) -> Ints:
    """Quadrilaterals between two closed rings of as many nodes, both counter-clockwise."""
    return np.stack([inner, outer, np.roll(outer, -1), np.roll(inner, -1)], axis=1)


def border_points(site: Floats, half: Floats, n: int) -> Floats:
    """n points on the rectangle |x| <= half[0], |y| <= half[1], counter-clockwise, its corners among them.

    They are spread by a mean of the angle seen from the site and of the length along the side.
    """
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half
    seen = corners - site
    angles = np.arctan2(seen[:, 1], seen[:, 0])
    spans = np.mod(np.roll(angles, -1) - angles, 2 * np.pi)
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    share = 0.5 * spans / spans.sum() + 0.5 * lengths / lengths.sum()
    wanted = n * share
    counts = np.maximum(2, np.floor(wanted).astype(int))
    while counts.sum() < n:
        counts[np.argmax(wanted - counts)] += 1
    while counts.sum() > n:
        counts[np.argmax(np.where(counts > 2, counts - wanted, -np.inf))] -= 1
    out = []
    for k in range(4):
        start, stop = corners[k], corners[(k + 1) % 4]
        t = np.arange(counts[k]) / counts[k]
        # where a ray of the evenly turned angle meets this side
        turn = angles[k] + spans[k] * t
        along = (stop - start) / lengths[k]
        distance = abs(float(np.dot([along[1], -along[0]], start - site)))
        normal_angle = np.arctan2(-along[0], along[1])
        by_angle = distance * np.tan(turn - normal_angle) - np.dot(along, start - site)
        out.append(start + along * (0.5 * by_angle + 0.5 * lengths[k] * t)[:, None])
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
) -> PlaneGrid:
    """The grid around `site` (x, y) in the rectangle of half sides `half` [m].

    flat: radius of the disc [m]; rings: radii of the fine rings after it, rising, shape (k,); both are
    stretched by `stretch` along `azimuth` [rad], where a tilted rod cuts the surface in an ellipse.
    n_theta: rays, a multiple of 4; n_outer: rings from the last fine one to the border.
    """
    disc, cells, outer = butterfly(n_theta // 4)
    border = border_points(site, half, n_theta)
    # turn the disc so that its rays meet the border's points most nearly straight on
    seen = border - site
    bearing = np.unwrap(np.arctan2(seen[:, 1], seen[:, 0]))
    even = 2 * np.pi * np.arange(n_theta) / n_theta
    start = float(np.mean(bearing - even))
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

    points = np.concatenate([site + local[0], site + local[1], far.reshape(-1, 2)])
    ring_nodes = np.concatenate(
        [outer[None], len(disc) + np.arange((len(rings) + n_outer) * n_theta).reshape(-1, n_theta)]
    )
    bands = [band(a, b) for a, b in zip(ring_nodes[:-1], ring_nodes[1:], strict=True)]
    fixed = np.zeros(len(points), dtype=bool)
    fixed[: len(disc) + len(rings) * n_theta] = True
    fixed[ring_nodes[-1]] = True
    return PlaneGrid(
        points=points, cells=np.concatenate([cells, *bands]), border=ring_nodes[-1], fixed=fixed
    )
