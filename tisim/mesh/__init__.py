"""Meshes: the data type, structured beams and blocks, bodies from surfaces."""

from tisim.mesh._mesh import (
    ELEMENT_FACETS,
    FACET_KIND,
    NODES_PER_ELEMENT,
    NODES_PER_FACET,
    ElementKind,
    FacetKind,
    Mesh,
    boundary_facets,
)

__all__ = [
    "ELEMENT_FACETS",
    "FACET_KIND",
    "NODES_PER_ELEMENT",
    "NODES_PER_FACET",
    "ElementKind",
    "FacetKind",
    "Mesh",
    "boundary_facets",
]
