"""Surfaces of meshes as triangles, for drawing, files and datasets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import Mesh, boundary_facets

# Triangles of a facet, by its number of nodes; facets of six or eight are cut at their middle nodes.
_CUTS = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
}


def triangles(facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Triangles of facets.

    Parameters
    ----------
    facets : ndarray of int, shape (f, nodes per facet)
        Facets of 3, 4, 6 or 8 nodes each, outward.

    Returns
    -------
    ndarray of int, shape (t, 3)
        Node indices, outward, facet by facet; triangles that collapse (of wedges) are dropped.

    Raises
    ------
    ValueError
        For facets of another number of nodes.
    """
    width = facets.shape[1]
    if width not in _CUTS:
        raise ValueError(f"facets of {width} nodes: expected 3, 4, 6 or 8")
    cut = facets[:, _CUTS[width]].reshape(-1, 3)
    a, b, c = cut.T
    return np.ascontiguousarray(cut[(a != b) & (b != c) & (c != a)])


def surface_triangles(mesh: Mesh) -> NDArray[np.int32]:
    """Triangles of a mesh's boundary, node indices (t, 3), outward.

    A half model is open at its mirror plane; `tisim.mesh.unfold` returns the whole body.
    """
    facets = mesh.facet_sets.get("surface")
    return triangles(boundary_facets(mesh.kind, mesh.elements) if facets is None else facets)
