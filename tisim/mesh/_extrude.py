"""A plane section drawn out along x into layers of hexahedra or tetrahedra."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import ElementKind
from tisim.mesh._section import Section

_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


def layer_ends(
    length: float, layer: float, *, graded_start: bool, graded_end: bool, grading: tuple[float, ...]
) -> NDArray[np.float64]:
    """Positions of the layers' ends on [0, length], shape (layers + 1,).

    grading: widths of the layers next to a clamp, as parts of the width of the others; the number of
    layers is length / layer, rounded, whatever the grading.
    """
    need = len(grading) * (int(graded_start) + int(graded_end)) + 1
    count = max(round(length / layer), min(need, 3))
    width = np.ones(count)
    reach = min(len(grading), count // (1 + int(graded_start and graded_end)))
    if graded_start:
        width[:reach] = grading[:reach]
    if graded_end:
        width[count - reach :] = grading[:reach][::-1]
    ends = np.concatenate([[0.0], np.cumsum(width)])
    ends *= length / ends[-1]
    ends[-1] = length
    return ends


def extrude(
    section: Section, x: NDArray[np.float64], kind: ElementKind
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Nodes (n, 3) [m] and elements (m, nodes per element), numbered plane by plane along x.

    With "tet10" there is a plane of nodes in the middle of each layer too, and every plane holds the
    section's corners and its edges' middles: the body is then exactly the quadratic section drawn out,
    as a quadratic function of (y, z) is reproduced by the 10-node element however the prism is cut.
    """
    n, layers = len(section.points), len(x) - 1
    if kind == "hex8":
        nodes = _planes(section.points, x)
        base = (np.arange(layers) * n)[:, None, None]
        elements = np.concatenate([section.cells + base, section.cells + base + n], axis=2)
        return nodes, elements.reshape(-1, 8)
    point, level = _prism_tetrahedra(section, layers)
    if kind == "tet4":
        return _planes(section.points, x), point + n * level
    m = n + len(section.edges)
    planes = np.empty(2 * layers + 1)
    planes[::2] = x
    planes[1::2] = 0.5 * (x[:-1] + x[1:])
    place = np.full((n, n), -1)
    place[np.arange(n), np.arange(n)] = np.arange(n)
    i, j = section.edges.T
    place[i, j] = place[j, i] = n + np.arange(len(section.edges))
    a, b = np.array(_EDGES).T
    middle = place[point[:, a], point[:, b]] + m * (level[:, a] + level[:, b])
    elements = np.concatenate([point + 2 * m * level, middle], axis=1)
    return _planes(np.concatenate([section.points, section.middles]), planes), elements


def _planes(points: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    along = np.repeat(x, len(points))[:, None]
    return np.concatenate([along, np.tile(points, (len(x), 1))], axis=1)


def _prism_tetrahedra(section: Section, layers: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Three tetrahedra a prism: section point and plane number of each corner, both (m, 4).

    The diagonal over a section edge rises from the end with the lower rank to the other, so that
    neighbours agree; ranks go by (|y|, z), so that the whole beam is the mirror image of its half.
    The direction alternates from layer to layer, else the mesh would favour twisting one way.
    """
    y, z = section.points.T
    rank = np.lexsort((np.round(z, 12), np.round(np.abs(y), 12))).argsort()
    cells = np.take_along_axis(section.cells, rank[section.cells].argsort(axis=1), axis=1)
    local = np.array([[0, 1, 2, 2], [0, 1, 2, 1], [0, 1, 2, 0]])
    upper = np.array([[0, 0, 0, 1], [0, 0, 1, 1], [0, 1, 1, 1]])
    point = np.tile(cells[:, local][None], (layers, 1, 1, 1))
    flip = (np.arange(layers) % 2 == 1)[:, None, None, None]
    up = np.where(flip, 1 - upper, upper)
    level = np.arange(layers)[:, None, None, None] + np.broadcast_to(up, point.shape)
    point, level = point.reshape(-1, 4), level.reshape(-1, 4)
    # x stands for the plane number: only the sign of the volume is wanted
    corner = np.concatenate([level[..., None].astype(float), section.points[point]], axis=2)
    negative = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0
    for array in (point, level):
        array[negative] = array[negative][:, [0, 2, 1, 3]]
    return point, level
