"""Meshes: the data type, structured beams and blocks, bodies from surfaces."""

from tisim.mesh._errors import MeshError
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
from tisim.mesh.beam import beam_mesh
from tisim.mesh.block_around import block_around
from tisim.mesh.mirror import unfold
from tisim.mesh.outline import Outline, outline
from tisim.mesh.poke_block import poke_mesh
from tisim.mesh.quadratic import to_quadratic
from tisim.mesh.quality import Quality, quality
from tisim.mesh.refine import refine_around
from tisim.mesh.sets import with_facet_set, with_node_set
from tisim.mesh.smooth import smooth
from tisim.mesh.tetrahedralise import body_from_surface

__all__ = [
    "ELEMENT_FACETS",
    "FACET_KIND",
    "NODES_PER_ELEMENT",
    "NODES_PER_FACET",
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
    "outline",
    "poke_mesh",
    "quality",
    "refine_around",
    "smooth",
    "to_quadratic",
    "unfold",
    "with_facet_set",
    "with_node_set",
]
