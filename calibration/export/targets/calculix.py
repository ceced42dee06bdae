"""CalculiX (ccx, 2.17 or newer): material.inp, and beam.inp with 10-node tetrahedra (C3D10).

Fibres: its user material ELASTIC_FIBER, a neo-Hookean body with fibres as tisim has them (manual, "Fiber
reinforced materials"). No viscosity and no softening beside *HYPERELASTIC.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.export import _inp
from calibration.export._forms import Form
from calibration.export._job import Job, Target, Written
from tisim import Material
from tisim.parts import HolzapfelGasserOgden

FURTHER = 1e3  # D of the further terms, so large that they carry no pressure; 0 would be set to a default
SECONDS = 3600.0


def keeps(material: Material, form: Form) -> set[str]:
    return {"fibres"} if material.fibres is not None and _inp.has_fibres(material, form) else set()


def material_lines(job: Job) -> list[str]:
    form, fibres = job.form, job.material.fibres
    out = [f"** {job.name}: Pa, kg/m3", "*MATERIAL, NAME=SOFT"]
    if "fibres" in job.keeps:
        assert isinstance(fibres, HolzapfelGasserOgden)
        axis = (1.0 - 1e-9) * fibres.axis()  # the program refuses a rounded sum of squares above 1
        axis = axis if axis[2] >= 0.0 else -axis  # its third component is taken as positive
        constants = [
            form.terms[0][1],
            2.0 / form.bulk,
            axis[0],
            axis[1],
            fibres.k1,
            max(fibres.k2, _inp.SMALLEST),
        ]
        out = [out[0], "*MATERIAL, NAME=ELASTIC_FIBER_SOFT", "*USER MATERIAL, CONSTANTS=6"]
        out += _inp.rows(constants)
    else:
        out += _inp.hyperelastic(form, further=FURTHER / form.bulk)
    return [*out, "*DENSITY", _inp.number(job.material.density)]


def write(job: Job, folder: Path) -> Written:
    material = folder / "material.inp"
    lines = material_lines(job)
    material.write_text("\n".join([*lines, ""]), encoding="ascii", errors="replace")
    files = {material: "the material: include it, or copy it into a deck"}
    if job.scene is None:
        return Written(files=files)
    name = next(x.partition("NAME=")[2] for x in lines if x.startswith("*MATERIAL"))
    deck = ["*HEADING", f"{job.name}: {job.scene.name}", *_inp.mesh_lines(job.scene, "C3D10"), *lines]
    deck += [f"*SOLID SECTION, ELSET=BEAM, MATERIAL={name}"]
    deck += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.2, 1., 1e-6, 1."]
    deck += _inp.load_lines(job.scene)
    deck += [
        "*NODE FILE",
        "U",
        "*EL FILE",
        "S, E",
        "*NODE PRINT, NSET=NALL, FREQUENCY=100000",
        "U",
        "*END STEP",
    ]
    beam = folder / "beam.inp"
    beam.write_text("\n".join([*deck, ""]), encoding="ascii", errors="replace")
    return Written(files={**files, beam: "the beam, ready to run"}, run="ccx -i beam")


def check(folder: Path) -> NDArray[np.float64]:
    program = shutil.which("ccx")
    if program is None:
        raise InputError("--check: ccx is not installed: apt-get install calculix-ccx")
    threads = dict.fromkeys(("OMP_NUM_THREADS", "CCX_NPROC_STIFFNESS", "CCX_NPROC_EQUATION_SOLVER"), "1")
    log, table = folder / "ccx.log", folder / "beam.dat"
    with log.open("wb") as out:
        try:
            code = subprocess.run(
                [program, "-i", "beam"], cwd=folder, env={**os.environ, **threads}, stdout=out,
                stderr=subprocess.STDOUT, check=False, timeout=SECONDS,
            ).returncode  # fmt: skip
        except subprocess.TimeoutExpired:
            raise InputError(
                f"--check: ccx did not solve the beam within {SECONDS:g} s and was stopped: see {log}"
            ) from None
    finished = "Job finished" in log.read_text(encoding="utf-8", errors="replace")
    if code or not finished or not table.is_file():
        raise InputError(f"--check: ccx found no equilibrium of the beam: see {log}")
    *_, last = table.read_text(encoding="utf-8").split("displacements")
    values = [line.split() for line in last.splitlines()[1:] if len(line.split()) == 4]
    found = np.array(values, dtype=float)
    return np.asarray(found[np.argsort(found[:, 0]), 1:])


TARGET = Target(
    name="calculix",
    title="CalculiX 2.17 and newer",
    writes=_inp.writes,
    keeps=keeps,
    write=write,
    # C3D10 has no pressure of its own: 0.5 to 2.7 % too stiff on the beams of docs/how-to/export.md
    element_error=0.04,
    check=check,
    results=("ccx.log", "spooles.out", *(f"beam.{x}" for x in ("12d", "cvg", "dat", "frd", "sta"))),
)
