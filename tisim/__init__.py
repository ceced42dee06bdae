"""tisim: many soft bodies at once, by hyperelastic finite elements. SI units.

`simulate` solves one scene, or a list of scenes on all cores:

>>> import tisim
>>> soft = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
>>> beams = [tisim.Beam(material=soft, length=length) for length in (0.05, 0.10)]
>>> for result in tisim.simulate(beams):
...     tip = result.mesh.node_sets["tip"]
...     sag = result.mesh.nodes[tip, 2].mean() - result.positions[-1][tip, 2].mean()
...     print(f"{result.status}: the end sinks by {sag * 1e3:.0f} mm")
converged: the end sinks by 7 mm
converged: the end sinks by 69 mm

`tisim.show(result, "beam.html")` writes an interactive page, `tisim.picture(result, "beam.png")` draws an
image, `tisim.write(result, "beam.vtu")` exports a frame, `tisim.fields(result)` computes stress, strain and
stretch, and `tisim.read("body.inp")` reads a mesh of another program (.inp, .msh, .vtu) with its sets. Users
can register their own laws, inclusion shapes and kinds of scenes: see `tisim.laws`, `tisim.inclusions` and
`tisim.problems`.
"""

import lazy_loader as _lazy

from tisim import _extensions

__version__ = "0.1.0"

# the public names, in __init__.pyi, are imported on first use: a command's --help needs none
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)

_extensions.load()
