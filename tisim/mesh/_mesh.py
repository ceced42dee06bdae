"""The mesh of all solvers: nodes, elements of one type, named sets, mirror planes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

ElementKind = Literal["tet4", "tet10", "hex8", "hex20"]
FacetKind = Literal["tri3", "tri6", "quad4", "quad8"]

NODES_PER_ELEMENT: Mapping[ElementKind, int] = MappingProxyType(
    {"tet4": 4, "tet10": 10, "hex8": 8, "hex20": 20}
)
FACET_KIND: Mapping[ElementKind, FacetKind] = MappingProxyType(
    {"tet4": "tri3", "tet10": "tri6", "hex8": "quad4", "hex20": "quad8"}
)
NODES_PER_FACET: Mapping[FacetKind, int] = MappingProxyType({"tri3": 3, "tri6": 6, "quad4": 4, "quad8": 8})
# Nodes in the order in which they lie along a facet's outline, by their number.
FACET_OUTLINE = {3: (0, 1, 2), 4: (0, 1, 2, 3), 6: (0, 3, 1, 4, 2, 5), 8: (0, 4, 1, 5, 2, 6, 3, 7)}

# Facets of each element by local node, counter-clockwise seen from outside.
# tet10 edges: 4=(0,1) 5=(1,2) 6=(2,0) 7=(0,3) 8=(1,3) 9=(2,3) (the order of VTK_QUADRATIC_TETRA).
# hex8: 0-3 bottom counter-clockwise seen from above, 4-7 above them (VTK_HEXAHEDRON); a wedge is a
# hex8 with repeated nodes. hex20: then the edges' middles, 8-11 bottom from 8=(0,1), 12-15 top from 12=(4,5),
# 16-19 upright from 16=(0,4) (VTK_QUADRATIC_HEXAHEDRON); the middle of a collapsed edge, in a wedge, is its
# corner.
ELEMENT_FACETS: Mapping[ElementKind, tuple[tuple[int, ...], ...]] = MappingProxyType(
    {
        "tet4": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
        "tet10": ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6)),
        "hex8": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
        "hex20": (
            *((0, 3, 2, 1, 11, 10, 9, 8), (4, 5, 6, 7, 12, 13, 14, 15), (0, 1, 5, 4, 8, 17, 12, 16)),
            *((1, 2, 6, 5, 9, 18, 13, 17), (2, 3, 7, 6, 10, 19, 14, 18), (3, 0, 4, 7, 11, 16, 15, 19)),
        ),
    }
)
HEXAHEDRA: tuple[ElementKind, ...] = ("hex8", "hex20")
# a mask over the nodes (n,), or a function of their positions (n, 3) [m] that returns one
NodeMask = NDArray[np.bool_] | Callable[[NDArray[np.float64]], NDArray[np.bool_]]
# Order of an element's nodes that keeps its volume positive after a reflection.
_TURNED = {
    "tet4": (0, 2, 1, 3),
    "tet10": (0, 2, 1, 3, 6, 5, 4, 7, 9, 8),
    "hex8": (0, 3, 2, 1, 4, 7, 6, 5),
    "hex20": (0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17),
}
_TURNED_FACET = {3: (0, 2, 1), 4: (0, 3, 2, 1), 6: (0, 2, 1, 5, 4, 3), 8: (0, 3, 2, 1, 7, 6, 5, 4)}


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A body in its stress-free rest shape.

    Attributes
    ----------
    kind : "tet4", "tet10", "hex8" or "hex20"
        Type of all elements.
    nodes : ndarray of float, shape (n, 3)
        Rest positions [m].
    elements : ndarray of int32, shape (m, nodes per element)
        Node indices, in the order of VTK; positive volume.
    node_sets : mapping of str to ndarray of int32
        Named node indices (or a mask over the nodes), for example "clamp", "far_clamp", "tip", "base".
    facet_sets : mapping of str to ndarray of int32, shape (f, nodes per facet)
        Named facets, outward; "surface" is the whole boundary.
    symmetry : tuple of str
        Mirror planes of a reduced mesh, as axis names ("y"): the nodes in node_sets["mirror_y"] keep their y.
        The body's forces and volumes are those of the mesh times 2 for each plane.

    Raises
    ------
    ValueError
        For arrays of wrong shape or type, coordinates that are not finite, or node indices out of range.
    """

    kind: ElementKind
    nodes: NDArray[np.float64]
    elements: NDArray[np.int32]
    node_sets: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)
    facet_sets: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)
    symmetry: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in NODES_PER_ELEMENT:
            raise ValueError(f"mesh kind: expected one of {', '.join(NODES_PER_ELEMENT)}, got {self.kind!r}")
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        width = NODES_PER_ELEMENT[self.kind]
        if self.nodes.ndim != 2 or self.nodes.shape[1] != 3:
            raise ValueError(f"mesh nodes: expected shape (n, 3), got {self.nodes.shape}")
        object.__setattr__(self, "elements", self._indices("elements", self.elements))
        if self.elements.ndim != 2 or self.elements.shape[1] != width:
            raise ValueError(
                f"mesh elements: {self.kind} needs shape (m, {width}), got {self.elements.shape}"
            )
        if not np.isfinite(self.nodes).all():
            raise ValueError("mesh nodes: expected finite coordinates")
        node_sets = {n: self._indices(f"node set {n!r}", _chosen(v)) for n, v in self.node_sets.items()}
        object.__setattr__(self, "node_sets", node_sets)
        facet_sets = {n: self._indices(f"facet set {n!r}", v) for n, v in self.facet_sets.items()}
        object.__setattr__(self, "facet_sets", facet_sets)
        for name, found in node_sets.items():
            if found.ndim != 1:
                raise ValueError(
                    f"mesh node set {name!r}: expected indices of nodes, got shape {found.shape}"
                )
        width = NODES_PER_FACET[FACET_KIND[self.kind]]
        for name, found in facet_sets.items():
            if found.size and (found.ndim != 2 or found.shape[1] != width):
                wanted = f"the nodes of facets, shape (f, {width}), got {found.shape}"
                raise ValueError(f"mesh facet set {name!r}: expected {wanted}")
        for name in self.symmetry:
            if name not in ("x", "y", "z") or f"mirror_{name}" not in node_sets:
                wanted = "axis names, each with its node set (mirror_y)"
                raise ValueError(f"mesh symmetry: expected {wanted}, got {self.symmetry!r}")

    def _indices(self, what: str, values: object) -> NDArray[np.int32]:
        """Node indices as int32, as they are where they are that already."""
        found = np.asarray(values)
        if found.size and not np.issubdtype(found.dtype, np.integer):
            raise ValueError(f"mesh {what}: expected whole numbers, indices of nodes, got {found.dtype}")
        if found.size and (found.min() < 0 or found.max() >= len(self.nodes)):
            raise ValueError(f"mesh {what}: a node index is out of range")
        return np.ascontiguousarray(found, dtype=np.int32)

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def n_elements(self) -> int:
        """Number of elements."""
        return len(self.elements)


def _chosen(values: object) -> object:
    """Indices where a mask is True."""
    found = np.asarray(values)
    return np.flatnonzero(found) if found.dtype == np.bool_ and found.ndim == 1 else values


def boundary_facets(kind: ElementKind, elements: NDArray[np.int32]) -> NDArray[np.int32]:
    """Facets that belong to one element only, shape (f, nodes per facet), outward.

    Facets of a wedge (a hexahedron with repeated nodes) that collapse to a line are dropped.
    """
    local = np.array(ELEMENT_FACETS[kind], dtype=np.int64)
    facets = elements[:, local].reshape(-1, local.shape[1])
    n_corner = 4 if kind in HEXAHEDRA else 3
    corners = np.sort(facets[:, :n_corner].astype(np.int64), axis=1)
    twin = np.diff(corners, axis=1) == 0
    keep = twin.sum(axis=1) <= n_corner - 3
    facets, corners, twin = facets[keep], corners[keep], twin[keep]
    if kind in HEXAHEDRA:
        # a triangle may appear as (a, a, b, c) in one wedge and (a, b, b, c) in its neighbour: (-1, a, b, c)
        corners[:, 1:][twin] = -1
        corners.sort(axis=1)
    _, first, count = np.unique(_row_keys(corners), return_index=True, return_counts=True)
    return np.ascontiguousarray(facets[np.sort(first[count == 1])], dtype=np.int32)


def _row_keys(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number per row, equal for equal rows (entries >= -1): much faster to sort than rows."""
    keys = rows[:, 0] + 1
    for column in rows.T[1:]:
        base = int(column.max(initial=0)) + 2
        if int(keys.max(initial=0)) + 1 > np.iinfo(np.int64).max // base:
            keys = np.unique(keys, return_inverse=True)[1]  # ranks: fewer than there are rows
        keys = keys * base + column + 1
    return keys


class MeshError(ValueError):
    """A body cannot be meshed; the message states in one sentence what to change."""


def free_length(mesh: Mesh, held: tuple[str, ...]) -> float:
    """Free length of a held body [m].

    With one held node set it is the largest distance of a node from the set's bounding box, with two the
    distance between their boxes. NaN if a set is missing or empty.
    """
    sets = [mesh.nodes[mesh.node_sets[name]] for name in held if len(mesh.node_sets.get(name, ()))]
    if len(sets) < len(held):
        return float("nan")
    low, high = sets[0].min(axis=0), sets[0].max(axis=0)
    if len(sets) == 1:
        nodes = mesh.nodes[np.unique(mesh.elements)]
        return float(np.linalg.norm(nodes - np.clip(nodes, low, high), axis=1).max(initial=0.0))
    gaps = np.maximum(sets[1].min(axis=0) - high, low - sets[1].max(axis=0))
    return float(np.linalg.norm(np.maximum(gaps, 0.0)))


def with_node_set(mesh: Mesh, name: str, mask: NodeMask) -> Mesh:
    """The mesh with one more node set.

    Parameters
    ----------
    mesh : Mesh
    name : str
    mask : ndarray of bool, shape (n,), or callable
        Nodes to take, or a function of their positions (n, 3) [m] that gives the mask.

    Returns
    -------
    Mesh

    Raises
    ------
    MeshError
        If the set would be empty, or the mask is not one boolean per node.
    """
    chosen = np.flatnonzero(_mask(mesh, name, mask)).astype(np.int32)
    if not len(chosen):
        raise MeshError(f"node set {name!r} would be empty: no node lies where it was asked for")
    return replace(mesh, node_sets={**mesh.node_sets, name: chosen})


def with_facet_set(mesh: Mesh, name: str, mask: NodeMask) -> Mesh:
    """The mesh with one more facet set: the boundary facets whose nodes are all in the mask.

    Parameters
    ----------
    mesh : Mesh
    name : str
    mask : ndarray of bool, shape (n,), or callable
        Nodes to take, or a function of their positions (n, 3) [m] that gives the mask.

    Returns
    -------
    Mesh

    Raises
    ------
    MeshError
        If the set would be empty, or the mask is not one boolean per node.
    """
    facets = mesh.facet_sets.get("surface")
    if facets is None:
        facets = boundary_facets(mesh.kind, mesh.elements)
    chosen = facets[_mask(mesh, name, mask)[facets].all(axis=1)]
    if not len(chosen):
        raise MeshError(f"facet set {name!r} would be empty: no boundary facet lies where it was asked for")
    return replace(mesh, facet_sets={**mesh.facet_sets, name: chosen})


def _mask(mesh: Mesh, name: str, mask: NodeMask) -> NDArray[np.bool_]:
    result = np.asarray(mask(mesh.nodes) if callable(mask) else mask)
    if result.shape != (mesh.n_nodes,) or result.dtype != np.bool_:
        raise MeshError(
            f"set {name!r}: the mask must be {mesh.n_nodes} booleans, one a node, "
            f"got shape {result.shape} of {result.dtype}"
        )
    return result


def unfold(mesh: Mesh, positions: NDArray[np.float64]) -> tuple[Mesh, NDArray[np.float64]]:
    """The whole body of a mesh reduced by mirror planes, and its node positions.

    Parameters
    ----------
    mesh : Mesh
    positions : ndarray, shape (..., n, 3)
        Node positions of the mesh [m].

    Returns
    -------
    mesh : Mesh
        The whole body; the nodes of the given mesh come first, in their order. Node and facet sets contain
        both halves; sets of the mirror planes are dropped.
    positions : ndarray, shape (..., whole n, 3)
        Node positions of the whole body [m].
    """
    for name in mesh.symmetry:
        mesh, positions = _unfold_once(mesh, positions, name)
    return mesh, positions


def _unfold_once(mesh: Mesh, positions: NDArray[np.float64], name: str) -> tuple[Mesh, NDArray[np.float64]]:
    axis, n = "xyz".index(name), mesh.n_nodes
    plane = f"mirror_{name}"
    copied = np.ones(n, dtype=bool)
    copied[mesh.node_sets[plane]] = False
    twin = np.arange(n)
    twin[copied] = n + np.arange(copied.sum())
    sign = np.ones(3)
    sign[axis] = -1.0
    nodes = np.concatenate([mesh.nodes, mesh.nodes[copied] * sign])
    moved = np.concatenate([positions, positions[..., copied, :] * sign], axis=-2)
    elements = np.concatenate([mesh.elements, twin[mesh.elements[:, _TURNED[mesh.kind]]]])
    facets = {
        key: np.concatenate([f, twin[f[:, _TURNED_FACET[f.shape[1]]]]]).astype(np.int32)
        for key, f in mesh.facet_sets.items()
        if key != plane
    }
    sets = {
        key: np.unique(np.concatenate([s, twin[s]])).astype(np.int32)
        for key, s in mesh.node_sets.items()
        if key != plane
    }
    whole = replace(
        mesh,
        nodes=nodes,
        elements=elements.astype(np.int32),
        node_sets=sets,
        facet_sets=facets,
        symmetry=tuple(s for s in mesh.symmetry if s != name),
    )
    return whole, moved
