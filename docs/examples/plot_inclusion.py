"""
A rigid sphere below the surface
================================

The same indenter is pushed 6 mm into a plain block and into one with a rigid sphere. The force rises
before the indenter reaches the sphere.
"""

import matplotlib.pyplot as plt

import tisim

tissue = tisim.material_from_moduli("ogden", shear_modulus=15e3, bulk_modulus=300e3)
size = (0.1, 0.1, 0.032)
sphere = tisim.SphereInclusion(centre=(0.0, 0.0, 0.009), radius=0.009)
blocks = {
    "plain": tisim.Block(size=size),
    "sphere of 18 mm": tisim.Block(size=size, inclusion=sphere),
}
pokes = [
    tisim.Poke(material=tissue, block=block, depth=6e-3, frame_spacing=1e-3, refinement=0.7)
    for block in blocks.values()
]
results = tisim.simulate(pokes)

figure, axes = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
for name, result in zip(blocks, results, strict=True):
    axes.plot(1e3 * result.load, result.rod_force[:, 2], "o-", label=f"{name}: {result.status}")
axes.set(xlabel="depth [mm]", ylabel="force on the indenter [N]")
axes.legend(frameon=False)
