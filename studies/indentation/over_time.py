"""How far the force of a fit over time is from a simulation of the viscous body, on one mesh.

    python -m studies.indentation.over_time        # minutes of one core

A rod is pushed to a depth, held, and drawn back to a tenth of it. The fit's force follows from the elastic
curve (`calibration.measurements.indentation._memory_force`); the simulation is `tisim.Poke` with a `Course`.
Errors are over the largest force.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import tisim
from calibration.measurements.indentation._curve import FLAT, ROUND
from calibration.measurements.indentation._memory_force import loads, stiffnesses, thresholds
from tisim.course import Course

Array = NDArray[np.float64]

SHEAR = 2e4
PRONY = tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
MATERIAL = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR)
BLOCK = tisim.Block(size=(0.04, 0.04, 0.02))
RODS = {
    "ball, 4 mm": tisim.Rod(radius=0.004, tip="hemisphere"),
    "flat, 2.5 mm": tisim.Rod(radius=0.0025, tip="flat", edge_radius=0.001),
}
DEPTHS = {"a fifth of the radius": 0.2, "half the radius": 0.5}
PHASES = ("loading", "hold", "retraction")


def compared(rod: tisim.Rod, depth: float) -> tuple[Array, Array, Array]:
    """Time, simulated force and the fit's, of all frames; shape (f,)."""
    ramp, hold = 5.0, 40.0
    course = Course(start=0.0, growth=0.5).ramp(to=depth, duration=ramp).hold(hold)
    course = course.ramp(to=0.1 * depth, duration=ramp)
    scene = tisim.Poke(material=MATERIAL, depth=depth, block=BLOCK, rod=rod, frame_spacing=depth / 20.0)
    (elastic,) = tisim.simulate([scene], workers=1)
    viscous = replace(MATERIAL, viscosity=PRONY)
    (simulated,) = tisim.simulate(
        [replace(scene, material=viscous, course=course, mesh=elastic.mesh)], workers=1
    )
    for result in (elastic, simulated):
        if result.status != "converged":
            raise SystemExit(f"{rod.tip}: {result.message}")
    assert elastic.rod_force is not None
    assert simulated.rod_force is not None
    assert simulated.time is not None
    power = ROUND if rod.tip == "hemisphere" else FLAT
    at = np.concatenate([[0.0], elastic.load])
    root = np.concatenate([[0.0], np.maximum(elastic.rod_force[:, 2], 0.0) ** (1.0 / power)])
    met = thresholds(depth)
    springs = stiffnesses(met, np.interp(met, at, root) ** power)
    fine = np.unique(np.concatenate([np.linspace(0.0, course.duration, 401), simulated.time]))
    driven = np.array([course.value(float(t)) for t in fine])
    found = loads(PRONY.spectrum(), fine, driven, met[:-1]) @ springs
    return simulated.time, simulated.rod_force[:, 2], np.interp(simulated.time, fine, found)


def main() -> int:
    print("| indenter | depth | " + " | ".join(PHASES) + " |")
    print("| --- " * (2 + len(PHASES)) + "|")
    for name, rod in RODS.items():
        for depth, part in DEPTHS.items():
            time, simulated, found = compared(rod, part * rod.radius)
            error = (found - simulated) / np.abs(simulated).max()
            phases = (time <= 5.0, (time > 5.0) & (time <= 45.0), time > 45.0)
            cells = [
                f"{100 * error[p].mean():+.2f} %, at most {100 * np.abs(error[p]).max():.2f} %"
                for p in phases
            ]
            print(f"| {name} | {depth} | " + " | ".join(cells) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
