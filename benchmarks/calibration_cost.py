"""What a candidate and a calibration cost, by law, beside CalculiX at equal error.

    python -m calibration.fit EXPERIMENT --model all --out FITS
    python -m benchmarks.calibration_cost EXPERIMENT FITS [--no-peers]

EXPERIMENT: beams of 50 and 100 mm and a 150 mm bridge, as in datasets/measured/bench/clean. Set
OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1; CalculiX (`ccx`) is the peer. A candidate: all
beams of one material solved with one set of parameters, and their likelihood. Core seconds, kernels loaded,
median of 5 populations of 8. The seconds of a calibration are those that calibration.fit wrote. CalculiX: the
same three beams, 10-node tetrahedra on the half beam (as in static_beams.py), G = 40 kPa, K = 100 G, one run
each.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from pathlib import Path

import numpy as np

import tisim
from benchmarks.static_beams import CASES, LAWS, QUADRATIC, SECTION, TABLE, beam, error, our_error
from calibration.experiment import read
from calibration.inference import Problem
from calibration.measurements.outlines import COARSE
from calibration.parameters import parametrisation
from calibration.study import measurements
from tisim.mesh import beam_mesh

MODULUS = 40e3


def candidate(experiment: Path, material: str, law: str, repeats: int = 5) -> float:
    """Core seconds of one candidate."""
    p = parametrisation(law)
    data = measurements(read(experiment), material, p, workers=1)
    problem = Problem(parametrisation=p, objectives=data.objectives)
    start = p.start(shear=MODULUS)
    if not problem.linearise(start, rough=True):
        return float("nan")
    rng = np.random.default_rng(0)
    seconds = []
    for _ in range(repeats):
        population = start + 0.1 * p.spread * rng.standard_normal((8, len(start)))
        begin = time.process_time()
        problem.costs(population)
        seconds.append((time.process_time() - begin) / 8)
    return statistics.median(seconds)


def our_worst_error() -> float:
    """Worst error of the search's beams [%], over the three cases."""
    scenes = [
        beam(c, "Neo-Hookean", MODULUS, rings=COARSE.radial_elements, layer=COARSE.axial_element_size)
        for c in CASES
    ]
    results = tisim.simulate(scenes, workers=1)
    errors = [our_error(c, "Neo-Hookean", MODULUS, r) for c, r in zip(CASES, results, strict=True)]
    return max(errors, key=abs)


def calculix_three() -> tuple[float, float]:
    """Core seconds of the three beams and their worst error [%]."""
    from benchmarks.peers import calculix

    rings, layer = QUADRATIC
    seconds, errors = 0.0, []
    for case in CASES:
        kind, length = case.split("-")
        bridge = kind == "bridge"
        mesh = beam_mesh(
            length=float(length) / 1e3,
            section=SECTION,
            radial_elements=rings,
            axial_element_size=layer,
            mirror=True,
            supports="clamped-clamped" if bridge else "clamped-free",
        )
        entry = TABLE[case, LAWS["Neo-Hookean"], MODULUS]
        p = {k: v for k, v in entry["parameters"].items() if k not in ("K", "lambda")}
        card = calculix.hyperelastic(entry["law"], entry["parameters"]["K"], **p)
        clamps = [mesh.node_sets[s] for s in ("clamp", "far_clamp") if s in mesh.node_sets]
        held = calculix.fixed(np.unique(np.concatenate(clamps)))
        held |= {(int(n), 1): 0.0 for n in mesh.node_sets["mirror_y"]}
        found = calculix.solve(mesh.nodes, mesh.elements, card, held)
        seconds += found.cpu_seconds
        errors.append(error(case, "Neo-Hookean", MODULUS, mesh.nodes, found.displacement))
    return seconds, max(errors, key=abs)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("experiment", type=Path)
    parser.add_argument("fits", type=Path)
    parser.add_argument("--no-peers", action="store_true")
    args = parser.parse_args()
    fits = [json.loads(f.read_text())["calibration"] for f in sorted((args.fits / "fits").glob("*.json"))]
    material = fits[0]["material"]
    print(f"worst error of the search's beams, before correction: {our_worst_error():+.2f} %")
    peer = float("nan")
    if not args.no_peers:
        peer, worst = calculix_three()
        print(f"CalculiX, the same three beams: {peer:.1f} core s, worst error {worst:+.2f} %")
    print(
        f"{'law':22s} {'candidate':>10s} {'CalculiX over it':>17s} {'candidates':>11s} {'calibration':>12s}"
    )
    total = 0.0
    for law in tisim.laws.names():
        mine = [f for f in fits if f["law"] == law]
        one = candidate(args.experiment, material, law)
        core = [f["search_seconds"] + f["polish_seconds"] for f in mine]
        total += sum(core)
        counts = "/".join(str(f["candidates"]) for f in mine)
        whole = "/".join(f"{s:.0f}" for s in core)
        print(f"{law:22s} {one:10.3f} {peer / one:17.0f} {counts:>11s} {whole:>12s}", flush=True)
    print(f"all {len(fits)} calibrations: {total:.0f} core s")


if __name__ == "__main__":
    main()
