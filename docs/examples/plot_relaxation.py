"""
A silicone that relaxes and softens
===================================

A strip is pulled to a stretch of 1.4, held for 30 s, and unloaded. Viscosity (a Prony series) relaxes the
stress, Mullins' effect makes the way back softer than the way there. What both dissipate never falls.
"""

import matplotlib.pyplot as plt

import tisim

law = {"law": "neo-hookean", "parameters": {"mu": 20e3, "lam": 1e6}}
viscosity = tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
softening = tisim.OgdenRoxburgh(r=2.0, m=2e3)
materials = {
    "elastic": tisim.Material(**law),
    "viscous": tisim.Material(**law, viscosity=viscosity),
    "viscous and softening": tisim.Material(**law, viscosity=viscosity, softening=softening),
}
pull = tisim.Course(start=1.0).ramp(to=1.4, speed=0.1).hold(30.0).ramp(to=1.0, speed=0.1)
results = tisim.simulate([tisim.Coupon(material=m, course=pull) for m in materials.values()])

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
for name, result in zip(materials, results, strict=True):
    left.plot(result.time, 1e-3 * result.nominal_stress, label=name)
    if result.dissipated is not None:  # an elastic strip loses nothing
        right.plot(result.time, 1e3 * result.dissipated, label=name)
left.set(xlabel="time [s]", ylabel="nominal stress [kPa]")
right.set(xlabel="time [s]", ylabel="dissipated [mJ]")
left.legend(frameon=False)
