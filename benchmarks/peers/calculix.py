"""CalculiX as a peer: one static solve of a tetrahedral mesh under gravity or moved nodes; SI units.

Laws (CalculiX manual, *HYPERELASTIC): the isochoric part depends on Ibar, lbar; the volumetric one is
(J - 1)^2 / D1 with D1 = 2/K for all but Arruda-Boyce, which has ((J^2 - 1)/2 - ln J) / D, D = 2/K.
    NEO HOOKE      C10 (I1bar - 3),                          G = 2 C10
    MOONEY-RIVLIN  C10 (I1bar - 3) + C01 (I2bar - 3),        G = 2 (C10 + C01)
    OGDEN, N       sum 2 mu_i/alpha_i^2 (sum lbar^alpha_i - 3), G = sum mu_i; from the paper's convention
                   mu_p/alpha_p (...) comes mu_i = mu_p alpha_p / 2
    ARRUDA-BOYCE   mu (1/2 (I1bar - 3) + 1/(20 lm^2) (I1bar^2 - 9) + ...), lm the locking stretch
The paper's Neo-Hookean (mu/2 (I1 - 3) - mu ln J + lam/2 ln^2 J) is not split into isochoric and volumetric
parts: it has the same moduli at rest, and differs where the volume changes; K/2 ln^2 J against K/2 (J - 1)^2
differs by terms of third order in J - 1. On the same C3D10 mesh of the box beam of references/cases.py, at
K/mu = 20, FElupe with the paper's forms and CalculiX are 0.02 % apart (Neo-Hookean) and less (Ogden).

Reactions are CalculiX's RF: they leave out the weight that falls on the fixed nodes themselves.

ccx is run on one thread and timed by what the system charges the child.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
ELEMENTS = {4: "C3D4", 10: "C3D10", 20: "C3D20R"}


@dataclass(frozen=True)
class Result:
    """displacement [m], reaction [N] at each node (zero where free), CPU seconds of ccx, its log."""

    displacement: Array
    reaction: Array
    cpu_seconds: float
    converged: bool
    iterations: int
    log: str


def hyperelastic(law: str, bulk: float, **p: Any) -> list[str]:
    """*HYPERELASTIC card of a law: neo_hookean (mu), mooney_rivlin (C10, C01), ogden (mu, alpha, in the
    convention mu/alpha), arruda_boyce (mu, locking_stretch); moduli and bulk in Pa."""
    d = 2.0 / bulk
    if law == "neo_hookean":
        return ["*HYPERELASTIC, NEO HOOKE", f"{p['mu'] / 2:.12g}, {d:.12g}"]
    if law == "mooney_rivlin":
        return ["*HYPERELASTIC, MOONEY-RIVLIN", f"{p['C10']:.12g}, {p['C01']:.12g}, {d:.12g}"]
    if law == "arruda_boyce":
        return ["*HYPERELASTIC, ARRUDA-BOYCE", f"{p['mu']:.12g}, {p['locking_stretch']:.12g}, {d:.12g}"]
    if law == "ogden":
        pairs = [(m * a / 2, a) for m, a in zip(p["mu"], p["alpha"], strict=True)]
        # all of the volumetric energy in the first term: the others get next to none
        values = [x for pair in pairs for x in pair] + [d] + [1e12 * d] * (len(pairs) - 1)
        lines = [", ".join(f"{x:.12g}" for x in values[k : k + 8]) for k in range(0, len(values), 8)]
        return [f"*HYPERELASTIC, OGDEN, N={len(pairs)}", *lines]
    raise ValueError(f"CalculiX has no law called {law}")


def numbers(zero_based: Sequence[int]) -> str:
    """An element line: at most 16 entries a line, counted from 1."""
    text = [str(n + 1) for n in zero_based]
    return ",\n".join(",".join(text[k : k + 15]) for k in range(0, len(text), 15))


def deck(
    points: Array,
    cells: Array,
    card: Sequence[str],
    moved: Mapping[tuple[int, int], float],
    gravity: Sequence[float],
    density: float,
    increment: float,
) -> str:
    """Input deck; cells with 4 nodes become C3D4, with 10 C3D10, with 20 C3D20R (VTK and CalculiX agree on
    the order of the nodes).

    moved: prescribed displacement [m] by (node, axis), both from 0. gravity [m/s2]. increment: first load
    increment, a part of the whole; CalculiX adapts it.
    """
    out = ["*NODE, NSET=NALL"]
    out += [f"{i + 1},{x:.15g},{y:.15g},{z:.15g}" for i, (x, y, z) in enumerate(points)]
    out.append(f"*ELEMENT, TYPE={ELEMENTS[cells.shape[1]]}, ELSET=EALL")
    out += [numbers([e, *c]) for e, c in enumerate(cells.tolist())]
    out += ["*NSET, NSET=NFIX"] + [f"{n + 1}," for n in sorted({n for n, _ in moved})]
    out += ["*MATERIAL, NAME=SOFT", *card, "*DENSITY", f"{density:.12g}"]
    out += ["*SOLID SECTION, ELSET=EALL, MATERIAL=SOFT", "*STEP, NLGEOM, INC=1000", "*STATIC"]
    out += [f"{increment:.6g}, 1.0, 1e-6, 1.0", "*BOUNDARY"]
    out += [f"{n + 1},{k + 1},{k + 1},{u:.15g}" for (n, k), u in sorted(moved.items())]
    g = float(np.linalg.norm(gravity))
    if g > 0:
        unit = np.asarray(gravity) / g
        out += ["*DLOAD", f"EALL, GRAV, {g:.12g}, " + ", ".join(f"{x:.12g}" for x in unit)]
    out += ["*NODE PRINT, NSET=NALL, FREQUENCY=100000", "U", "*NODE PRINT, NSET=NFIX, FREQUENCY=100000", "RF"]
    return "\n".join([*out, "*END STEP", ""])


def tables(dat: str, nodes: int) -> dict[str, Array]:
    """The last table of "displacements" and "forces" in a .dat file, (nodes, 3) each."""
    out: dict[str, Array] = {}
    parts = re.split(r"^ *(displacements|forces) .*time +(\S+)$", dat, flags=re.MULTILINE)
    for name, time, body in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        rows = np.array([r.split() for r in body.strip().splitlines() if len(r.split()) == 4], float)
        table = np.zeros((nodes, 3))
        table[rows[:, 0].astype(int) - 1] = rows[:, 1:]
        out[name], out["time"] = table, np.array(float(time))
    return out


def solve(
    points: Array,
    cells: Array,
    card: Sequence[str],
    moved: Mapping[tuple[int, int], float],
    gravity: Sequence[float] = (0.0, 0.0, -9.81),
    density: float = 1000.0,
    increment: float = 0.2,
    timeout: float = 3600.0,
) -> Result:
    """Write the deck in a temporary folder, run ccx on one thread, read what it found."""
    program = shutil.which("ccx")
    if program is None:
        raise RuntimeError("ccx not found: apt-get install calculix-ccx")
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "job.inp").write_text(deck(points, cells, card, moved, gravity, density, increment))
        threads = dict.fromkeys(("OMP_NUM_THREADS", "CCX_NPROC_STIFFNESS", "CCX_NPROC_EQUATION_SOLVER"), "1")
        command = ["timeout", str(timeout), program, "-i", "job"]
        with Path(folder, "log").open("wb") as log:
            own = {**os.environ, **threads}
            child = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log, env=own)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        text = Path(folder, "log").read_text(errors="replace")
        dat = Path(folder, "job.dat")
        found = tables(dat.read_text(), len(points)) if dat.exists() else {}
    zero = np.zeros((len(points), 3))
    through = "Job finished" in text and float(found.get("time", 0.0)) > 0.999999
    return Result(
        displacement=found.get("displacements", zero),
        reaction=found.get("forces", zero),
        cpu_seconds=usage.ru_utime + usage.ru_stime,
        converged=child.returncode == 0 and through,
        iterations=len(re.findall(r"^ iteration +\d+", text, flags=re.MULTILINE)),
        log=text,
    )


def fixed(nodes: Array) -> dict[tuple[int, int], float]:
    """All three displacements of these nodes held at zero."""
    return {(int(n), k): 0.0 for n in nodes for k in range(3)}
