"""Force of bonded cylinders from axisymmetric FElupe elements: writes `bonded.json`.

    python -m benchmarks.blind.compression.make_table        # some minutes

The cylinder is 50 mm by 30 mm, with K/G = 1000. The computation shares nothing with `tisim`: biquadratic
elements with constant-plus-linear pressure (`benchmarks/references/mixed.py`); a node of the lateral surface
that reaches the platen is held there by springs.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np
import scipy.sparse as sp

from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, mixed_fields
from benchmarks.references.press import meridian
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]

FILE = Path(__file__).with_name("bonded.json")
RADIUS, HEIGHT, MU, RATIO = 0.025, 0.030, 10e3, 1000.0
STRAINS = [0.01, *(round(0.025 * k, 3) for k in range(1, 23))]
SPRING = 1e7  # [N/m] per node
LEVEL = 2
SHAPES, SHAPES_TO = (1.0, 2.0), 0.2
CASES: dict[str, tuple[str, dict[str, float]]] = {
    "neo-hookean": ("neo_hookean", {"mu": MU}),
    "mooney-rivlin 0.3": ("mooney_rivlin", {"C10": 0.35 * MU, "C01": 0.15 * MU}),
}


class Platen:
    """Contact of the lateral nodes with the platen at height/2 (1 - strain); coordinates are (z, r)."""

    def __init__(self, points: Array, side: Array, height: float) -> None:
        self.points, self.side, self.height = points, side, height
        self.landed: dict[int, float] = {}  # node: radius at which it touched down
        self.pushed = 0.0

    def assemble(self, u: Array, factor: float) -> tuple[Array, sp.csr_matrix]:
        x = self.points + u
        platen = 0.5 * self.height * (1.0 - factor)
        force, stiff = np.zeros_like(u), np.zeros_like(u)
        self.pushed = 0.0
        for n in self.side:
            over = x[n, 0] - platen
            if n in self.landed:
                force[n] = SPRING * np.array([over, x[n, 1] - self.landed[n]])
                stiff[n] = SPRING
            elif over > 0.0:
                force[n, 0], stiff[n, 0] = SPRING * over, SPRING
            self.pushed += force[n, 0]
        return force.ravel(), sp.diags(stiff.ravel()).tocsr()

    def accept(self, u: Array, factor: float) -> None:
        x = self.points + u
        for n in self.side:
            if x[n, 0] > 0.5 * self.height * (1.0 - factor):
                self.landed.setdefault(int(n), float(x[n, 1]))


def press(
    law: str, parameters: dict[str, float], level: int = LEVEL, *, height: float = HEIGHT, last: float = 1.0
) -> list[float]:
    """Nominal stress over MU at STRAINS, up to the strain `last` or the last one with an equilibrium."""
    mesh = meridian(height, level)
    field = mixed_fields(fe.RegionBiQuadraticQuad(mesh), axisymmetric=True)
    z, r = mesh.points.T
    dof = np.arange(2 * mesh.npoints).reshape(-1, 2)
    top, middle, axis = z > 0.5 * height - 1e-12, z < 1e-12, r < 1e-12
    fixed = np.unique(np.concatenate([dof[top].ravel(), dof[middle, 0], dof[axis, 1]]))
    moved = np.isin(fixed, dof[top, 0])
    side = np.flatnonzero((r > RADIUS - 1e-12) & ~top)
    platen = Platen(mesh.points, side, height)
    zero = np.zeros(field[0].values.size)
    model = MixedModel(
        field,
        mixed_law(law, RATIO * MU, **parameters),
        fixed,
        lambda _: zero,
        prescribed=lambda strain: np.where(moved, -0.5 * height * strain, 0.0),
        tolerance=1e-7,
        contact=platen,
    )
    out: list[float] = []

    def report(strain: float) -> None:
        force = float(model.reaction[moved].sum()) - platen.pushed
        out.append(force / (np.pi * RADIUS**2 * MU))
        print(f"{law}, level {level}, {strain:g}: {out[-1]:.5f}, landed {len(platen.landed)}", flush=True)

    if not model.path(0.0, [s for s in STRAINS if s <= last], report, 0.005, 0.005):
        print("no equilibrium beyond the values above", flush=True)
    return out


def main() -> None:
    cases = {name: press(*case) for name, case in CASES.items()}
    # by diameter over height: effect of the shape on the bonding
    shapes = {
        str(slender): press(*CASES["neo-hookean"], height=2.0 * RADIUS / slender, last=SHAPES_TO)
        for slender in SHAPES
    }
    table = {
        "diameter_over_height": 2 * RADIUS / HEIGHT,
        "strains": STRAINS,
        "stress_over_shear_modulus": cases,
        "neo_hookean_by_diameter_over_height": shapes,
    }
    write_whole(FILE, json.dumps(table, indent=1) + "\n")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
