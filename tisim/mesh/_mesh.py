"""The mesh that every solver of tisim works on: nodes, one kind of element, named sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

ElementKind = Literal["tet4", "tet10", "hex8"]
FacetKind = Literal["tri3", "tri6", "quad4"]

NODES_PER_ELEMENT: Mapping[ElementKind, int] = MappingProxyType({"tet4": 4, "tet10": 10, "hex8": 8})
FACET_KIND: Mapping[ElementKind, FacetKind] = MappingProxyType(
    {"tet4": "tri3", "tet10": "tri6", "hex8": "quad4"}
)
NODES_PER_FACET: Mapping[FacetKind, int] = MappingProxyType({"tri3": 3, "tri6": 6, "quad4": 4})

# Facets of each element by local node, counter-clockwise seen from outside.
# tet10 edges: 4=(0,1) 5=(1,2) 6=(2,0) 7=(0,3) 8=(1,3) 9=(2,3) (the order of VTK_QUADRATIC_TETRA).
# hex8: 0-3 bottom counter-clockwise seen from above, 4-7 above them (VTK_HEXAHEDRON); a wedge is a
# hex8 with repeated nodes.
ELEMENT_FACETS: Mapping[ElementKind, tuple[tuple[int, ...], ...]] = MappingProxyType(
    {
        "tet4": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
        "tet10": ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6)),
        "hex8": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    }
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A body in its stress-free rest shape.

    kind: the element kind of all elements.
    nodes: rest positions [m], shape (n, 3), float64.
    elements: node indices, shape (m, nodes per element), int32, positive volume.
    node_sets: named node indices, for example "clamp", "far_clamp", "tip", "base".
    facet_sets: named facets, shape (f, nodes per facet), outward; "surface" is the whole boundary.
    symmetry: mirror planes the mesh is cut by, as axis names ("y"): the nodes in node_sets["mirror_y"]
        keep their y; forces and volumes of the whole body are twice those of the mesh.
    """

    kind: ElementKind
    nodes: NDArray[np.float64]
    elements: NDArray[np.int32]
    node_sets: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)
    facet_sets: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)
    symmetry: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        object.__setattr__(self, "elements", np.ascontiguousarray(self.elements, dtype=np.int32))
        width = NODES_PER_ELEMENT[self.kind]
        if self.nodes.ndim != 2 or self.nodes.shape[1] != 3:
            raise ValueError(f"mesh nodes: expected shape (n, 3), got {self.nodes.shape}")
        if self.elements.ndim != 2 or self.elements.shape[1] != width:
            raise ValueError(
                f"mesh elements: {self.kind} needs shape (m, {width}), got {self.elements.shape}"
            )
        if not np.isfinite(self.nodes).all():
            raise ValueError("mesh nodes: expected finite coordinates")
        if self.elements.size and (self.elements.min() < 0 or self.elements.max() >= len(self.nodes)):
            raise ValueError("mesh elements: a node index is out of range")

    @property
    def n_nodes(self) -> int:
        return len(self.nodes)

    @property
    def n_elements(self) -> int:
        return len(self.elements)


def boundary_facets(kind: ElementKind, elements: NDArray[np.int32]) -> NDArray[np.int32]:
    """Facets that belong to one element only, shape (f, nodes per facet), outward.

    Facets of a wedge (hex8 with repeated nodes) that collapse to a line are dropped.
    """
    local = np.array(ELEMENT_FACETS[kind], dtype=np.int64)
    facets = elements[:, local].reshape(-1, local.shape[1])
    n_corner = 4 if kind == "hex8" else 3
    corners = np.sort(facets[:, :n_corner].astype(np.int64), axis=1)
    twin = np.diff(corners, axis=1) == 0
    keep = twin.sum(axis=1) <= n_corner - 3
    facets, corners, twin = facets[keep], corners[keep], twin[keep]
    if kind == "hex8":
        # a triangle may appear as (a, a, b, c) in one wedge and (a, b, b, c) in its neighbour: (-1, a, b, c)
        corners[:, 1:][twin] = -1
        corners.sort(axis=1)
    _, first, count = np.unique(_row_keys(corners), return_index=True, return_counts=True)
    return np.ascontiguousarray(facets[np.sort(first[count == 1])], dtype=np.int32)


def _row_keys(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number a row, equal for equal rows (entries from -1): far faster to sort than rows."""
    keys = rows[:, 0] + 1
    for column in rows.T[1:]:
        base = int(column.max(initial=0)) + 2
        if int(keys.max(initial=0)) + 1 > np.iinfo(np.int64).max // base:
            keys = np.unique(keys, return_inverse=True)[1]  # ranks: fewer than there are rows
        keys = keys * base + column + 1
    return keys
