"""tisim: many soft bodies at once, by hyperelastic finite elements. SI units.

A scene goes in, a result comes out; a list of scenes keeps all cores busy:

>>> import tisim
>>> soft = tisim.material_from_moduli("neo-hookean", shear=15e3, bulk=300e3)
>>> beams = [tisim.Beam(material=soft, length=length) for length in (0.05, 0.10)]
>>> for result in tisim.simulate(beams):
...     tip = result.mesh.node_sets["tip"]
...     sag = result.mesh.nodes[tip, 2].mean() - result.positions[-1][tip, 2].mean()
...     print(f"{result.status}: the end sinks by {sag * 1e3:.0f} mm")
converged: the end sinks by 7 mm
converged: the end sinks by 69 mm

`tisim.write(result, "beam.vtu")` exports a frame, `tisim.picture(result, "beam.png")` draws it.
"""

from tisim import export, laws, mesh
from tisim._specimen import rest_positions
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
from tisim.export import surface_triangles, write
from tisim.laws import Moduli
from tisim.materials import material_from_moduli
from tisim.mesh import Mesh
from tisim.picture import picture
from tisim.result import Cost, Result, Status
from tisim.scene import Beam, Clamps, Coupon, Material, Poke, Press, Scene, Solver, Specimen, Void
from tisim.simulate import simulate

__all__ = [
    "Beam",
    "Block",
    "BoxInclusion",
    "Circle",
    "Clamps",
    "Cost",
    "Coupon",
    "CylinderInclusion",
    "Inclusion",
    "Material",
    "Mesh",
    "Moduli",
    "Poke",
    "Press",
    "Rectangle",
    "Result",
    "Rod",
    "Scene",
    "Solver",
    "Specimen",
    "SphereInclusion",
    "Status",
    "Void",
    "export",
    "laws",
    "material_from_moduli",
    "mesh",
    "picture",
    "rest_positions",
    "simulate",
    "surface_triangles",
    "write",
]
