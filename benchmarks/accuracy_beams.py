"""Deflection errors of static beams against references/beams.json; prints a table.

    python -m benchmarks.accuracy_beams                      # the default beams, the whole table: 10 s
    python -m benchmarks.accuracy_beams --element tet4 --mesh paper   # the paper's mesh of 7,257 nodes: 3 min
    python -m benchmarks.accuracy_beams --element hex8 --mesh fine

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

Errors of the downward and of the axial displacement are in % of the magnitude of the reference displacement;
negative means too small (too stiff). The error of the reference itself is printed beside them. Newton counts
linearisations from the undeformed state, including the first. CPU is the time on one core; for the first beam
of a mesh it includes numbering and symbolic factorisation, but not compilation.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tisim.material import Material
from tisim.mesh import PAPER_LAYER, PAPER_RINGS
from tisim.problems.beam.solve import solve_beam
from tisim.scene import Beam

FILE = Path(__file__).parent / "references" / "beams.json"
MESHES = {"default": (2, 0.007), "fine": (4, 0.0035), "paper": (PAPER_RINGS, PAPER_LAYER)}  # rings, layer [m]


@dataclass(frozen=True)
class Row:
    """Result of one beam.

    Attributes
    ----------
    case, law : str
        Support and length, and the table's set of parameters.
    modulus : float
        Shear modulus [Pa].
    down, along : float
        Errors of dz and dx [%]; NaN if the beam did not converge.
    reference_error : float
        Error of the reference [%].
    nodes, newton : int
        Nodes of the mesh and Newton iterations.
    cpu : float
        Time on one core [s].
    """

    case: str
    law: str
    modulus: float
    down: float
    along: float
    reference_error: float
    nodes: int
    newton: int
    cpu: float


def material(entry: dict[str, Any]) -> Material:
    """Material of an entry of the table."""
    p, law = entry["parameters"], entry["law"]
    if law == "neo_hookean":
        return Material(law="neo-hookean", parameters={"mu": p["mu"], "lam": p["lambda"]})
    if law == "ogden":
        series = {"mu": tuple(p["mu"]), "alpha": tuple(p["alpha"])}
        return Material(law="ogden", parameters={**series, "bulk": p["K"]})
    return Material(law="mooney-rivlin", parameters={"c10": p["C10"], "c01": p["C01"], "bulk": p["K"]})


def rows(element: Any, mesh: str, only: list[str] | None) -> Iterator[Row]:
    """Solve every entry of the table."""
    rings, layer = MESHES[mesh]
    for entry in json.loads(FILE.read_text())["beams"]:
        if only and entry["set"] not in only:
            continue
        kind, length = entry["case"].split("-")
        length, bridge = float(length) / 1e3, kind == "bridge"
        scene = Beam(
            material=material(entry),
            length=length,
            supports="clamped-clamped" if bridge else "clamped-free",
            element=element,
            radial_elements=rings,
            axial_element_size=layer,
        )
        result = solve_beam(scene)
        rest = result.mesh.nodes
        place = np.linalg.norm(rest - [length / 2 if bridge else length, 0, 0], axis=1).argmin()
        down = along = np.nan
        if result.ok:
            dx, _, dz = result.positions[-1, place] - rest[place]
            size = float(np.hypot(entry["dx"], entry["dz"]))
            down, along = 100 * (entry["dz"] - dz) / size, 100 * (entry["dx"] - dx) / size
        cost = result.cost
        yield Row(entry["case"], entry["set"], entry["G"], down, along, entry["error_percent"], len(rest),
                  cost.newton_iterations, cost.core_seconds)  # fmt: skip


def main() -> None:
    """Print all errors and the worst by case and law."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--element", default="default", choices=["default", "tet4", "tet10", "hex8"])
    parser.add_argument("--mesh", default="default", choices=list(MESHES))
    parser.add_argument("--laws", nargs="+", help="sets of the table, such as neo_hookean-20")
    args = parser.parse_args()
    found = []
    head = f"{'beam':15s} {'law':17s} {'G kPa':>6s} {'nodes':>6s}"
    print(f"{head} {'down %':>8s} {'along %':>8s} {'ref %':>6s} newton  CPU s")
    for r in rows(args.element, args.mesh, args.laws):
        found.append(r)
        print(
            f"{r.case:15s} {r.law:17s} {r.modulus / 1e3:6.0f} {r.nodes:6d} {r.down:+8.3f} {r.along:+8.3f}"
            f" {r.reference_error:6.3f} {r.newton:6d} {r.cpu:6.3f}",
            flush=True,
        )
    errors = [max(r.down, r.along, key=abs) for r in found]
    cases = sorted({r.case for r in found})
    print(f"\nworst error in %, over G\n{'':17s}" + "".join(f"{c:>16s}" for c in cases))
    for law in sorted({r.law for r in found}):
        by_case = {
            c: max((e for r, e in zip(found, errors, strict=True) if (r.law, r.case) == (law, c)), key=abs)
            for c in cases
        }
        print(f"{law:17s}" + "".join(f"{by_case[c]:+16.3f}" for c in cases))
    lost = sum(bool(np.isnan(r.down)) for r in found)
    worst = np.nanmax(np.abs(errors))
    print(f"{len(found)} beams, {lost} did not converge, worst {worst:.3f} %")


if __name__ == "__main__":
    main()
