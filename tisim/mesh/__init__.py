"""Meshes: the data type, structured beams and blocks, bodies from surfaces."""

from tisim.mesh._elements import facet_shape_functions
from tisim.mesh._mesh import (
    ELEMENT_FACETS,
    FACET_KIND,
    FACET_OUTLINE,
    NODES_PER_ELEMENT,
    NODES_PER_FACET,
    ElementKind,
    FacetKind,
    Mesh,
    MeshError,
    boundary_facets,
    unfold,
    with_facet_set,
    with_node_set,
)
from tisim.mesh._triangles import surface_triangles, triangles
from tisim.mesh.beam import PAPER_LAYER, PAPER_RINGS, Outline, beam_mesh, outline
from tisim.mesh.block_around import block_around
from tisim.mesh.indentation import poke_mesh
from tisim.mesh.quality import Quality, quality, smooth, volumes
from tisim.mesh.refine import refine_around, to_quadratic
from tisim.mesh.surface import checked_surface
from tisim.mesh.tetrahedralise import body_from_surface

__all__ = [
    "ELEMENT_FACETS",
    "FACET_KIND",
    "FACET_OUTLINE",
    "NODES_PER_ELEMENT",
    "NODES_PER_FACET",
    "PAPER_LAYER",
    "PAPER_RINGS",
    "ElementKind",
    "FacetKind",
    "Mesh",
    "MeshError",
    "Outline",
    "Quality",
    "beam_mesh",
    "block_around",
    "body_from_surface",
    "boundary_facets",
    "checked_surface",
    "facet_shape_functions",
    "outline",
    "poke_mesh",
    "quality",
    "refine_around",
    "smooth",
    "surface_triangles",
    "to_quadratic",
    "triangles",
    "unfold",
    "volumes",
    "with_facet_set",
    "with_node_set",
]
