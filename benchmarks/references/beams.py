"""Reference deflections of soft cylinders under gravity, by FElupe; writes beams.json beside this file.

    python -m benchmarks.references.beams --levels 1 2      # 4.5 minutes of one core
    python -m benchmarks.references.beams --levels 3 --laws neo_hookean-20 neo_hookean-1000   # 9.5 more, adds

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Cylinder along x, radius 10 mm, gravity 9.81 m/s2 along -z, density 1000 kg/m3. Cantilevers of 50 and 100 mm:
all nodes of the face x = 0 fixed, displacement of the centre of the face x = L. Bridge of 150 mm: both end
faces fixed, displacement of the centreline at mid-span.

Discretisation: half model (mirror plane y = 0; the bridge also at mid-span), 27-node hexahedra with
discontinuous linear pressure and volume ratio (Q2/P-1, inf-sup stable, no locking), O-grid section of
exact area, layers graded towards the clamp, rings graded towards the surface. Level m cuts every element
of level 1 into m x m x m. The three fields are FElupe's `NearlyIncompressible`; pressure and volume ratio
are condensed exactly, element by element, before PARDISO. Laws: see laws.py.

At given ratios of the moduli all depends on rho g / G alone: one path of rising load passes through all G.

Value: Richardson over the levels, u(m) = u + c / m^p, p from three levels (taken from the like beam that has
them, else 1.3, the rate of the stress singularity at the clamped edge). Error: |value - finest level|, as a
part of |dz|: the distance extrapolated over, so a bound rather than a guess where the order holds.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.cylinder import half_cylinder
from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.whole import write_whole

RADIUS, DENSITY, GRAVITY = 0.010, 1000.0, 9.81
FILE = Path(__file__).with_suffix(".json")
# name: modelled length [m], layers and grading at level 1
SPANS = {"cantilever-50": (0.050, 6, 2.5), "cantilever-100": (0.100, 10, 2.5), "bridge-150": (0.075, 8, 2.5)}
# name: law, parameters over G, K / G, moduli G [Pa]
LAWS: dict[str, tuple[str, dict[str, Any], float, tuple[float, ...]]] = {
    **{
        f"neo_hookean-{ratio}": ("neo_hookean", {"mu": 1.0}, float(ratio), (100e3, 40e3, 20e3, 9e3))
        for ratio in (20, 100, 1000)
    },
    "ogden-4": ("ogden", {"mu": (0.5,), "alpha": (4.0,)}, 100.0, (40e3, 20e3, 9e3)),
    "ogden-3term": ("ogden", {"mu": (0.8, 0.05, -0.2), "alpha": (1.5, 6.0, -2.5)}, 100.0, (40e3, 20e3, 9e3)),
    "mooney_rivlin": ("mooney_rivlin", {"C10": 0.3, "C01": 0.2}, 100.0, (40e3, 20e3, 9e3)),
}


def scaled(parameters: dict[str, Any], modulus: float) -> dict[str, Any]:
    """Parameters in Pa; exponents stay."""
    return {
        name: value if name == "alpha" else (np.multiply(value, modulus)).tolist()
        for name, value in parameters.items()
    }


def solve(span: str, law: str, level: int) -> Iterator[tuple[float, float, float]]:
    """(G, dx, dz) for every modulus of the law; prints as it goes."""
    length, layers, strength = SPANS[span]
    kind, parameters, ratio, moduli = LAWS[law]
    mesh = half_cylinder(RADIUS, length, layers, strength, level)
    region = fe.RegionTriQuadraticHexahedron(mesh)
    field = mixed_fields(region)
    dof = np.arange(3 * mesh.npoints).reshape(-1, 3)
    fixed = [dof[mesh.points[:, 0] < 1e-9].ravel(), dof[mesh.points[:, 1] < 1e-9, 1]]
    if span.startswith("bridge"):
        fixed.append(dof[mesh.points[:, 0] > length - 1e-9, 0])
    share = np.einsum("aqc,qc->ca", np.broadcast_to(region.h, (27, *region.dV.shape)), region.dV)
    weight = np.zeros((mesh.npoints, 3))
    np.add.at(weight[:, 2], mesh.cells.ravel(), -share.ravel() * DENSITY * GRAVITY)
    stiff = moduli[0]
    material = mixed_law(kind, ratio * stiff, **scaled(parameters, stiff))
    model = MixedModel(field, material, np.unique(np.concatenate(fixed)), lambda t: weight.ravel() * t)
    centre = int(np.argmin(np.linalg.norm(mesh.points - [length, 0, 0], axis=1)))
    out: list[tuple[float, float, float]] = []

    def report(factor: float) -> None:
        dx, _, dz = field[0].values[centre]
        out.append((stiff / factor, float(dx), float(dz)))
        what = f"{span} {law} level {level} G {stiff / factor / 1e3:.0f} kPa"
        how = f"{model.solves} solves, {mesh.points.size} dofs, {clock():.0f} s"
        print(f"{what}: dx {dx * 1e3:.4f} dz {dz * 1e3:.4f} mm, {how}", flush=True)

    if not model.path(0.0, [stiff / g for g in moduli], report, 1.0):
        print(f"{span} {law} level {level}: no equilibrium beyond the values above", flush=True)
    yield from out


def order(values: list[float]) -> float | None:
    """Observed order p of u(m) = u + c / m^p from levels 1, 2, 3; None where they are not monotone."""
    first, second = values[0] - values[1], values[1] - values[2]
    if second == 0 or first / second <= 0:
        return None
    grid = np.linspace(0.5, 6, 1101)
    ratio = (1 - 2.0**-grid) / (2.0**-grid - 3.0**-grid)
    return float(np.interp(first / second, ratio, grid)) if ratio[0] < first / second else None


def extrapolate(levels: dict[str, list[float]], key: int, p: float) -> float:
    """Richardson value from the two finest levels; component key (0 dx, 1 dz)."""
    fine = sorted(int(m) for m in levels)[-2:]
    if len(fine) < 2:
        return levels[str(fine[0])][key]
    a, b = (levels[str(m)][key] for m in fine)
    weight = (fine[0] / fine[1]) ** p
    return (b - weight * a) / (1 - weight)


def finish(entries: list[dict[str, Any]]) -> None:
    """Fill in value, order and error of every entry from its levels."""
    seen: dict[str, list[float]] = {}
    for e in entries:
        if {"1", "2", "3"} <= e["levels"].keys():
            p = order([e["levels"][m][1] for m in "123"])
            if p is not None:
                seen.setdefault(e["case"], []).append(p)
    for e in entries:
        p = float(np.clip(np.median(seen[e["case"]]), 1.0, 4.0)) if e["case"] in seen else 1.3
        e["dx"], e["dz"] = (extrapolate(e["levels"], k, p) for k in (0, 1))
        finest = e["levels"][max(e["levels"])][1]
        e["order"] = round(p, 2)
        lone = len(e["levels"]) < 2
        e["error_percent"] = None if lone else round(100 * abs(e["dz"] - finest) / abs(e["dz"]), 4)


def main() -> None:
    """Solve what is asked for, adding to beams.json."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--levels", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--spans", nargs="+", default=list(SPANS), choices=list(SPANS))
    parser.add_argument("--laws", nargs="+", default=list(LAWS), choices=list(LAWS))
    args = parser.parse_args()
    old = json.loads(FILE.read_text())["beams"] if FILE.exists() else []
    table = {(e["case"], e["set"], e["G"]): e for e in old}
    for level in args.levels:
        for law in args.laws:
            kind, parameters, ratio, _ = LAWS[law]
            for span in args.spans:
                for modulus, dx, dz in solve(span, law, level):
                    G = round(modulus, 6)
                    material = {**scaled(parameters, G), "K": ratio * G}
                    if kind == "neo_hookean":
                        material["lambda"] = (ratio - 2 / 3) * G
                    entry = {"case": span, "set": law, "law": kind, "G": G, "K_over_G": ratio}
                    entry |= {"parameters": material, "levels": {}}
                    entry = table.setdefault((span, law, G), entry)
                    entry["levels"][str(level)] = [dx, dz]
                entries = sorted(table.values(), key=lambda e: (e["set"], e["case"], -e["G"]))
                finish(entries)
                about = {"units": "m, Pa, kg/m3", "radius": RADIUS, "density": DENSITY, "gravity": GRAVITY,
                         "levels": "level: [dx, dz]", "felupe": fe.__version__}  # fmt: skip
                write_whole(FILE, json.dumps({"about": about, "beams": entries}, indent=1) + "\n")
    worst = max((e["error_percent"] or math.inf for e in table.values()), default=math.inf)
    print(f"{len(table)} values, largest estimated error {worst} %, {clock():.0f} CPU s")


if __name__ == "__main__":
    main()
