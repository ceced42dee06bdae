"""Example files of testing machines, made: one neo-Hookean material of 25 kPa, with noise.

    python datasets/lab-files/make.py [FOLDER]

Layouts are those that the programs write; numbers were never measured. `answers.yaml` is written by hand.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

MU = 25e3  # Pa
GRAM_FORCE = 9.80665e-3  # N


def nominal(stretch: np.ndarray) -> np.ndarray:
    """Nominal stress in tension and compression [Pa]."""
    return MU * (stretch - stretch**-2)


def comma(values: tuple[float, ...], digits: int = 5) -> list[str]:
    return [f"{v:.{digits}f}".replace(".", ",") for v in values]


def instron(rng: np.random.Generator) -> str:
    """A strip of 10 x 2 mm, 50 mm between the grips, pulled to twice its length: Bluehill with semicolons and
    decimal commas."""
    lines = [
        "General : Start date;2026-11-20;",
        "Specimen properties : Specimen label;strip 1;",
        "Specimen properties : Width;10,0;mm",
        "Specimen properties : Thickness;2,0;mm",
        "Specimen properties : Length;50,0;mm",
        "",
        "Time;Extension;Load;Cycle count",
        "(s);(mm);(N);",
    ]
    for time in np.linspace(0.0, 60.0, 61):
        stretch = 1.0 + time / 60.0
        force = 20e-6 * nominal(stretch) + 2e-3 * rng.normal()
        lines.append(";".join([*comma((time, 50.0 * (stretch - 1.0), force)), "1"]))
    return "\n".join(lines) + "\n"


def zwick(rng: np.random.Generator) -> str:
    """Two cylinders of 30 mm diameter and 15 mm height, compressed by 30 %: testXpert, German names, tabs."""
    lines = ["testXpert III", "Probendurchmesser: 30 mm", "Probenhöhe: 15 mm", ""]
    for number in (1, 2):
        lines += [f"Druckversuch {number}", '"Prüfzeit"\t"Standardweg"\t"Standardkraft"', '"s"\t"mm"\t"N"']
        for time in np.linspace(0.0, 45.0, 46):
            down = time / 10.0
            force = -706.858e-6 * nominal(1.0 - down / 15.0) + 0.02 * rng.normal()
            lines.append("\t".join(comma((time, down, force))))
        lines.append("")
    return "\n".join(lines)


def trios(rng: np.random.Generator) -> str:
    """Simple shear between plates to 50 %, in two steps: TRIOS, "Export to LIMS"."""
    lines = [
        "[Version]",
        "TA Instruments LIMS export format version\t0",
        "[Header]",
        "Instrument name\tDiscovery HR-2",
        "[Sample]",
        "Name\tgel",
        "[Geometry: Standard]",
        "Diameter\t25.0 mm",
        "Gap\t1.000 mm",
    ]
    for name, factor in (("Conditioning", 0.2), ("Stress growth", 1.0)):
        lines += [
            "[Step]",
            f"Step name\t{name} (25.0 °C)",
            "Number of points\t41",
            "Variables\tStep time\tStrain\tStress\tNormal stress\tStatus bits\tDate and time",
            "Units\ts\t%\tPa\tPa\t\t",
        ]
        end = "\t0xB6453\t11/20/2026 1:43:31 PM"
        for time in np.linspace(0.5, 20.5, 41):
            gamma = factor * (time - 0.5) / 40.0
            stress = MU * gamma + 20.0 * rng.normal()
            lines.append(
                f"Data point\t{time:.3f}\t{100 * gamma:.5f}\t{stress:.4f}\t{5 * rng.normal():.4f}" + end
            )
    return "\n".join(lines) + "\n"


def mach1(rng: np.random.Generator) -> str:
    """A flat rod of 3 mm radius pushed 2 mm into a block and held: Mach-1 Motion, forces in gram-force, the
    stage moves towards smaller positions, and pushing forces are negative."""
    info = ["<INFO>", "Date:\tFri, Nov 20, 2026", "Load Cell Name:\t250N", "<END INFO>"]
    lines = ["<Mach-1 File>"]

    def block(name: str, parameters: list[str], time: np.ndarray, depth: np.ndarray) -> None:
        lines.extend([*info, f"<{name}>", *parameters, "<DATA>", "Time, s\tPosition (z), mm\tFz, gf"])
        force = 8.0 * MU * 3e-3 * np.maximum(depth, 0.0) * 1e-3 + 1e-3 * rng.normal(size=depth.size)
        for t, d, f in zip(time, depth, force, strict=True):
            lines.append(f"{t:.6f}\t{-12.5 - d:.6f}\t{-f / GRAM_FORCE:.6f}")
        lines.append("<END DATA>")

    time = np.linspace(0.0, 4.0, 21)
    block("Find Contact", ["Velocity, mm/s:\t0.1"], time, -0.4 + 0.1 * time)
    time = np.linspace(0.0, 10.0, 51)
    block("Move Relative", ["Amplitude, mm:\t-2.0000"], time, np.minimum(0.5 * time, 2.0))
    return "\n".join(lines) + "\n"


def plain(rng: np.random.Generator) -> str:
    """A strip of 8 x 3 mm pulled by 60 %: a table with units in its header."""
    lines = ["Time/s,strain %,Stress (kPa)"]
    for time in np.linspace(0.0, 30.0, 31):
        stretch = 1.0 + 0.02 * time
        stress = 1e-3 * nominal(stretch) + 0.1 * rng.normal()
        lines.append(f"{time:.2f},{100 * (stretch - 1):.4f},{stress:.4f}")
    return "\n".join(lines) + "\n"


FILES = {
    "instron.csv": instron,
    "zwick.txt": zwick,
    "trios.txt": trios,
    "mach-1.txt": mach1,
    "plain.csv": plain,
}


def main(folder: Path) -> None:
    """Write all files; each has its own random numbers."""
    for number, (name, make) in enumerate(FILES.items()):
        (folder / name).write_text(make(np.random.default_rng(number)), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
