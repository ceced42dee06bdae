"""Abaqus (Standard): material.inp, and beam.inp with hybrid 10-node tetrahedra (C3D10H).

*HYPERELASTIC with long-term moduli; *VISCOELASTIC by a Prony series whose fractions are parts of the modulus
at once; *MULLINS EFFECT, whose r, m and beta are those of tisim; *ANISOTROPIC HYPERELASTIC, HOLZAPFEL for
fibres in a neo-Hookean body (kappa 0: not dispersed).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from calibration.export import _inp
from calibration.export._forms import Form
from calibration.export._job import Job, Target, Written
from tisim import Material
from tisim.parts import HolzapfelGasserOgden, OgdenRoxburgh

MOST_TERMS = 13  # of a Prony series


def keeps(material: Material, form: Form) -> set[str]:
    found = set()
    if material.viscosity is not None and len(material.viscosity.spectrum().times) <= MOST_TERMS:
        found.add("viscosity")
    if _softens(material):
        found.add("softening")
    if material.fibres is not None and _inp.has_fibres(material, form):
        found.add("fibres")
    return found


def _softens(material: Material) -> bool:
    """*MULLINS EFFECT needs an r above 1, as it is written; tisim also has 1."""
    return isinstance(material.softening, OgdenRoxburgh) and float(_inp.number(material.softening.r)) > 1.0


def writes(form: Form, material: Material) -> Form | None:
    found = _inp.writes(form, material)
    if found is None or material.fibres is None or not _inp.has_fibres(material, found):
        return found
    return replace(found, volume="square")  # of HOLZAPFEL; the others have (J - 1)^2


def material_lines(job: Job) -> list[str]:
    form, m = job.form, job.material
    out = [f"** {job.name}: Pa, kg/m3, s", "*MATERIAL, NAME=SOFT", "*DENSITY", f"{_inp.number(m.density)},"]
    moduli = ", MODULI=LONG TERM" if "viscosity" in job.keeps else ""
    if "fibres" in job.keeps:
        assert isinstance(m.fibres, HolzapfelGasserOgden)
        constants = [form.terms[0][1], 2.0 / form.bulk, m.fibres.k1, max(m.fibres.k2, _inp.SMALLEST), 0.0]
        # directions belong to the orientation that the section names; the fibres are its first axis
        a = m.fibres.axis()
        across = np.cross(a, np.eye(3)[int(np.abs(a).argmin())])
        turned = "*ORIENTATION, NAME=FIBRES, SYSTEM=RECTANGULAR, LOCAL DIRECTIONS=1"
        out = [out[0], turned, *_inp.rows([*a, *across]), "1, 0.", "1., 0., 0.", *out[1:]]
        out += [f"*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS=1{moduli}", *_inp.rows(constants)]
    else:
        out += _inp.hyperelastic(form, further=0.0, options=moduli)
    if "viscosity" in job.keeps:
        assert m.viscosity is not None
        spectrum = m.viscosity.spectrum()
        out.append("*VISCOELASTIC, TIME=PRONY")
        for strength, time in zip(spectrum.strengths, spectrum.times, strict=True):
            out += _inp.rows([float(strength) / spectrum.instantaneous, 0.0, float(time)])
    if "softening" in job.keeps:
        assert isinstance(m.softening, OgdenRoxburgh)
        out += ["*MULLINS EFFECT", *_inp.rows([m.softening.r, m.softening.m, m.softening.beta])]
    return out


def write(job: Job, folder: Path) -> Written:
    material = folder / "material.inp"
    lines = material_lines(job)
    material.write_text("\n".join([*lines, ""]), encoding="ascii", errors="replace")
    files = {material: "the material: include it, or copy it into a deck"}
    remarks = ["not run by tisim's tests, which have no Abaqus: syntax as its Keywords Reference has it"]
    if isinstance(job.material.softening, OgdenRoxburgh) and "softening" not in job.keeps:
        remarks.append("Abaqus takes an r of Ogden-Roxburgh softening above 1 only")
    if "softening" in job.keeps and "viscosity" in job.keeps:
        remarks.append(
            "in what order softening and viscosity act is Abaqus's own; in tisim viscosity relaxes what"
            " softening leaves"
        )
    if "fibres" in job.keeps:
        remarks.append("fibres need ORIENTATION=FIBRES on the section of every body of this material")
    if job.scene is None:
        return Written(files=files, remarks=tuple(remarks))
    deck = ["*HEADING", f"{job.name}: {job.scene.name}", *_inp.mesh_lines(job.scene, "C3D10H"), *lines]
    section = "*SOLID SECTION, ELSET=BEAM, MATERIAL=SOFT"
    if "fibres" in job.keeps:
        section += ", ORIENTATION=FIBRES"
    deck += [section, "*STEP, NLGEOM=YES, INC=1000"]
    deck += ["*STATIC, LONG TERM" if "viscosity" in job.keeps else "*STATIC", "0.1, 1., 1e-6, 1."]
    deck += _inp.load_lines(job.scene)
    deck += ["*OUTPUT, FIELD", "*NODE OUTPUT", "U, RF", "*ELEMENT OUTPUT", "S, LE", "*END STEP"]
    beam = folder / "beam.inp"
    beam.write_text("\n".join([*deck, ""]), encoding="ascii", errors="replace")
    return Written(
        files={**files, beam: "the beam, ready to run"},
        run="abaqus job=beam interactive",
        remarks=tuple(remarks),
    )


TARGET = Target(
    name="abaqus",
    title="Abaqus/Standard 2021 and newer",
    writes=writes,
    keeps=keeps,
    write=write,
    # C3D10H has pressures as tisim's element has, continuous or not
    element_error=0.005,
)
