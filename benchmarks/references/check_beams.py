"""CalculiX against beams.json: the 50 mm cantilever, G = 20 kPa, on the same meshes; prints a table.

    python -m benchmarks.references.check_beams                  # 90 s of one core

C3D20R on the first 20 nodes of the reference meshes' 27-node hexahedra, levels 1 to 3, extrapolated with the
observed order. CalculiX's Neo-Hookean is the split one with K/2 (J - 1)^2 (see peers/calculix.py).
"""

from __future__ import annotations

import argparse
import json

import numpy as np

from benchmarks.peers import calculix
from benchmarks.references.beams import FILE, LAWS, RADIUS, SPANS, extrapolate, order, scaled
from benchmarks.references.cylinder import half_cylinder


def tip(law: str, modulus: float, level: int) -> tuple[float, float, float]:
    """dx, dz of the tip [m] and CPU seconds."""
    length, layers, strength = SPANS["cantilever-50"]
    mesh = half_cylinder(RADIUS, length, layers, strength, level)
    used, cells = np.unique(mesh.cells[:, :20], return_inverse=True)
    points = mesh.points[used]
    kind, parameters, ratio, _ = LAWS[law]
    card = calculix.hyperelastic(kind, ratio * modulus, **scaled(parameters, modulus))
    held = calculix.fixed(np.flatnonzero(points[:, 0] < 1e-9))
    held |= {(int(n), 1): 0.0 for n in np.flatnonzero(np.abs(points[:, 1]) < 1e-9)}
    found = calculix.solve(points, cells.reshape(-1, 20), card, held)
    if not found.converged:
        raise RuntimeError(found.log[-500:])
    end = int(np.argmin(np.linalg.norm(points - [length, 0, 0], axis=1)))
    return float(found.displacement[end, 0]), float(found.displacement[end, 2]), found.cpu_seconds


def main() -> None:
    """Print the table."""
    table = {(e["case"], e["set"], e["G"]): e for e in json.loads(FILE.read_text())["beams"]}
    for law in ("neo_hookean-20", "ogden-4", "mooney_rivlin"):
        runs = [tip(law, 20e3, m) for m in (1, 2, 3)]
        p = order([r[1] for r in runs]) or 1.3
        value = extrapolate({str(m): list(r[:2]) for m, r in zip((1, 2, 3), runs, strict=True)}, 1, p)
        ours = table["cantilever-50", law, 20e3]["dz"]
        levels = ", ".join(f"{r[1] * 1e3:.4f} ({r[2]:.1f} s)" for r in runs)
        print(
            f"{law}: CalculiX dz {levels} -> {value * 1e3:.4f} mm (order {p:.2f}); "
            f"beams.json {ours * 1e3:.4f} mm; {100 * (value / ours - 1):+.3f} %",
            flush=True,
        )


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
