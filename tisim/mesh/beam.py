"""Structured meshes of prismatic beams, and a beam's outline in the side view.

A plane section is extruded along x into layers of hexahedra or tetrahedra, graded towards the clamps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Circle, Rectangle
from tisim.mesh._mesh import ElementKind, Mesh, MeshError, boundary_facets
from tisim.mesh._section import Section, check_positive, circle_quadrangles, circle_triangles, half, rectangle

# Widths of the layers next to a clamp, relative to the others. At small strain, with one pressure per
# element, 2 rings and 7 mm layers, the deflections of the 50, 100 and 150 mm beams are within -0.34 and
# +0.11 % of those of a fine mesh for K/mu from 20 to 1000; equal layers are 0.6 to 2.1 % too stiff.
CLAMP_GRADING = (0.2, 0.5)

# Resolution of the paper's cylinder of 100 mm: 7,239 nodes of 4-node tetrahedra (the paper: 7,257).
PAPER_RINGS, PAPER_LAYER = 6, 0.1 / 56
_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


def beam_mesh(
    *,
    length: float,
    section: Circle | Rectangle,
    grip_length: float = 0.020,
    supports: Literal["clamped-free", "clamped-clamped"] = "clamped-free",
    kind: ElementKind = "tet10",
    axial_element_size: float = 0.007,
    radial_elements: int = 2,
    mirror: bool = False,
    with_grips: bool = False,
    grading: tuple[float, ...] = CLAMP_GRADING,
) -> Mesh:
    """A beam along x, its free part on [0, length], its section centred on y = z = 0.

    Parameters
    ----------
    length : float
        Free length [m].
    section : Circle or Rectangle
    grip_length : float
        Length held in each grip [m], for `with_grips`.
    supports : "clamped-free" or "clamped-clamped"
    kind : "tet4", "tet10" or "hex8"
    axial_element_size : float
        Mean length of the elements along x [m].
    radial_elements : int
        Number of elements from the axis to the surface.
    mirror : bool
        Mesh only the half y >= 0, with symmetry ("y",).
    with_grips : bool
        Also mesh the parts in the grips, x in [-grip_length, 0] and beyond `length` if both ends are clamped.
        All of their nodes are fixed, so they store no energy and do not change the solution.
    grading : tuple of float
        Widths of the layers next to a clamp, as fractions of the width of the others.

    Returns
    -------
    Mesh
        Node sets: "clamp" (x <= 0), "far_clamp" (x >= length, clamped-clamped only), "tip" (x = length,
        clamped-free only), "mirror_y" (y = 0, half model only). Facet sets: "surface" (the boundary without
        the mirror plane), "tip" (the end face of a clamped-free beam).

    Raises
    ------
    MeshError
        For invalid lengths, counts, supports or grading.
    """
    check_positive(length=length, axial_element_size=axial_element_size)
    if with_grips:
        check_positive(grip_length=grip_length)
    if supports not in ("clamped-free", "clamped-clamped"):
        raise MeshError(f"supports must be 'clamped-free' or 'clamped-clamped', got {supports!r}")
    if radial_elements < 1:
        raise MeshError(
            f"a beam needs at least 1 element from axis to surface, got radial_elements={radial_elements}"
        )
    if not grading or min(grading) <= 0:
        raise MeshError(f"grading must be positive widths, (1.0,) for equal layers, got {grading!r}")
    both = supports == "clamped-clamped"
    x = layer_ends(length, axial_element_size, graded_start=True, graded_end=both, grading=grading)
    if with_grips:
        grip = np.linspace(0.0, grip_length, max(round(grip_length / axial_element_size), 1) + 1)[1:]
        x = np.concatenate([-grip[::-1], x, length + grip]) if both else np.concatenate([-grip[::-1], x])
    plane = plane_section(section, kind=kind, radial_elements=radial_elements)
    nodes, elements = extrude(half(plane) if mirror else plane, x, kind)
    return _named(kind, nodes, elements.astype(np.int32), length=length, both=both, mirror=mirror)


def plane_section(section: Circle | Rectangle, *, kind: ElementKind, radial_elements: int) -> Section:
    """The whole cross-section as a plane mesh in (y, z) for elements of a type."""
    if isinstance(section, Circle):
        check_positive(radius=section.radius)
        if kind == "hex8":
            return circle_quadrangles(section.radius, radial_elements)
        return circle_triangles(section.radius, radial_elements, quadratic=kind == "tet10")
    check_positive(width=section.width, height=section.height)
    return rectangle(section.width, section.height, radial_elements, triangles=kind != "hex8")


def _named(
    kind: ElementKind,
    nodes: NDArray[np.float64],
    elements: NDArray[np.int32],
    *,
    length: float,
    both: bool,
    mirror: bool,
) -> Mesh:
    """The mesh with its node and facet sets; the planes x = 0, x = length and y = 0 are exact."""
    x, y = nodes[:, 0], nodes[:, 1]
    sets = {"clamp": x <= 0, ("far_clamp" if both else "tip"): x >= length}
    surface = boundary_facets(kind, elements)
    facets = {"surface": surface}
    if mirror:
        sets["mirror_y"] = y == 0
        facets["surface"] = surface[~(y[surface] == 0).all(axis=1)]
    if not both:
        facets["tip"] = surface[(x[surface] == length).all(axis=1)]
    return Mesh(
        kind=kind,
        nodes=nodes,
        elements=elements,
        node_sets={name: np.flatnonzero(mask).astype(np.int32) for name, mask in sets.items()},
        facet_sets=facets,
        symmetry=("y",) if mirror else (),
    )


def layer_ends(
    length: float, layer: float, *, graded_start: bool, graded_end: bool, grading: tuple[float, ...]
) -> NDArray[np.float64]:
    """Positions of the layers' ends on [0, length] [m], shape (layers + 1,).

    `grading` holds the widths of the layers next to a clamp relative to the others. The number of layers is
    length / layer, rounded; with a graded end it is at least 2, or 3 with two or more graded layers.
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

    For "tet10" there is also a plane of nodes in the middle of each layer, and every plane has the corners
    and the edges' middles of the section. The body is then exactly the extruded quadratic section, since the
    10-node element reproduces quadratic functions of (y, z), however the prism is cut.
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
    """Three tetrahedra per prism: section point and plane number of each corner, both (m, 4).

    The diagonal over a section edge rises from the end of lower rank to the other, so that neighbours agree.
    Ranks are by (|y|, z), so that the whole beam is the mirror image of its half. The direction alternates
    from layer to layer, since otherwise the mesh would favour one sense of twist.
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
    # the plane number is used as x: only the sign of the volume matters
    corner = np.concatenate([level[..., None].astype(float), section.points[point]], axis=2)
    negative = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0
    for array in (point, level):
        array[negative] = array[negative][:, [0, 2, 1, 3]]
    return point, level


@dataclass(frozen=True, kw_only=True)
class Outline:
    """Outline of a beam in the plane y = 0, from the clamp to the other end.

    Attributes
    ----------
    upper, lower, centreline : points (x, z) of the edges and of the centreline [m], shape (k, 2).
    x : position of the points at rest [m], shape (k,).
    """

    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    centreline: NDArray[np.float64]
    x: NDArray[np.float64]


def outline(mesh: Mesh, positions: NDArray[np.float64]) -> Outline:
    """Outline of a structured beam (`beam_mesh`) at nodal positions (n, 3) [m].

    The points are the nodes of the plane y = 0 at every plane of nodes along x; between them the edge is a
    parabola (tet10) or a line. MeshError if the mesh is not structured or the shape of `positions` is wrong.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape != mesh.nodes.shape:
        raise MeshError(
            f"positions must have shape {mesh.nodes.shape} as the mesh's nodes, got {positions.shape}"
        )
    x, y, z = mesh.nodes.T
    planes, place = np.unique(np.round(x, 12), return_inverse=True)
    lines = []
    for level in (z.max(), z.min(), 0.0):
        at = np.flatnonzero((y == 0) & (np.abs(z - level) < 1e-9))
        at = at[np.argsort(x[at])]
        if not np.array_equal(place[at], np.arange(len(planes))):
            raise MeshError("an outline needs a structured beam mesh, with nodes in line along x at y = 0")
        lines.append(positions[at][:, [0, 2]])
    return Outline(upper=lines[0], lower=lines[1], centreline=lines[2], x=planes)
