"""What a poke costs, where the time goes, and how good its force is; prints a table.

    python -m benchmarks.pokes                       # to 10 mm at 0 and 45 degrees, 3,500 nodes: 1 to 2 min
    python -m benchmarks.pokes --fine                # refinement 1.5, 11,300 nodes, as well
    python -m benchmarks.pokes --deep --repeats 1    # to 20 mm as well

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Neo-Hookean, mu = 30 kPa, K = 600 kPa, friction 0.6, flat rod of 2.5 mm radius with an edge of 1 mm, pushed
into the middle of the default block. CPU seconds of one core, mesh and layout included, kernels loaded
before; the median of --repeats on the default mesh, one run on the fine one and to 20 mm. Parts: one more
run under cProfile (its own cost is 1 to 3 %), in % of it.
    assembly   tangent of the elements                  factor     PARDISO's numerical factorisation
    solves     forward and back substitution            Krylov     products, orthogonalisation
    search     energies and residuals of the line search
Force: along the rod's axis. The reference (references/poke.json, 0 degrees only, no deeper than 10 mm) is a
disc of 50 mm radius of the same height, where ours is a block of 100 x 100 mm. --sides asks what that is
worth: it pokes smaller blocks (89 mm: the disc's area; 71 mm: the square inside it) to 5 mm.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import math
import pstats
import statistics
import time
from pathlib import Path

import numpy as np

import tisim
from tisim.problems.indentation.solve import solve_poke

FILE = Path(__file__).parent / "references" / "poke.json"
GOALS = {10: 3.0, 20: 10.0}  # depth [mm]: core seconds
FORCE_GOAL = 3.0  # % at 5 mm
# part: file and function, by cumulative time; none calls another, but for "Krylov", which calls "solves"
PARTS = {
    "assembly": ("discretisation/body.py", "stiffness"),
    "factor": ("linear/pardiso.py", "factorise"),
    "solves": ("linear/pardiso.py", "solve"),
    "Krylov": ("linear/krylov.py", "_gmres"),
    "search": ("discretisation/body.py", "forces_and_energy"),
}


def poke(angle: float, depth: float, refinement: float, side: float = 0.100) -> tisim.Poke:
    """The scene; angle from the normal [degrees], depth and side of the block [m]."""
    tilt = math.radians(angle)
    return tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        block=tisim.Block(size=(side, side, 0.032)),
        direction=(math.sin(tilt), 0.0, -math.cos(tilt)),
        depth=depth,
        refinement=refinement,
    )


def force_at(result: tisim.Result, depth: float) -> float:
    """Force along the rod [N] of the frame at this depth; nan where it was not reached."""
    at = np.flatnonzero(np.abs(result.load - depth) < 1e-6)
    if not len(at):
        return float("nan")
    scene = result.scene
    assert isinstance(scene, tisim.Poke)
    axis = np.asarray(scene.direction) / np.linalg.norm(scene.direction)
    return float(abs(result.rod_force[at[0]] @ axis))


def timed(scene: tisim.Poke, repeats: int) -> tuple[float, tisim.Result]:
    """Median of the CPU seconds, mesh included."""
    seconds = []
    for _ in range(repeats):
        start = time.process_time()
        result = solve_poke(scene)
        seconds.append(time.process_time() - start)
    return statistics.median(seconds), result


def parts(scene: tisim.Poke) -> dict[str, float]:
    """Share of each part in % of the whole."""
    profile = cProfile.Profile(time.process_time)
    start = time.process_time()
    profile.runcall(solve_poke, scene)
    whole = time.process_time() - start
    stats: dict[tuple[str, int, str], tuple[float, ...]] = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    found = dict.fromkeys(PARTS, 0.0)
    for (file, _, name), values in stats.items():
        for part, (where, function) in PARTS.items():
            if name == function and file.endswith(where):
                found[part] += 100 * values[3] / whole
    found["Krylov"] -= found["solves"]
    return found


def sides() -> None:
    """Force at 5 mm on blocks of other sides."""
    for side in (0.100, 0.0886, 0.0707):
        _, result = timed(poke(0.0, 0.005, 1.0, side), 1)
        print(f"block of {side * 1e3:5.1f} mm: {result.mesh.n_nodes} nodes, {force_at(result, 0.005):.4f} N")


def main() -> None:
    """Print the table and the goals."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--fine", action="store_true", help="also refinement 1.5")
    parser.add_argument("--deep", action="store_true", help="also to 20 mm")
    parser.add_argument("--angles", type=float, nargs="+", default=[0.0, 45.0])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--no-profile", action="store_true")
    parser.add_argument("--sides", action="store_true", help="only the force at 5 mm on smaller blocks")
    args = parser.parse_args()
    solve_poke(poke(0.0, 0.0005, 1.0))  # loads the kernels
    if args.sides:
        sides()
        return
    reference = json.loads(FILE.read_text())["values"]["0.6"]
    print(
        f"{'':20s} {'nodes':>6s} {'core s':>7s} {'Newton':>6s} {'fact.':>5s} {'solves':>6s}"
        + "".join(f"{p:>9s}" for p in (*PARTS, "rest"))
        + f" {'5 mm N':>8s} {'error':>7s} {'10 mm N':>8s} {'error':>7s} {'20 mm N':>8s}  reached"
    )
    goals = []
    for refinement in (1.0, 1.5) if args.fine else (1.0,):
        for depth in (10, 20) if args.deep else (10,):
            for angle in args.angles:
                scene = poke(angle, depth * 1e-3, refinement)
                cheap = refinement == 1.0 and depth == 10
                seconds, r = timed(scene, args.repeats if cheap else 1)
                shares = {} if args.no_profile else parts(scene)
                shares |= {"rest": 100 - sum(shares.values())} if shares else {}
                forces = []
                for d in (5, 10):
                    f = force_at(r, d * 1e-3)
                    known = angle == 0.0
                    err = 100 * (f / reference[str(d)]["force"] - 1) if known else float("nan")
                    forces.append(f" {f:8.3f} " + (f"{err:+6.2f}%" if known else f"{'-':>7s}"))
                    if known and d == 5 and depth == 10:
                        goals.append((f"force at 5 mm, {r.mesh.n_nodes} nodes [% off]", abs(err), FORCE_GOAL))
                reached = 1e3 * float(r.load[-1]) if len(r.load) else 0.0
                print(
                    f"{angle:3.0f} deg to {depth} mm    {r.mesh.n_nodes:8d} {seconds:7.2f}"
                    f" {r.cost.newton_iterations:6d} {r.cost.factorisations:5d} {r.cost.linear_iterations:6d}"
                    + "".join(f"{shares.get(p, float('nan')):8.0f}%" for p in (*PARTS, "rest"))
                    + "".join(forces)
                    + f" {force_at(r, 0.020):8.3f}  {reached:.1f} mm, {r.status.value}",
                    flush=True,
                )
                name = f"{angle:g} degrees to {depth} mm, {r.mesh.n_nodes} nodes [core s]"
                goals.append((name, seconds if r.ok else float("inf"), GOALS[depth]))
    print()
    for name, value, limit in goals:
        print(f"{name:50s} {value:7.2f} <= {limit:5.1f}  {'met' if value <= limit else 'MISSED'}")


if __name__ == "__main__":
    main()
