"""One eighth of an upright cylinder, graded towards the platen's edge, where a bonded one strains most."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._columns import tetrahedra
from tisim.mesh._mesh import ElementKind, Mesh, MeshError, boundary_facets
from tisim.mesh._section import check_positive
from tisim.mesh.refine import to_quadratic

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CORE = 0.45  # side of the square core, in radii
BULGE = 0.12  # fraction by which the core's corner is moved inwards, for better angles about it
OUTER = 0.3  # ratio of the outermost shell's width to the innermost one's; likewise of the platen's layer


def press_mesh(*, radius: float, height: float, kind: ElementKind = "tet10", refinement: float = 1.0) -> Mesh:
    """The part x, y, z >= 0 of a cylinder along z centred on the origin, with symmetry ("x", "y", "z").

    The section's mesh has the area of the circle.

    Parameters
    ----------
    radius, height : float
        Radius and height of the whole cylinder [m].
    kind : "tet4", "tet10" or "hex8"
        Type of the elements.
    refinement : float
        Factor by which the elements become smaller.

    Returns
    -------
    Mesh
        Node sets: "top" (z = height / 2), "side" (the lateral surface), "mirror_x", "mirror_y", "mirror_z".
        Facet sets: "surface" (top and side), "top", "side".

    Raises
    ------
    MeshError
        If a length or the refinement is not positive.
    """
    check_positive(radius=radius, height=height)
    if not (np.isfinite(refinement) and refinement > 0):
        raise MeshError(f"refinement must be above 0, got {refinement!r}")
    finer = refinement if kind == "tet10" else 2.0 * refinement
    around, shells, layers = (max(1, round(n * finer)) for n in (2, 4, 5))
    points, cells = _quarter_disc(around, shells)
    points *= radius * _area_factor(around, quadratic=kind == "tet10")
    z = 0.5 * height * np.concatenate([[0.0], np.cumsum(_shrinking(layers))])
    z[-1] = 0.5 * height
    nodes = np.concatenate([np.tile(points, (len(z), 1)), np.repeat(z, len(points))[:, None]], axis=1)
    base = (np.arange(layers) * len(points))[:, None, None]
    hexahedra = np.concatenate([cells + base, cells + base + len(points)], axis=2).reshape(-1, 8)
    if kind == "hex8":
        return _named(Mesh(kind="hex8", nodes=nodes, elements=hexahedra), top=z[-1])
    # Diagonals rise outwards, so that one ends in the platen's edge: no element then has faces on both the
    # platen and the side, and none is flattened where the side folds onto the platen.
    out = np.round(np.linalg.norm(points, axis=1) / radius, 9)
    rank = np.argsort(np.lexsort((points[:, 0], out)))
    column = np.tile(rank, len(z))
    mesh = Mesh(kind="tet4", nodes=nodes, elements=tetrahedra(hexahedra, column))
    if kind == "tet10":
        mesh = _rounded(to_quadratic(mesh), float(np.linalg.norm(points, axis=1).max()))
    return _named(mesh, top=z[-1])


def _quarter_disc(around: int, shells: int) -> tuple[Floats, Ints]:
    """Points (n, 2) and cells (m, 4) of the unit disc's first quadrant: a core of around x around cells."""
    t = np.linspace(0.0, 1.0, around + 1)
    a, b = (c.ravel() for c in np.meshgrid(t, t, indexing="ij"))
    core = CORE * np.stack([a, b], axis=1) * (1.0 - BULGE * a * b)[:, None]
    index = np.arange((around + 1) ** 2).reshape(around + 1, around + 1)
    corners = (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    cells = [np.stack(corners, axis=-1).reshape(-1, 4)]
    last = np.concatenate([index[-1, :], index[-2::-1, -1]])  # the core's rim, counter-clockwise
    rim = core[last]
    angle = np.arange(len(rim)) * (np.pi / (4 * around))
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, count = [core], len(core)
    for part in np.cumsum(_shrinking(shells)):
        ring = count + np.arange(len(rim))
        points.append(rim + part * (circle - rim))
        cells.append(np.stack([last[:-1], ring[:-1], ring[1:], last[1:]], axis=-1))
        last, count = ring, count + len(ring)
    at = np.concatenate(points)
    return np.where(np.abs(at) < 1e-12, 0.0, at), np.concatenate(cells)


def _shrinking(count: int) -> Floats:
    """Widths of `count` cells that sum to 1, the last OUTER times as wide as the first."""
    width = np.geomspace(1.0, OUTER, count)
    return np.asarray(width / width.sum())


def _area_factor(around: int, *, quadratic: bool) -> float:
    """Factor by which the rim's polygon, or its parabolic arcs, must grow to enclose the circle's area."""
    step = np.pi / (4 * around)
    part = 0.5 * np.sin(step)
    if quadratic:
        part += 4.0 / 3.0 * np.sin(0.5 * step) * (1.0 - np.cos(0.5 * step))
    return float((0.5 * step / part) ** 0.5)


def _rounded(mesh: Mesh, rim: float) -> Mesh:
    """The mesh with the middle nodes of the lateral surface on its circle; facets stay in upright columns."""
    surface = boundary_facets(mesh.kind, mesh.elements)
    corner = np.linalg.norm(mesh.nodes[surface[:, :3], :2], axis=2)
    mantle = np.unique(surface[np.isclose(corner, rim, rtol=1e-9).all(axis=1)])
    nodes = mesh.nodes.copy()
    nodes[mantle, :2] *= rim / np.linalg.norm(nodes[mantle, :2], axis=1, keepdims=True)
    return replace(mesh, nodes=nodes)


def _named(mesh: Mesh, *, top: float) -> Mesh:
    nodes, surface = mesh.nodes, boundary_facets(mesh.kind, mesh.elements)
    planes = {f"mirror_{name}": nodes[:, k] == 0.0 for k, name in enumerate("xyz")}
    cut = np.any([mask[surface].all(axis=1) for mask in planes.values()], axis=0)
    pressed = (nodes[:, 2] == top)[surface].all(axis=1)
    facets = {"surface": surface[~cut], "top": surface[pressed], "side": surface[~cut & ~pressed]}
    sets = {name: np.flatnonzero(mask) for name, mask in planes.items()}
    sets |= {name: np.unique(facets[name]) for name in ("top", "side")}
    return replace(
        mesh,
        node_sets={name: found.astype(np.int32) for name, found in sets.items()},
        facet_sets=facets,
        symmetry=("x", "y", "z"),
    )
