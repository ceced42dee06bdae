"""Triangles of a mesh's surface: closed, outward, and of each kind of facet."""

import numpy as np
import pytest

from tisim.mesh import surface_triangles, triangles
from tisim.mesh._elements import NODE_PLACES
from tisim.mesh._mesh import Mesh


@pytest.mark.parametrize(("kind", "count"), [("tet4", 4), ("tet10", 16), ("hex8", 12), ("hex20", 36)])
def test_triangles_of_an_element_enclose_its_volume(kind, count):
    nodes = NODE_PLACES[kind]
    corners = nodes[surface_triangles(Mesh(kind=kind, nodes=nodes, elements=np.arange(len(nodes))[None]))]
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert len(corners) == count
    assert volume == pytest.approx(1 / 6 if kind.startswith("tet") else 8)


def test_collapsed_triangles_are_dropped():
    assert triangles(np.array([[4, 4, 7, 9], [4, 7, 9, 9]], dtype=np.int32)).tolist() == [
        [4, 7, 9],
        [4, 7, 9],
    ]


def test_facets_of_five_nodes_are_refused():
    with pytest.raises(ValueError, match="facets of 5 nodes: expected 3, 4, 6 or 8"):
        triangles(np.zeros((1, 5), dtype=np.int32))
