"""
One modulus, seven laws
=======================

All laws have the same shear modulus at small strain. They differ beyond a stretch of 1.5: a calibration
with smaller stretches cannot distinguish them.
"""

import matplotlib.pyplot as plt
import numpy as np

import tisim

stretch = np.linspace(0.6, 2.2, 60)
laws = (
    "neo-hookean",
    "mooney-rivlin",
    "ogden",
    "yeoh",
    "arruda-boyce",
    "eight-chain",
    "stiffening-neo-hookean",
)
coupons = [
    tisim.Coupon(
        material=tisim.material_from_moduli(law, shear_modulus=20e3, bulk_modulus=20e6),
        stretches=tuple(stretch),
    )
    for law in laws
]

figure, axes = plt.subplots(figsize=(6.4, 4), layout="constrained")
for law, result in zip(laws, tisim.simulate(coupons), strict=True):
    axes.plot(stretch, 1e-3 * result.nominal_stress, label=law)
axes.axhline(0.0, color="0.8", linewidth=0.8)
axes.set(xlabel="stretch", ylabel="nominal stress [kPa]")
axes.legend(frameon=False)
