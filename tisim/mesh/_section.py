"""Cross-sections of a beam as plane meshes in (y, z), symmetric about y = 0.

A section's triangles or quadrangles are counter-clockwise seen from +x, and no edge crosses y = 0, so that
the half y >= 0 is a subset of the whole. An inscribed polygon loses area (a 12-gon 4.5 %, and twice that in
bending). A circular section is therefore scaled until its mesh has the circle's area; the remaining error of
the second moment of area is of second order in the radial error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import MeshError

# Seven-point rule of degree 5 on the triangle (Radon 1948): barycentric points, weights that sum to 1.
_A, _B = (6 - 15**0.5) / 21, (6 + 15**0.5) / 21
_WA, _WB = (155 - 15**0.5) / 1200, (155 + 15**0.5) / 1200
TRIANGLE_POINTS = np.array(
    [[1 / 3, 1 / 3, 1 / 3]]
    + [np.roll([1 - 2 * _A, _A, _A], k).tolist() for k in range(3)]
    + [np.roll([1 - 2 * _B, _B, _B], k).tolist() for k in range(3)]
)
TRIANGLE_WEIGHTS = np.array([9 / 40] + [_WA] * 3 + [_WB] * 3)


@dataclass(frozen=True, eq=False)
class Section:
    """A plane mesh of a cross-section.

    Attributes
    ----------
    points : corners in (y, z) [m], shape (v, 2).
    cells : point indices, shape (c, 3) or (c, 4).
    edges : sorted pairs of points, shape (e, 2).
    middles : middle node of each edge, on the true curve for curved edges [m], shape (e, 2).
    """

    points: NDArray[np.float64]
    cells: NDArray[np.int64]
    edges: NDArray[np.int64]
    middles: NDArray[np.float64]


def section_of(
    points: NDArray[np.float64], cells: NDArray[np.int64], *, curved_radius: float | None = None
) -> Section:
    """Section with its edges; middles of boundary edges on the circle `curved_radius` lie on the circle."""
    pairs = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, count = np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)
    middles = points[edges].mean(axis=1)
    if curved_radius is not None:
        on_circle = np.isclose(np.linalg.norm(points, axis=1), curved_radius, rtol=1e-9)
        outer = (count == 1) & on_circle[edges].all(axis=1)
        middles[outer] *= curved_radius / np.linalg.norm(middles[outer], axis=1, keepdims=True)
    return Section(points, cells, edges, middles)


def circle_triangles(radius: float, rings: int, *, quadratic: bool) -> Section:
    """Disc of triangles in six sectors; ring k has 6 k edges.

    Half of the section has 12 nodes with 1 ring, 35 with 2 (corners and middles of edges).
    """
    points = [np.zeros((1, 2))]
    for k in range(1, rings + 1):
        angle = np.arange(6 * k) * (np.pi / (3 * k))
        points.append(np.stack([np.sin(angle), np.cos(angle)], axis=1) * (k / rings))
    cells: list[tuple[int, int, int]] = []
    for k in range(1, rings + 1):
        inner, outer = 3 * (k - 1) * (k - 2) + 1 if k > 1 else 0, 3 * k * (k - 1) + 1
        n_inner, n_outer = max(6 * (k - 1), 1), 6 * k
        for sector in range(6):
            i = [inner + ((k - 1) * sector + j) % n_inner for j in range(k)]
            o = [outer + (k * sector + j) % n_outer for j in range(k + 1)]
            # the angle runs from +z to +y, clockwise seen from +x, so the order of the cells is reversed
            cells += [(i[j], o[j + 1], o[j]) for j in range(k)]
            cells += [(i[j], i[j + 1], o[j + 1]) for j in range(k - 1)]
    section = section_of(_clean(np.concatenate(points)), np.array(cells), curved_radius=1.0)
    return _scaled_to_circle(section, radius, quadratic=quadratic)


def circle_quadrangles(radius: float, rings: int) -> Section:
    """Disc as an O-grid: a square core of 2 rings x 2 rings cells and `rings` layers of cells around it."""
    m = 2 * rings
    t = np.linspace(-1.0, 1.0, m + 1)
    y, z = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    core = 0.55 * np.stack([y, z], axis=1)
    # the core's sides bulge slightly, for better angles at its corners
    core *= (1 - 0.12 * np.linalg.norm(core, axis=1) / 0.55)[:, None]
    index = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
    cells = [
        np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    ]
    rim = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
    angle = -0.75 * np.pi + np.arange(4 * m) * (np.pi / (2 * m))
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, last = [core], rim
    for k in range(1, rings + 1):
        ring = (m + 1) ** 2 + (k - 1) * 4 * m + np.arange(4 * m)
        points.append(core[rim] + (circle - core[rim]) * (k / rings))
        cells.append(np.stack([last, ring, np.roll(ring, -1), np.roll(last, -1)], axis=-1))
        last = ring
    section = section_of(_clean(np.concatenate(points)), np.concatenate(cells))
    return _scaled_to_circle(section, radius, quadratic=False)


def rectangle(width: float, height: float, rings: int, *, triangles: bool) -> Section:
    """Rectangle of 2 rings x 2 rings cells; the diagonals of triangles point away from the axis."""
    t = np.linspace(-0.5, 0.5, 2 * rings + 1)
    y, z = (a.ravel() for a in np.meshgrid(t * width, t * height, indexing="ij"))
    index = np.arange(len(y)).reshape(len(t), len(t))
    a, b, c, d = (s.ravel() for s in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    points = _clean(np.stack([y, z], axis=1))
    cells = np.stack([a, b, c, d], axis=1)
    if triangles:
        centre = points[cells].mean(axis=1)
        first = (centre[:, 0] * centre[:, 1] > 0)[:, None]
        one = np.where(first, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
        two = np.where(first, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
        cells = np.concatenate([one, two])
    return section_of(points, cells)


def half(section: Section) -> Section:
    """The half y >= 0 of a section."""
    keep = section.points[section.cells, 0].mean(axis=1) > 0
    used = np.unique(section.cells[keep])
    renumber = np.full(len(section.points), -1)
    renumber[used] = np.arange(len(used))
    inside = (renumber[section.edges] >= 0).all(axis=1)
    return Section(
        section.points[used],
        renumber[section.cells[keep]],
        renumber[section.edges[inside]],
        section.middles[inside],
    )


def moments(section: Section, *, quadratic: bool) -> tuple[float, float, float]:
    """Area [m2] and second moments of area (integrals of y^2 and of z^2) [m4] of the plane mesh.

    If `quadratic`, the edges' middles are nodes of 6-node triangles; else edges are straight.
    """
    cells = section.cells
    if cells.shape[1] == 4:
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    corner = section.points[cells]
    pairs = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1), axis=-1)
    if quadratic:
        lookup = {(int(i), int(j)): n for n, (i, j) in enumerate(section.edges)}
        middle = section.middles[[[lookup[(int(i), int(j))] for i, j in row] for row in pairs]]
    else:
        middle = section.points[pairs].mean(axis=2)
    nodes = np.concatenate([corner, middle], axis=1)
    L = TRIANGLE_POINTS
    shape = np.concatenate([L * (2 * L - 1), 4 * L * np.roll(L, -1, axis=1)], axis=1)
    # derivatives by the first two barycentric coordinates, the third being 1 - L0 - L1
    by_L = np.zeros((len(L), 6, 3))
    for k in range(3):
        by_L[:, k, k] = 4 * L[:, k] - 1
        by_L[:, 3 + k, k] = 4 * L[:, (k + 1) % 3]
        by_L[:, 3 + k, (k + 1) % 3] = 4 * L[:, k]
    gradient = by_L[:, :, :2] - by_L[:, :, 2:]
    x = np.einsum("qn,cni->cqi", shape, nodes)
    jacobian = np.einsum("qnk,cni->cqik", gradient, nodes)
    weight = 0.5 * np.linalg.det(jacobian) * TRIANGLE_WEIGHTS
    return (
        float(weight.sum()),
        float((weight * x[..., 0] ** 2).sum()),
        float((weight * x[..., 1] ** 2).sum()),
    )


def _scaled_to_circle(section: Section, radius: float, *, quadratic: bool) -> Section:
    area = moments(section, quadratic=quadratic)[0]
    scale = radius * (np.pi / area) ** 0.5
    return Section(section.points * scale, section.cells, section.edges, section.middles * scale)


def _clean(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points with round-off about 0 set to 0, so that the mirror plane is found by equality."""
    return np.where(np.abs(points) < 1e-12 * np.abs(points).max(), 0.0, points)


def check_positive(**lengths: float) -> None:
    """Raise a MeshError for the first of the named lengths [m] that is not positive and finite."""
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise MeshError(f"{name.replace('_', ' ')} must be a positive length in metres, got {value!r}")
