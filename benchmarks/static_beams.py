"""Static beams at equal error against CalculiX and FElupe; prints tables of ratios and the goals.

    python -m benchmarks.static_beams                # all of it: 3 to 4 min
    python -m benchmarks.static_beams --no-peers     # ours alone: 20 s

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1. Needs `ccx` and the extra `bench`.

Circular beams of 10 mm radius under gravity, K = 100 G. Seconds are CPU seconds of one core, from mesh to
equilibrium: ours and FElupe without imports, CalculiX with reading and writing its files. Ours: median of
--repeats; peers: one run where it takes over 5 s, else the median of 3. Error: vertical deflection against
references/beams.json, in % of the reference's displacement; minus is too stiff, nan did not converge.
Ours takes the half beam where the loads are planar, by itself; CalculiX C3D10 gets the half beam too (on the
whole one, of 4,445 nodes, it did not converge), C3D4 and FElupe the whole one.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import tisim
from benchmarks.accuracy_beams import FILE, material
from tisim.mesh import PAPER_LAYER, PAPER_RINGS, beam_mesh
from tisim.problems.beam.system import _own_discretisation, _structured_discretisation

Array = np.ndarray[Any, Any]
TABLE = {(e["case"], e["set"], e["G"]): e for e in json.loads(FILE.read_text())["beams"]}
LAWS = {"Neo-Hookean": "neo_hookean-100", "Ogden": "ogden-4", "Ogden, 3 terms": "ogden-3term"}
CASES = ("cantilever-50", "cantilever-100", "bridge-150")
ALONE = ("cantilever-100", 40e3)
# with the four moduli of the reference table among them
MODULI = np.sort(np.append(np.geomspace(9e3, 100e3, 14).round(6), [20e3, 40e3]))
QUADRATIC = (3, 0.006)  # rings and layer of the peers' 10-node meshes
SECTION = tisim.Circle(radius=0.010)


@dataclass(frozen=True)
class Timed:
    """One line of a table: seconds of a core, error of dz [%], nodes."""

    seconds: float
    error: float
    nodes: int


def beam(case: str, law: str, modulus: float, **other: Any) -> tisim.Beam:
    """Our scene of a line of the reference table, or of the like with another modulus."""
    kind, length = case.split("-")
    like = next(e for (c, s, _), e in TABLE.items() if (c, s) == (case, LAWS[law]))
    scale = modulus / like["G"]
    parameters = {
        k: v if k == "alpha" else (np.asarray(v) * scale).tolist() for k, v in like["parameters"].items()
    }
    supports: Any = "clamped-clamped" if kind == "bridge" else "clamped-free"
    return tisim.Beam(
        material=material({**like, "parameters": parameters}),
        length=float(length) / 1e3,
        supports=supports,
        **other,
    )


def error(case: str, law: str, modulus: float, rest: Array, displacement: Array) -> float:
    """Error of dz in % of the reference's displacement; nan where the table has no such beam."""
    entry = TABLE.get((case, LAWS[law], float(modulus)))
    if entry is None:
        return float("nan")
    length = float(case.split("-")[1]) / 1e3
    place = np.linalg.norm(rest - [length / (2 if case[0] == "b" else 1), 0, 0], axis=1).argmin()
    return float(100 * (entry["dz"] - displacement[place, 2]) / np.hypot(entry["dx"], entry["dz"]))


def our_error(case: str, law: str, modulus: float, result: tisim.Result) -> float:
    """Error of a result of tisim, as `error`; infinite for an unsolved beam."""
    if not result.ok:
        return float("inf")
    rest = result.mesh.nodes
    return error(case, law, modulus, rest, result.positions[-1] - rest)


def ours(scene: tisim.Beam, law: str, repeats: int, *, warm: bool) -> Timed:
    """One beam in this process, kernels loaded; warm: its mesh has been solved before."""
    case, modulus = ALONE
    seconds = []
    result = tisim.simulate([scene], workers=1)[0]
    for _ in range(repeats):
        if not warm:
            _structured_discretisation.cache_clear()
            _own_discretisation.cache_clear()
        start = time.process_time()
        result = tisim.simulate([scene], workers=1)[0]
        seconds.append(time.process_time() - start)
    return Timed(statistics.median(seconds), our_error(case, law, modulus, result), result.mesh.n_nodes)


def fresh(law: str) -> dict[str, float]:
    """One beam in this new process: CPU seconds of imports, of the first solve, of the beam in it."""
    imports = time.process_time()
    scene = beam(ALONE[0], law, ALONE[1])
    start = time.process_time()
    cost = tisim.simulate([scene], workers=1)[0].cost
    return {"imports": imports, "solve": time.process_time() - start, "mesh": cost.mesh_seconds}


def fresh_process(law: str, repeats: int) -> dict[str, float]:
    """Medians of `fresh` in processes of their own, one before them to fill Taichi's offline cache."""
    found = []
    for _ in range(repeats + 1):
        out = subprocess.run(
            [sys.executable, "-m", "benchmarks.static_beams", "--fresh", law],
            capture_output=True,
            text=True,
            check=True,
        )
        found.append(json.loads(out.stdout.splitlines()[-1]))
    return {k: statistics.median(f[k] for f in found[1:]) for k in found[0]}


@dataclass(frozen=True)
class Batch:
    """A batch of 48: core-seconds a beam (solve; mesh and sparsity), wall of all of it, worst error [%]."""

    solve: float
    mesh: float
    process: float
    wall: float
    error: float
    nodes: str


def batch(law: str, repeats: int) -> Batch:
    """16 moduli x 3 lengths: on one core with nothing kept, and the wall time with all cores."""
    places = [(case, float(g)) for case in CASES for g in MODULI]
    scenes = [beam(case, law, g) for case, g in places]
    tisim.simulate(scenes, workers=os.cpu_count())  # starts the workers, loads the kernels
    tisim.simulate(scenes[:1], workers=1)
    solve, mesh, process, wall = [], [], [], []
    results: list[tisim.Result] = []
    for _ in range(repeats):
        _structured_discretisation.cache_clear()
        start = time.process_time()
        results = tisim.simulate(scenes, workers=1)
        process.append((time.process_time() - start) / len(scenes))
        solve.append(sum(r.cost.core_seconds for r in results) / len(scenes))
        mesh.append(sum(r.cost.mesh_seconds for r in results) / len(scenes))
        begin = time.perf_counter()
        tisim.simulate(scenes, workers=os.cpu_count())
        wall.append(time.perf_counter() - begin)
    if not all(r.ok for r in results):
        raise RuntimeError("beams of the batch did not converge")
    errors = [our_error(c, law, g, r) for (c, g), r in zip(places, results, strict=True)]
    known = [e for e in errors if not np.isnan(e)]
    sizes = [r.mesh.n_nodes for r in results]
    middle = statistics.median
    return Batch(
        middle(solve), middle(mesh), middle(process), middle(wall), max(known, key=abs),
        f"{min(sizes)}-{max(sizes)}",
    )  # fmt: skip


def peer(run: Callable[[], Any], law: str, points: Array) -> Timed:
    """One run of a peer, two more if it is quick; its error is nan where it did not converge."""
    found = [run()]
    if found[0].cpu_seconds < 5:
        found += [run(), run()]
    err = error(*ALONE[:1], law, ALONE[1], points, found[0].displacement)
    return Timed(
        statistics.median(f.cpu_seconds for f in found),
        err if found[0].converged else float("nan"),
        len(points),
    )


def calculix_run(law: str, mesh: tisim.Mesh) -> Callable[[], Any]:
    """CalculiX on this mesh."""
    from benchmarks.peers import calculix

    entry = TABLE[ALONE[0], LAWS[law], ALONE[1]]
    p = {k: v for k, v in entry["parameters"].items() if k not in ("K", "lambda")}
    card = calculix.hyperelastic(entry["law"], entry["parameters"]["K"], **p)
    held = calculix.fixed(mesh.node_sets["clamp"])
    if mesh.symmetry:
        held |= {(int(n), 1): 0.0 for n in mesh.node_sets["mirror_y"]}
    return lambda: calculix.solve(mesh.nodes, mesh.elements, card, held)


def felupe_run(law: str, mesh: tisim.Mesh) -> Callable[[], Any]:
    """FElupe on this mesh."""
    from benchmarks.peers import felupe_beam

    entry = TABLE[ALONE[0], LAWS[law], ALONE[1]]
    p = {k: v for k, v in entry["parameters"].items() if k not in ("K", "lambda")}
    umat = felupe_beam.material(entry["law"], entry["parameters"]["K"], **p)
    return lambda: felupe_beam.solve(mesh.nodes, mesh.elements, umat, mesh.node_sets["clamp"])


def line(name: str, nodes: object, err: float, seconds: float, *ratios: float) -> None:
    """Print one line of a table."""
    tail = "".join(f"{r:11.1f}" for r in ratios)
    print(f"{name:47s} {nodes!s:>9s} {err:+8.2f} {seconds:9.3f}{tail}", flush=True)


def goal(name: str, value: float, limit: float, *, least: bool = False) -> None:
    """Print whether a goal is met."""
    met = value >= limit if least else value <= limit
    sign = ">=" if least else "<="
    print(f"{name:60s} {value:7.3f} {sign} {limit:5.2f}  {'met' if met else 'MISSED'}", flush=True)


def main() -> None:
    """Print the tables and the goals."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--no-peers", action="store_true")
    parser.add_argument("--fresh", choices=list(LAWS), help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.fresh:
        print(json.dumps(fresh(args.fresh)))
        return
    length = 0.1
    paper = beam_mesh(
        length=length,
        section=SECTION,
        kind="tet4",
        radial_elements=PAPER_RINGS,
        axial_element_size=PAPER_LAYER,
    )
    head = f"{'':47s} {'nodes':>9s} {'error %':>8s} {'core s':>9s}"

    print("1. a batch of 48 beams: 16 shear moduli (9 to 100 kPa) x 50, 100 mm cantilever, 150 mm bridge")
    print(f"{head}     solve      mesh  wall of all   (core s, a beam; error: the worst of the batch)")
    batches = {}
    for law in LAWS:
        b = batches[law] = batch(law, args.repeats)
        print(f"{'ours, ' + law:47s} {b.nodes:>9s} {b.error:+8.2f} {b.process:9.4f} {b.solve:9.4f}"
              f" {b.mesh:9.4f} {b.wall:9.2f} s", flush=True)  # fmt: skip

    print(f"\n2. one beam, {ALONE[0]} mm, G = {ALONE[1] / 1e3:g} kPa; the last two columns: times ours, new"
          " mesh; times ours, in a batch\n" + head)  # fmt: skip
    alone, first, same_mesh = {}, {}, {}
    for law in ("Neo-Hookean", "Ogden"):
        first[law] = fresh_process(law, 3)
        scene = beam(*ALONE[:1], law, ALONE[1])
        new, again = (ours(scene, law, args.repeats, warm=w) for w in (False, True))
        alone[law] = new
        base, b = new.seconds, batches[law].process
        solve = first[law]["solve"]
        line(
            f"ours, {law}: new process, its first solve", new.nodes, new.error, solve, solve / base, solve / b
        )
        line(f"ours, {law}: new mesh", new.nodes, new.error, base, 1.0, base / b)
        line(f"ours, {law}: same mesh again", new.nodes, again.error, again.seconds, again.seconds / base,
             again.seconds / b)  # fmt: skip
        if args.no_peers:
            continue
        rings, layer = QUADRATIC
        size: dict[str, Any] = {
            "length": length,
            "section": SECTION,
            "radial_elements": rings,
            "axial_element_size": layer,
        }
        whole, half = beam_mesh(**size), beam_mesh(**size, mirror=True)
        runs = [
            ("CalculiX C3D4, the paper's fineness", calculix_run(law, paper), paper),
            ("CalculiX C3D10, half beam", calculix_run(law, half), half),
            ("FElupe 10-node", felupe_run(law, whole), whole),
        ]
        for name, run, mesh in runs:
            t = peer(run, law, mesh.nodes)
            if mesh is paper:
                same_mesh[law] = t
            line(f"{name}, {law}", t.nodes, t.error, t.seconds, t.seconds / base, t.seconds / b)
    print("imports of a new process take {:.2f} core s besides".format(first["Neo-Hookean"]["imports"]))

    same = {}
    if not args.no_peers:
        print(
            f"\n3. the very same mesh of 4-node tetrahedra (whole beam); the last column: times ours\n{head}"
        )
        for law in ("Neo-Hookean", "Ogden"):
            mine = ours(beam(*ALONE[:1], law, ALONE[1], element="tet4", mesh=paper), law, 3, warm=False)
            theirs = same_mesh[law]
            same[law] = theirs.seconds / mine.seconds
            line(f"ours, tet4, {law}: new mesh", mine.nodes, mine.error, mine.seconds, 1.0)
            line(f"CalculiX C3D4, {law}", theirs.nodes, theirs.error, theirs.seconds, same[law])

    print("\ngoals")
    goal("a beam of the batch, Neo-Hookean [core s]", batches["Neo-Hookean"].process, 0.04)
    goal("a beam of the batch, Ogden [core s]", batches["Ogden"].process, 0.04)
    goal("one beam alone, new mesh, Neo-Hookean [core s]", alone["Neo-Hookean"].seconds, 0.2)
    goal("the same, first solve of a new process [core s]", first["Neo-Hookean"]["solve"], 0.2)
    goal("worst error of the batch [%]", max(abs(b.error) for b in batches.values()), 1.0)
    for law in ("Ogden", "Ogden, 3 terms"):
        goal(f"{law}, times Neo-Hookean", batches[law].process / batches["Neo-Hookean"].process, 1.5)
    for law, ratio in same.items():
        goal(f"same 4-node mesh, CalculiX over ours, {law}", ratio, 5.0, least=True)


if __name__ == "__main__":
    main()
