"""
A beam under its own weight
===========================

Three cantilevers of one silicone, 50, 75 and 100 mm long.
"""

import matplotlib.pyplot as plt

import tisim

silicone = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=300e3)
beams = [tisim.Beam(material=silicone, length=length) for length in (0.050, 0.075, 0.100)]
results = tisim.simulate(beams)

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for beam, result in zip(beams, results, strict=True):
    x, _, z = 1e3 * result.positions[-1].T
    axes.plot(x, z, ".", markersize=2, label=f"{1e3 * beam.length:.0f} mm: {result.status}")
axes.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal")
axes.legend(frameon=False)
