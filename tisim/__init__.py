"""tisim: many soft bodies at once, by hyperelastic finite elements. SI units.

A scene goes in, a result comes out; a list of scenes keeps all cores busy:

>>> import tisim
>>> soft = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
>>> beams = [tisim.Beam(material=soft, length=length) for length in (0.05, 0.10)]
>>> for result in tisim.simulate(beams):
...     tip = result.mesh.node_sets["tip"]
...     sag = result.mesh.nodes[tip, 2].mean() - result.positions[-1][tip, 2].mean()
...     print(f"{result.status}: the end sinks by {sag * 1e3:.0f} mm")
converged: the end sinks by 7 mm
converged: the end sinks by 69 mm

`tisim.show(result, "beam.html")` writes a page to turn it around, `tisim.picture(result, "beam.png")` draws
it, `tisim.write(result, "beam.vtu")` exports a frame, `tisim.fields(result)` has stress, strain and stretch,
`tisim.read("body.inp")` takes a mesh of another program (.inp, .msh, .vtu) with its sets. Laws,
inclusion shapes and kinds of scenes of one's own are registered: `tisim.laws`, `tisim.inclusions`,
`tisim.problems`.
"""

from tisim import _extensions, inclusions, laws, mesh, parts, problems
from tisim.bodies import (
    Block,
    BoxInclusion,
    Circle,
    CylinderInclusion,
    Inclusion,
    Rectangle,
    Rod,
    SphereInclusion,
)
from tisim.course import Course
from tisim.fields import Fields, Quantities, fields, fields_of_frames
from tisim.io import export
from tisim.io.export import surface_triangles, write
from tisim.io.picture import picture
from tisim.io.read import read
from tisim.laws import Moduli
from tisim.mesh import Mesh
from tisim.parts import HolzapfelGasserOgden, OgdenRoxburgh, Prony
from tisim.problems.beam.rest_shape import rest_positions
from tisim.problems.dynamics.paper_stop import PaperStop, paper_stop
from tisim.result import Cost, Result, Status, frame_index
from tisim.scene import (
    Beam,
    ClampImperfections,
    Coupon,
    Imperfections,
    Material,
    Poke,
    Press,
    Scene,
    Solver,
    Void,
    material_from_moduli,
)
from tisim.simulate import simulate
from tisim.view import show

__version__ = "0.1.0"

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
    "__version__",
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

_extensions.load()
