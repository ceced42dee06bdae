"""How far the force of a fit over time is from a simulation of the viscous body, on one mesh.

    python -m studies.indentation.over_time --stored        # a second: against the forces that FElupe stored
    python -m studies.indentation.over_time                 # and half a minute: against `tisim.Poke`

The fit's force follows from the elastic curve (`calibration.measurements.indentation._memory_force`). Stored
forces are those of `benchmarks.blind.timed.solve_indentation`: the flat rod's, whose elastic curve is its own
step to 1.2 mm, divided by the instantaneous modulus over the long-time one. `tisim.Poke` with a `Course` is
pushed to a depth, held, and drawn back to a tenth of it, on the mesh of its elastic curve. Errors are over
the largest force.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

import tisim
from benchmarks.blind.timed.indentation import load
from calibration.measurements.indentation._curve import FLAT, ROUND
from calibration.measurements.indentation._memory_force import loads, stiffnesses, thresholds
from tisim import Prony
from tisim.course import Course

Array = NDArray[np.float64]

SHEAR = 2e4
PRONY = Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
MATERIAL = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR)
BLOCK = tisim.Block(size=(0.04, 0.04, 0.02))
RODS = {
    "ball, 4 mm": tisim.Rod(radius=0.004, tip="hemisphere"),
    "flat, 2.5 mm": tisim.Rod(radius=0.0025, tip="flat", edge_radius=0.001),
}
DEPTHS = {"a fifth of the radius": 0.2}
REFINEMENT = 0.5  # of the meshes: both forces have the same error
PHASES = ("loading", "hold", "retraction")


def compared(rod: tisim.Rod, depth: float) -> tuple[Array, Array, Array]:
    """Time, simulated force and the fit's, of all frames; shape (f,)."""
    ramp, hold = 5.0, 40.0
    course = Course(start=0.0, growth=0.5).ramp(to=depth, duration=ramp).hold(hold)
    course = course.ramp(to=0.1 * depth, duration=ramp)
    scene = tisim.Poke(
        material=MATERIAL,
        depth=depth,
        block=BLOCK,
        rod=rod,
        frame_spacing=depth / 20.0,
        refinement=REFINEMENT,
    )
    (elastic,) = tisim.simulate([scene], workers=1)
    timed = tisim.Poke(
        material=replace(MATERIAL, viscosity=PRONY),
        course=course,
        block=BLOCK,
        rod=rod,
        refinement=REFINEMENT,
        mesh=elastic.mesh,
    )
    (simulated,) = tisim.simulate([timed], workers=1)
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


def _prony(entry: Mapping[str, Any]) -> Prony:
    """Relaxation of a stored force."""
    stored = entry["push"]["prony"]
    return Prony(fractions=tuple(stored["fractions"]), times=tuple(stored["times"]))


def stored() -> None:
    """Prints what the stored forces of another code say."""
    store = load()
    step = store["thick, hold"]
    time, force = np.array(step["time"]), np.array(step["force"])
    prony = _prony(step)
    at_once = float(step["push"]["course"]["pieces"][0]["duration"])
    deepest = float(step["push"]["course"]["pieces"][0]["to"])
    hold = time >= at_once
    relaxing = _modulus(prony, time[hold] - at_once)
    ratio = force[hold] / force[hold][0] / (relaxing / relaxing[0])
    print(f"Hold after a step: force over modulus is constant to {100 * np.abs(ratio - 1.0).max():.2f} %.\n")
    loading = time <= at_once * (1.0 + 1e-9)
    curve = PchipInterpolator(
        deepest * time[loading] / at_once, (force[loading] / (1.0 + sum(prony.fractions))) ** (1.0 / FLAT)
    )
    print("| seed | ratio of forces at the end of the ramp | hold | retraction |\n| --- | --- | --- | --- |")
    for name in (n for n in store if n.startswith("seed") and n.endswith("thick")):
        entry = store[name]
        pieces = entry["push"]["course"]["pieces"]
        corners = np.concatenate([[0.0], np.cumsum([p["duration"] for p in pieces])])
        depths = np.concatenate([[0.0], [p["to"] for p in pieces]])
        time, force = np.array(entry["time"]), np.array(entry["force"])
        own = _prony(entry)
        fine = np.unique(np.concatenate([np.linspace(0.0, corners[-1], 2001), time]))
        met = thresholds(float(depths.max()))
        springs = stiffnesses(met, np.asarray(curve(met)) ** FLAT)
        found = loads(own.spectrum(), fine, np.interp(fine, corners, depths), met[:-1]) @ springs
        found = np.interp(time, fine, found)
        turn = int(np.argmax(force))
        ratio = found[turn] / force[turn]
        error = 100.0 * (found / ratio - force) / force[turn]
        cells = []
        for low, high in pairwise(corners[1:]):
            phase = error[(time > low * (1.0 + 1e-9)) & (time <= high * (1.0 + 1e-9))]
            cells.append(f"{phase.min():+.2f} to {phase.max():+.2f} %")
        print(f"| {name.split(',')[0].removeprefix('seed ')} | {ratio:.4f} | " + " | ".join(cells) + " |")
    print()


def _modulus(prony: Prony, time: Array) -> Array:
    """Over the long-time one."""
    terms = zip(prony.fractions, prony.times, strict=True)
    return np.asarray(1.0 + sum(g * np.exp(-time / tau) for g, tau in terms))


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--stored", action="store_true", help="against the stored forces alone")
    given = parser.parse_args(argv)
    stored()
    if given.stored:
        return 0
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
