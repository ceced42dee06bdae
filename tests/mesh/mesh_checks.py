"""Assertions that every mesh must satisfy."""

import numpy as np

from tisim.mesh._elements import TET_EDGES
from tisim.mesh._mesh import ELEMENT_FACETS, Mesh, boundary_facets
from tisim.mesh.quality import nodal_determinants, volumes


def assert_conforming(mesh: Mesh) -> None:
    """Assert that the mesh is conforming.

    Every facet belongs to one element, or to two with the same nodes in opposite orientation. Every edge of
    10-node tetrahedra has one mid-side node. Every node is used.
    """
    assert np.array_equal(np.unique(mesh.elements), np.arange(mesh.n_nodes))
    local = np.array(ELEMENT_FACETS[mesh.kind])
    facets = mesh.elements[:, local].reshape(-1, local.shape[1])
    _, count = np.unique(np.sort(facets, axis=1), axis=0, return_counts=True)
    assert set(count.tolist()) <= {1, 2}
    # seen from two sides, a facet has opposite orientations: each directed edge occurs as often as its
    # reverse in the interior, and the remainder is a closed, oriented boundary
    assert_closed(boundary_facets(mesh.kind, mesh.elements), mesh)
    assert (count == 1).sum() == len(boundary_facets(mesh.kind, mesh.elements))
    if mesh.kind == "tet10":
        pairs = np.sort(mesh.elements[:, TET_EDGES].reshape(-1, 2), axis=1)
        with_middle = np.unique(np.column_stack([pairs, mesh.elements[:, 4:].ravel()]), axis=0)
        assert len(with_middle) == len(np.unique(pairs, axis=0)) == len(np.unique(with_middle[:, 2]))


def assert_closed(facets: np.ndarray, mesh: Mesh, euler: int = 2) -> None:
    """Assert that a surface is closed, oriented outwards and of Euler characteristic `euler` (sphere: 2)."""
    corners = facets[:, :4] if mesh.kind == "hex8" else facets[:, :3]
    directed = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    assert len(np.unique(directed, axis=0)) == len(directed)
    assert {tuple(e) for e in directed.tolist()} == {tuple(e) for e in directed[:, ::-1].tolist()}
    assert len(np.unique(corners)) - len(directed) // 2 + len(corners) == euler
    x = mesh.nodes[corners]
    if corners.shape[1] == 4:
        x = np.concatenate([x[:, [0, 1, 2]], x[:, [0, 2, 3]]])
    assert np.linalg.det(x).sum() > 0


def assert_positive(mesh: Mesh) -> None:
    """Assert that det J at every node exceeds 5 % of the element's largest, and that volumes are positive."""
    assert (nodal_determinants(mesh) > 0.05 * np.abs(nodal_determinants(mesh)).max(axis=1)[:, None]).all()
    assert volumes(mesh).min() > 0


def facet_set(facets: np.ndarray) -> set[tuple[int, ...]]:
    """Set of facets, independent of the order of their nodes."""
    return {tuple(f) for f in np.sort(facets, axis=1).tolist()}
