"""Two answers to one question that differ a little, and by what: prints two tables.

    python -m benchmarks.small_differences       # ten seconds

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

At once: the sag of a cantilever of a viscous material at time 0 against an elastic one of the instantaneous
modulus. The part of the bulk modulus that 10-node tetrahedra take at their points is a multiple of the
long-time shear modulus; with the same part in pascals the elastic beam is the viscous one, where all of the
law's W relaxes (Mooney-Rivlin; neo-Hookean's W has a volumetric part of its own).
Released: the tip's way by BDF2 against central differences, of a beam with fibres along it and without.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

import tisim
from tisim.discretisation import body

PRONY = tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
FIBRES = tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=5e4, k2=1.0)
STEPS = (2e-3, 1e-3, 5e-4, 2.5e-4)  # of BDF2 [s]
END = 0.05  # [s]


def sag(result: tisim.Result) -> np.ndarray:
    """Downward displacement of the free end in each frame [m], shape (f,)."""
    tip = result.mesh.node_sets["tip"]
    return np.asarray(-(result.positions - result.mesh.nodes)[:, tip, 2].mean(axis=1))


def at_once(law: str) -> list[float]:
    """Viscous over elastic sag less 1: with the elastic beam's own pointwise stiffness, the viscous one's."""
    moduli = {"bulk_modulus": 1e9}
    soft = tisim.material_from_moduli(law, shear_modulus=1e6, **moduli)
    more = PRONY.spectrum().instantaneous
    stiff = tisim.material_from_moduli(law, shear_modulus=more * 1e6, **moduli)
    beam = tisim.Beam(material=stiff, length=0.05, solver=tisim.Solver(tolerance=1e-8))
    course = tisim.Course(frames=(0.0,)).jump(1.0).hold(1.0)
    viscous = sag(tisim.simulate(replace(beam, material=replace(soft, viscosity=PRONY), course=course)))[0]
    own = body.POINTWISE["tet10"]
    found = []
    try:
        for part in (own, own / more):
            body.POINTWISE["tet10"] = part
            found.append(float(viscous / sag(tisim.simulate(beam))[0]) - 1.0)
    finally:
        body.POINTWISE["tet10"] = own
    return found


def released(material: tisim.Material) -> list[tuple[float, float, float]]:
    """Steps of BDF2 [s], each with the sag's relative error against central differences, at 10 ms and END."""
    beam = tisim.Beam(material=material, length=0.06, axial_element_size=0.01, radial_elements=1)
    explicit = tisim.simulate(replace(beam, solver=tisim.Solver(method="explicit", duration=END)))
    assert explicit.time is not None
    found = []
    for step in STEPS:
        solver = tisim.Solver(method="implicit", duration=END, time_step=step)
        implicit = tisim.simulate(replace(beam, solver=solver))
        assert implicit.time is not None
        early, late = (
            float(np.interp(t, implicit.time, sag(implicit)) / np.interp(t, explicit.time, sag(explicit)))
            - 1.0
            for t in (0.01, END)
        )
        found.append((step, early, late))
    return found


def main() -> None:
    print("at once             own pointwise stiffness   the viscous beam's")
    for law in ("neo-hookean", "mooney-rivlin"):
        own, same = at_once(law)
        print(f"{law:18s} {own:+24.4%} {same:+20.4%}")
    soft = tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=6e5)
    print(f"released            step    at 10 ms   at {1e3 * END:.0f} ms")
    for name, material in (("with fibres", replace(soft, fibres=FIBRES)), ("without", soft)):
        for step, early, late in released(material):
            print(f"{name:16s} {1e3 * step:5.2f} ms {early:+10.1%} {late:+10.1%}")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
