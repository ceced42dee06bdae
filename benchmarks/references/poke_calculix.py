"""Force of a shallow normal poke by CalculiX beside FElupe's: does the reference's own contact hold?

    python -m benchmarks.references.poke_calculix --depth 1.6 --folder DIR      # CalculiX, two minutes
    python -m benchmarks.references.poke_calculix --felupe 0.35 0.95 1.55       # the same law, 5 s

The disc and the rod of poke.py, but CalculiX's Neo-Hookean law, mu/2 (I1bar - 3) + K/2 (J - 1)^2. CalculiX:
CAX8R elements, a deformable rod some 10,000 times stiffer, face-to-face penalty contact of 6e9 Pa/m. It needs
`ccx` (2.20); beyond 1.6 mm it has found no equilibrium. It prints its depth and force at each increment.
"""

from __future__ import annotations

import argparse
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
RADIUS, HEIGHT, ROD, EDGE = 50.0, 32.0, 2.5, 1.0  # mm
MU, BULK, PENALTY, FRICTION = 0.030, 0.600, 6.0, 0.6  # MPa, MPa/mm
THICK = 0.3  # of the meshed skin of the rod [mm]
SECTORS = 180  # CalculiX meshes a sector of two degrees
STEP = 0.2  # largest increment [mm]


def graded(count: int, growth: float) -> Array:
    """0 to 1: corners and middles of count intervals."""
    s = np.linspace(0.0, 1.0, 2 * count + 1)
    return np.asarray((np.exp(growth * s) - 1.0) / (np.exp(growth) - 1.0))


def spans(knots: tuple[float, ...], counts: tuple[int, ...]) -> Array:
    """Corners and middles of intervals cut evenly between the knots."""
    ends = [np.linspace(a, b, 2 * n + 1) for a, b, n in zip(knots[:-1], knots[1:], counts, strict=True)]
    return np.unique(np.concatenate(ends).round(12))


@dataclass
class Deck:
    """Nodes and 8-node elements written so far."""

    nodes: list[str]
    elements: list[str]

    def grid(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Number nodes (n, m), 0 at the middles of elements, and elements, from 1, of points (n, m)."""
        number = np.zeros(x.shape, dtype=int)
        for i, j in np.ndindex(x.shape):
            if i % 2 and j % 2:
                continue
            self.nodes.append(f"{len(self.nodes) + 1},{x[i, j]:.9g},{y[i, j]:.9g},0.")
            number[i, j] = len(self.nodes)
        cells = np.zeros((x.shape[0] // 2, x.shape[1] // 2), dtype=int)
        for i, j in np.ndindex(cells.shape):
            c = number[2 * i : 2 * i + 3, 2 * j : 2 * j + 3]
            at = (c[0, 0], c[2, 0], c[2, 2], c[0, 2], c[1, 0], c[2, 1], c[1, 2], c[0, 1])
            self.elements.append(f"{len(self.elements) + 1}," + ",".join(map(str, at)))
            cells[i, j] = len(self.elements)
        return number, cells


def outline(depth: float, off: float) -> tuple[Array, Array]:
    """Radius and height of the rod's profile, `off` inside its surface [mm]."""
    flat, angle = np.linspace(0.0, ROD - EDGE, 13), np.linspace(0.0, np.pi / 2, 25)[1:]
    shaft = np.linspace(0.0, depth + 3.0, 21)[1:]
    r = [flat, ROD - EDGE + (EDGE - off) * np.sin(angle), np.full(20, ROD - off)]
    z = [np.full(13, off), EDGE - (EDGE - off) * np.cos(angle), EDGE + shaft]
    return np.concatenate(r), HEIGHT + np.concatenate(z)


def write(path: Path, depth: float) -> None:
    """The input file."""
    near = spans((0.0, 1.2, 3.6), (2, 8))
    radial = np.concatenate([near, (near[-1] + (RADIUS - near[-1]) * graded(8, 4.0))[1:]])
    axial = HEIGHT * (1.0 - graded(10, 2.2))[::-1]
    deck = Deck([], [])
    tissue, cells = deck.grid(*np.meshgrid(radial, axial, indexing="ij"))
    soft = len(deck.elements)
    lines = [outline(depth, off) for off in (0.0, THICK / 2, THICK)]
    rod, skin = deck.grid(*(np.stack([line[k] for line in lines], axis=1) for k in (0, 1)))
    top = cells[radial[2::2][: len(cells)] < 12.0, -1]

    def rows(numbers: Array, end: str = ",") -> str:
        return "\n".join(f"{n}{end}" for n in numbers if n)

    path.write_text(
        "\n".join(
            [
                "*NODE", *deck.nodes,
                "*ELEMENT,TYPE=CAX8R,ELSET=TISSUE", *deck.elements[:soft],
                "*ELEMENT,TYPE=CAX8,ELSET=ROD", *deck.elements[soft:],
                "*NSET,NSET=BASE", rows(tissue[:, 0]),
                "*NSET,NSET=AXIS", rows(tissue[0, 1:]),
                "*NSET,NSET=HELD", rows(rod[:, 2]),
                "*SURFACE,NAME=STISSUE,TYPE=ELEMENT", rows(top, ",S3"),
                "*SURFACE,NAME=SROD,TYPE=ELEMENT", rows(skin[:, 0], ",S1"),
                "*MATERIAL,NAME=SOFT", "*HYPERELASTIC,NEO HOOKE", f"{MU / 2},{2 / BULK}",
                "*MATERIAL,NAME=HARD", "*ELASTIC", "2000.,0.3",
                "*SOLID SECTION,ELSET=TISSUE,MATERIAL=SOFT", "*SOLID SECTION,ELSET=ROD,MATERIAL=HARD",
                "*SURFACE INTERACTION,NAME=SI", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR",
                f"{PENALTY},0.,0.01", "*FRICTION", f"{FRICTION},{PENALTY / 2}",
                "*CONTACT PAIR,INTERACTION=SI,TYPE=SURFACE TO SURFACE", "STISSUE,SROD",
                "*BOUNDARY", "BASE,1,2", "AXIS,1,1", "HELD,1,1",
                "*STEP,NLGEOM,INC=10000", "*STATIC", f"{0.1 / depth},1.,1e-7,{STEP / depth}",
                "*BOUNDARY", f"HELD,2,2,{-depth}",
                "*NODE PRINT,NSET=BASE,TOTALS=ONLY", "RF", "*END STEP", "",
            ]
        )
    )  # fmt: skip


def felupe(depths: list[float]) -> None:
    """The same by FElupe, at level 1; depths in mm."""
    import felupe as fe

    from benchmarks.references import poke as model

    class Case(model.Case):
        def mixed_law(self) -> Any:
            return fe.NearlyIncompressible(fe.NeoHooke(mu=1e6 * MU), bulk=1e6 * BULK)

    class Rod(model.FlatRod):  # a linear penalty from the first touch on, as CalculiX has it
        def __init__(self, *args: Any, **named: Any) -> None:
            super().__init__(*args, **named, soft=1e-7)

    model.FlatRod = Rod  # type: ignore[misc]
    model.poke(FRICTION, 1, case=Case(depths=tuple(1e-3 * d for d in depths)))


def main() -> None:
    """Print depth [mm] and force [N]."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--depth", type=float, default=1.6, help="mm")
    parser.add_argument("--folder", type=Path, default=Path(), help="for CalculiX's files")
    parser.add_argument("--felupe", type=float, nargs="+", metavar="DEPTH", help="mm")
    args = parser.parse_args()
    if args.felupe:
        felupe(args.felupe)
        return
    write(args.folder / "poke.inp", args.depth)
    done = subprocess.run(["ccx", "poke"], cwd=args.folder, capture_output=True, text=True, check=False)
    text = (args.folder / "poke.dat").read_text()
    for block in text.split("set BASE and time")[1:]:
        time, _, force = block.split()[:3]
        print(f"{args.depth * float(time):.3f} mm {SECTORS * float(force):.4f} N")
    if done.returncode:
        print(f"ccx ended there with {done.returncode}")


if __name__ == "__main__":
    main()
