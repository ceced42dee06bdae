"""The surface of a mesh as triangles over its own nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def surface_triangles(facets: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Nodes of the surface (sorted mesh indices) and its triangles as indices into them.

    facets: tri3, tri6 or quad4, outward. A quad becomes two triangles (one where two of its nodes
    coincide), a 6-node triangle four; nodes on no triangle are left out.
    """
    width = facets.shape[1]
    if width == 3:
        triangles = facets
    elif width == 4:
        triangles = np.stack([facets[:, [0, 1, 2]], facets[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
    elif width == 6:
        split = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]
        triangles = facets[:, split].reshape(-1, 3)
    else:
        raise ValueError(f"facets of {width} nodes: expected 3, 4 or 6")
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    nodes, local = np.unique(triangles, return_inverse=True)
    return nodes.astype(np.int64), local.reshape(-1, 3).astype(np.int32)
