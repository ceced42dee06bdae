"""
Indentation in ParaView or PyVista
==================================

A result is written as a VTU file of the whole body, with stress, strain and stretch at nodes and elements.
"""

import tempfile
from pathlib import Path

import pyvista as pv

import tisim

silicone = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
poke = tisim.simulate(tisim.Poke(material=silicone, depth=0.006, refinement=0.5))
file = tisim.write(poke, Path(tempfile.mkdtemp()) / "poke.vtu")

# %%
# `poke.pvd` in place of `poke.vtu` writes all frames, which ParaView plays.
body = pv.read(file)
print(*body.point_data, sep="\n")

# %%
# The block, cut open under the indenter.
half = body.clip(normal="y", origin=(0, 0, 0))
half["von Mises stress [kPa]"] = 1e-3 * half.point_data["von_mises_stress_Pa"]
plotter = pv.Plotter(window_size=(900, 500))
plotter.add_mesh(half, scalars="von Mises stress [kPa]", clim=(0, 12), n_colors=12, ambient=0.5)
plotter.camera_position = [(0.02, 0.11, 0.08), (0, 0, 0.018), (0, 0, 1)]
plotter.show()
