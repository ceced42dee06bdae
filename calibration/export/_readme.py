"""Losses of an export, with their sizes: README.md of its folder, and the screen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.export._convert import Conversion
from calibration.export._forms import COUPLED, VOLUMES, Form
from calibration.export._job import Job, Target, Written
from calibration.export._response import (
    Stability,
    elastic,
    fibre_loss,
    percent,
    relaxation,
    softening_loss,
    worst,
)
from tisim import parts

SIGNATURE = "SI units. Written by `python -m calibration.export`."  # by which a folder is known as an export
TITLES = {
    "polynomial": "polynomial in the isochoric invariants",
    "ogden": "Ogden",
    "arruda-boyce": "Arruda-Boyce",
    "neo-hookean": "neo-Hookean, coupled",
    "stable-neo-hookean": "stable neo-Hookean",
    "st-venant-kirchhoff": "St Venant-Kirchhoff",
}


def losses(job: Job, high: float) -> list[str]:
    """Properties that the target lacks, a sentence each with its size. high : largest stretch of interest."""
    found = _law(job)
    m = job.material
    plain = elastic(m)
    if m.viscosity is not None and "viscosity" not in job.keeps:
        sizes = ", ".join(f"{v:.3g} {k}" for k, v in relaxation(m).items())
        found.append(
            f"{m.viscosity.title} is left out: the moduli are long-time ones. The card's, as multiples of"
            f" these: {sizes}."
        )
    if m.softening is not None and "softening" not in job.keeps:
        loss = softening_loss(replace(plain, softening=m.softening), high)
        found.append(
            f"{m.softening.title} softening is left out: the law is that of first loading. Unloading from a"
            f" stretch of {high:.3g} the card's stress is up to {percent(loss)} smaller."
        )
    if m.fibres is not None and "fibres" not in job.keeps:
        loss = fibre_loss(plain, high)
        found.append(
            f"{m.fibres.title} are left out: along them, at a stretch of {high:.3g}, the card's stress is"
            f" {percent(loss)} larger."
        )
    return found


def _law(job: Job) -> list[str]:
    c = job.conversion
    found = []
    off = worst(c.differences)
    spread = "; ".join(
        f"{d.mode}, stretches {d.low:.3g} to {d.high:.3g}: {percent(d.rms)} rms, {percent(d.largest)} of the"
        " largest stress at most"
        for d in c.differences
    )
    law = job.material.law
    if c.how == "volume" and c.poisson is None:
        volume = VOLUMES[c.form.volume] if c.form.kind not in COUPLED else "its own"
        found.append(
            f"The law is {law} but for its volumetric part, which is {volume} there. Stress differs by"
            f" {percent(off.rms)} ({spread}); the pressure at a volume of 0.99 by {percent(c.pressure)}."
        )
    elif c.how == "volume":
        found.append(f"The law is {law} with a smaller Poisson's ratio, see below. Stress differs: {spread}.")
    elif c.how == "fit":
        fitted = (
            "" if c.form.kind in COUPLED else ", its further constants fitted to stress in the three tests"
        )
        found.append(
            f"There is no {law} there: {TITLES[c.form.kind]} stands for it, with the same Young's modulus at"
            f" small strain{fitted}. Stress differs: {spread}."
        )
        if c.unstable or c.unstable_card:
            found.append(_unstable(c, law))
    if c.poisson is not None:
        found.append(
            f"Poisson's ratio is {c.form.poisson:.4g} in place of the card's {c.poisson:.4g}, Young's modulus"
            " is kept: linear tetrahedra lock where the volume hardly changes. The pressure at a volume of"
            " 0.99"
            f" differs by {percent(c.pressure)}."
        )
    return found


def _unstable(c: Conversion, law: str) -> str:
    """Sentence on the tests in which the law that stands for the card's, or the card's own, is not stable."""
    ranges = {d.mode: (d.low, d.high) for d in c.differences}

    def limits(found: tuple[Stability, ...]) -> str:
        tests = []
        for s in found:
            sides = [f"below {s.below:.3g}"] if s.below is not None else []
            sides += [f"above {s.above:.3g}"] if s.above is not None else []
            tests.append(f"{s.mode}, stretches {' and '.join(sides)}")
        return "; ".join(tests)

    own = f"The card's own law, {law}, is not stable in {limits(c.unstable_card)}." if c.unstable_card else ""
    if not c.unstable:
        return own
    inside = any(
        (s.below is not None and s.below >= ranges[s.mode][0])
        or (s.above is not None and s.above <= ranges[s.mode][1])
        for s in c.unstable
    )
    title, where = TITLES[c.form.kind], "within" if inside else "only beyond"
    text = (
        f"The {title} is not stable everywhere (Drucker: its tangent is not positive definite), {where} the"
        f" range of these tests: {limits(c.unstable)}. A body that strains so far may find no equilibrium"
        " there, or another than the card's."
    )
    return f"{text} {own}".strip()


def scene_lines(job: Job, target: Target) -> list[str]:
    """Lines on the expected result of the scene."""
    if job.scene is None or job.prediction is None:
        return []
    p, share = job.prediction, target.element_share(job.scene.refinement)
    found = [
        f"Scene: {job.scene.name}. In tisim its end (or middle) moves by {_mm(p.reference)} mm;"
        f" {job.scene.mesh.n_nodes} nodes, {job.scene.mesh.n_elements} {target.element}."
    ]
    if p.expected is not None and target.element == "tet4":
        ratio = float(np.linalg.norm(p.expected) / np.linalg.norm(p.reference) - 1.0)
        found.append(
            f"Expected there: {_mm(p.expected)} mm, by tisim with the same law, elements and mesh: the beam"
            f" moves {percent(abs(ratio))} {'less' if ratio < 0 else 'more'}, its end is {percent(p.error)}"
            " off."
        )
        if p.elements is not None:
            found.append(
                f"Of that the linear tetrahedra of this mesh make {percent(abs(p.elements))}"
                f" ({'too stiff' if p.elements < 0 else 'too soft'}); the rest is the law. --refinement makes"
                " the mesh finer."
            )
    elif p.expected is not None and job.conversion.how == "fit":
        found.append(
            f"Expected there: {_mm(p.expected)} mm, by tisim with the {TITLES[job.form.kind]} that stands for"
            f" the card's {job.material.law}, on the same mesh: {percent(max(p.error - share, 0.0))} off by"
            f" law and mesh, and up to {percent(share)} more between the program's element and tisim's."
        )
    elif p.expected is not None:
        found.append(
            f"Expected there: {_mm(p.expected)} mm, at most {percent(p.error)} off: what this mesh's elements"
            f" make of it ({percent(max(p.error - share, 0.0))} in tisim, and up to"
            f" {percent(share)} between the program's element and tisim's)."
        )
    return [*found, *(f"{r[0].upper()}{r[1:]}." for r in p.remarks)]


def _mm(x: np.ndarray) -> str:
    return "(" + ", ".join(f"{1e3 * v + 0.0:.4g}" for v in np.round(x, 9)) + ")"


def constants(form: Form) -> str:
    """The form and its constants in a line."""
    values = [f"C{i}{j} = {c:.6g} Pa" for (i, j), c in form.terms]
    if form.kind == "ogden":
        values = [f"mu = {m:.6g} Pa, alpha = {a:.6g}" for m, a in zip(form.mu, form.alpha, strict=True)]
    elif form.mu:
        values = [f"mu = {form.mu[0]:.6g} Pa"] + ([f"L = {form.locking:.6g}"] if form.locking else [])
    return f"{TITLES[form.kind]}: {', '.join(values)}, K = {form.bulk:.6g} Pa"


def readme(job: Job, target: Target, written: Written, lost: list[str], notes: list[str]) -> str:
    """The text of README.md."""
    out = [f"# {job.name} for {target.title}", "", SIGNATURE, ""]
    out += [f"- `{p.name}`: {what}" for p, what in written.files.items()]
    if written.run:
        out += ["", f"Run the beam: `{written.run}`"]
    form = job.form
    out += ["", "## Material", ""]
    out += [f"{constants(form)}.", ""]
    out.append(
        f"Shear modulus {form.shear_modulus:.6g} Pa, Young's modulus {form.young:.6g} Pa, Poisson's ratio"
        f" {form.poisson:.6g}, density {job.material.density:.6g} kg/m3."
    )
    kept = [part.title for field, part in parts.of(job.material).items() if field in job.keeps]
    if kept:
        out += ["", f"With {', '.join(kept)}."]
    out += ["", "## What is lost", ""]
    out += [f"- {s}" for s in lost] or ["- Nothing of the law and its parts."]
    out += [f"- {r[0].upper()}{r[1:]}." for r in written.remarks]
    scene = scene_lines(job, target)
    if scene:
        out += ["", "## The beam", ""] + [f"- {s}" for s in scene]
    if notes:
        out += ["", "## The card", ""] + [f"- {n[0].upper()}{n[1:]}." for n in notes]
    return "\n".join([*out, ""])
