from . import inclusions, laws, mesh, parts, problems
from .bodies import (
    Block,
    BoxInclusion,
    Circle,
    CylinderInclusion,
    Inclusion,
    Rectangle,
    Rod,
    SphereInclusion,
)
from .course import Course
from .fields import Fields, Quantities, fields, fields_of_frames
from .io import export
from .io.export import write
from .io.picture import picture
from .io.read import read
from .laws import Moduli
from .material import Material, material_from_moduli
from .mesh import Mesh, surface_triangles
from .parts import HolzapfelGasserOgden, OgdenRoxburgh, Prony
from .problems.beam.rest_shape import rest_positions
from .problems.dynamics.paper_stop import PaperStop, paper_stop
from .result import Cost, Result, Status, frame_index
from .scene import (
    Beam,
    ClampImperfections,
    Coupon,
    Imperfections,
    Poke,
    Press,
    Scene,
    Solver,
    Void,
)
from .simulate import simulate
from .view import show

__version__: str

__all__ = [
    "Beam",
    "Block",
    "BoxInclusion",
    "Circle",
    "ClampImperfections",
    "Cost",
    "Coupon",
    "Course",
    "CylinderInclusion",
    "Fields",
    "HolzapfelGasserOgden",
    "Imperfections",
    "Inclusion",
    "Material",
    "Mesh",
    "Moduli",
    "OgdenRoxburgh",
    "PaperStop",
    "Poke",
    "Press",
    "Prony",
    "Quantities",
    "Rectangle",
    "Result",
    "Rod",
    "Scene",
    "Solver",
    "SphereInclusion",
    "Status",
    "Void",
    "export",
    "fields",
    "fields_of_frames",
    "frame_index",
    "inclusions",
    "laws",
    "material_from_moduli",
    "mesh",
    "paper_stop",
    "parts",
    "picture",
    "problems",
    "read",
    "rest_positions",
    "show",
    "simulate",
    "surface_triangles",
    "write",
]
