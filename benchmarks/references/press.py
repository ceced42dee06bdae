"""Bonded cylinders pressed by a little and by 10 and 15 %: axisymmetric Q2/P-1 elements of FElupe.

    python -m benchmarks.references.press        # writes press.json beside it, two minutes

No side contact: at these strains the fold at the platen's edge is not there yet, or too small to matter.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.cylinder import graded
from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, mixed_fields
from benchmarks.references.quadrilaterals import quadrilaterals
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]

FILE = Path(__file__).with_suffix(".json")
RADIUS, MU = 0.025, 10e3
STRETCHES = (0.999, 0.9, 0.85)
# height [m], K/G, law, its parameters
CASES: tuple[tuple[float, float, str, dict[str, float]], ...] = (
    (0.030, 20.0, "neo_hookean", {"mu": MU}),
    (0.030, 300.0, "neo_hookean", {"mu": MU}),
    (0.030, 1000.0, "neo_hookean", {"mu": MU}),
    (0.030, 300.0, "mooney_rivlin", {"C10": 0.25 * MU, "C01": 0.25 * MU}),
    (0.010, 300.0, "neo_hookean", {"mu": MU}),
)


def meridian(height: float, level: int) -> fe.Mesh:
    """Upper half in (z, r), refined towards the platen's edge; 9-node quadrangles."""
    z = 0.5 * height * (1.0 - graded(6 * level, 3.0)[::-1])
    r = RADIUS * (1.0 - graded(8 * level, 3.0)[::-1])
    return quadrilaterals(z, r)


def press(height: float, ratio: float, law: str, parameters: dict[str, float], level: int) -> list[float]:
    """Nominal stress over MU at each stretch."""
    mesh = meridian(height, level)
    field = mixed_fields(fe.RegionBiQuadraticQuad(mesh), axisymmetric=True)
    z, r = mesh.points.T
    dof = np.arange(2 * mesh.npoints).reshape(-1, 2)
    top, middle, axis = z > 0.5 * height - 1e-12, z < 1e-12, r < 1e-12
    fixed = np.unique(np.concatenate([dof[top].ravel(), dof[middle, 0], dof[axis, 1]]))
    pushed = np.isin(fixed, dof[top, 0])
    zero = np.zeros(field[0].values.size)
    model = MixedModel(
        field,
        mixed_law(law, ratio * MU, **parameters),
        fixed,
        lambda _: zero,
        prescribed=lambda strain: np.where(pushed, -0.5 * height * strain, 0.0),
        tolerance=1e-9,
    )
    out: list[float] = []

    def report(strain: float) -> None:
        out.append(float(model.reaction[pushed].sum()) / (np.pi * RADIUS**2 * MU))
        print(
            f"H {height * 1e3:g} mm, K/G {ratio:g}, {law}, level {level}, {strain:g}: {out[-1]:.5f}",
            flush=True,
        )

    if not model.path(0.0, [1.0 - s for s in STRETCHES], report, 1e-3, 0.01):
        print("no equilibrium beyond the values above", flush=True)
    return out


def main() -> None:
    """All cases on two meshes."""
    found = [
        {
            "height": height,
            "ratio": ratio,
            "law": law,
            "parameters": parameters,
            "stress": {str(level): press(height, ratio, law, parameters, level) for level in (1, 2)},
        }
        for height, ratio, law, parameters in CASES
    ]
    about = {
        "units": "m, Pa; stress: nominal, over mu, by mesh level",
        "radius": RADIUS,
        "mu": MU,
        "stretches": STRETCHES,
        "felupe": fe.__version__,
    }
    write_whole(FILE, json.dumps({"about": about, "cases": found}, indent=1) + "\n")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
