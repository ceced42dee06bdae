"""What time in the material costs: a viscous poke and viscous beams against elastic ones; prints a table.

    python -m benchmarks.viscous                 # both: about a minute
    python -m benchmarks.viscous --only beams

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1. CPU seconds of one core, kernels loaded
before; the ratios are of one run.

Poke: rod of 2.5 mm on the default block, a ramp to 10 mm at 2 mm/s, a hold of 10 s, a ramp back to 5 mm;
neo-Hookean, mu = 30 kPa, K = 600 kPa, with a Prony series of two terms (0.3 at 0.5 s, 0.2 at 5 s) or without,
the same frames kept (steps between are the same but in the hold, where an elastic block has nothing to do).
Goal: 1.6 times.
Beams: 16 materials of mu = 24 to 39 kPa, K/mu = 200, by three lengths, 50, 100 and 150 mm, hung at time 0 and
kept at 1, 10 and 60 s (0.3 at 1 s, 0.2 at 20 s), against the same beams in static equilibrium. Goal: 3 times.
Memory: what points remember, as arrays.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

import tisim

ELASTIC = tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3)
VISCOUS = replace(ELASTIC, viscosity=tisim.Prony(fractions=(0.3, 0.2), times=(0.5, 5.0)))
HANGING = tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
LENGTHS = (0.05, 0.10, 0.15)
FRAMES = (1.0, 10.0, 60.0)


def seconds(scenes: list[tisim.Scene]) -> tuple[float, list[tisim.Result]]:
    """CPU seconds of scenes in this process, and their results."""
    start = time.process_time()
    results = tisim.simulate(scenes, workers=1)
    return time.process_time() - start, results


def pokes(depth: float = 10e-3, refinement: float = 1.0) -> tuple[float, float, list[tisim.Result]]:
    """CPU seconds of the elastic and of the viscous poke, and both results."""
    course = tisim.Course().ramp(to=depth, speed=2e-3).hold(10.0).ramp(to=0.5 * depth, speed=2e-3)
    warm = tisim.Course().ramp(to=2e-4, speed=2e-3)
    seconds([tisim.Poke(material=m, course=warm, refinement=0.5) for m in (ELASTIC, VISCOUS)])
    found = [
        seconds([tisim.Poke(material=material, course=course, refinement=refinement)])
        for material in (ELASTIC, VISCOUS)
    ]
    return found[0][0], found[1][0], [result for _, (result,) in found]


def beams(
    materials: int = 16, lengths: tuple[float, ...] = LENGTHS
) -> tuple[float, float, list[tisim.Result]]:
    """CPU seconds of the static and of the viscous batch, and the viscous results."""
    hang = tisim.Course(frames=FRAMES).jump(1.0).hold(FRAMES[-1])

    def batch(count: int, *, viscous: bool) -> list[tisim.Scene]:
        scenes: list[tisim.Scene] = []
        for length in lengths:
            for size in np.linspace(0.8, 1.3, count):
                mu = 30e3 * float(size)
                material = tisim.material_from_moduli(
                    "neo-hookean", shear_modulus=mu, bulk_modulus=200.0 * mu
                )
                if viscous:
                    material = replace(material, viscosity=HANGING)
                scenes.append(tisim.Beam(material=material, length=length, course=hang if viscous else None))
        return scenes

    for viscous in (False, True):
        seconds(batch(1, viscous=viscous))
    static, _ = seconds(batch(materials, viscous=False))
    creeping, results = seconds(batch(materials, viscous=True))
    return static, creeping, results


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=("pokes", "beams"))
    parser.add_argument("--depth", type=float, default=10.0, help="of the poke [mm]")
    parser.add_argument("--refinement", type=float, default=1.0)
    parser.add_argument("--materials", type=int, default=16)
    parser.add_argument("--lengths", type=float, nargs="+", default=[1e3 * v for v in LENGTHS], help="[mm]")
    options = parser.parse_args()
    if options.only != "beams":
        plain, viscous, (elastic, found) = pokes(options.depth * 1e-3, options.refinement)
        print(f"poke without  {plain:7.2f} s  {elastic.status}, {_work(elastic)}")
        print(f"poke viscous  {viscous:7.2f} s  {found.status}, {_work(found)}")
        print(f"ratio         {viscous / plain:7.2f}    (goal 1.6)")
        points = found.mesh.n_elements * 11
        # H, S, C, stresses and energies of two terms, two energies lost
        print(f"memory        {points * 8 * (6 + 6 + 6 + 2 * 7 + 2) / 1e6:7.1f} MB of {points} points")
    if options.only != "pokes":
        static, creeping, results = beams(options.materials, tuple(1e-3 * v for v in options.lengths))
        good = sum(result.ok for result in results)
        steps = sum(result.cost.steps for result in results) / len(results)
        tangents = sum(result.cost.factorisations for result in results) / len(results)
        print(f"beams static  {static:7.2f} s")
        print(
            f"beams viscous {creeping:7.2f} s  {good} of {len(results)},"
            f" {steps:.1f} steps, {tangents:.1f} factors"
        )
        print(f"ratio         {creeping / static:7.2f}    (goal 3)")


def _work(result: tisim.Result) -> str:
    cost = result.cost
    tangents = f"{cost.newton_iterations} iterations, {cost.factorisations} factors"
    return f"{cost.steps} steps, {tangents}, {cost.step_cuts} cuts"


if __name__ == "__main__":
    main()
