"""
Stress under an indenter, in 3-D
================================

A notebook shows the same picture; `tisim.show(poke, "poke.html")` writes it as a page.
"""

import matplotlib.pyplot as plt

import tisim

silicone = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
poke = tisim.simulate(tisim.Poke(material=silicone, depth=0.003, refinement=0.5))

at = tisim.fields(poke).nodes
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
x, y, z = 1e3 * poke.positions[-1].T
section = abs(y) < 1e-3
drawn = axes.scatter(x[section], z[section], c=1e-3 * at.von_mises[section], s=9)
figure.colorbar(drawn, label="von Mises stress [kPa]")
axes.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", xlim=(-20, 20), title="nodes of the middle plane")

# %%
# The initial colour is displacement; the list below the picture has stress, strain energy and stretch.
tisim.show(poke)
