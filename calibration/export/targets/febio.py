"""FEBio 4: material.feb (a Material section), and beam.feb with 10-node tetrahedra.

Its uncoupled materials have tisim's volumetric energy, K/2 (ln J)^2, and its "neo-Hookean" and "isotropic
elastic" are the coupled laws (FEBio Theory Manual, chapter 5): most laws are the same there. Its uncoupled
viscoelastic material relaxes the isochoric stress as tisim's Prony series does, in fractions of the long-time
modulus, six terms at most; "fiber-exp-pow-uncoupled" with beta = 2 is one family of Holzapfel, Gasser and
Ogden. Ogden's sum is c_i/m_i^2 (...), so that c_i is mu_i alpha_i. A body force acts against its vector
(FEElasticSolidDomain::BodyForce).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
from scipy.optimize import nnls

from calibration.export._forms import Form
from calibration.export._job import Job, Target, Written
from calibration.export._response import percent
from calibration.export._scene import BeamScene
from tisim import Material
from tisim.parts import HolzapfelGasserOgden, Spectrum

MOST_TERMS = 6  # of Ogden, Yeoh and the Prony series


def writes(form: Form, material: Material) -> Form | None:
    beside = material.viscosity is not None or isinstance(material.fibres, HolzapfelGasserOgden)
    if form.kind in ("neo-hookean", "st-venant-kirchhoff"):
        return None if beside else form  # what relaxes or has fibres is uncoupled there
    if form.kind == "stable-neo-hookean" or (form.kind == "ogden" and len(form.mu) > MOST_TERMS):
        return None
    return form


def keeps(material: Material, form: Form) -> set[str]:
    if form.kind in ("neo-hookean", "st-venant-kirchhoff"):
        return set()
    found = {"viscosity"} if material.viscosity is not None else set()
    return found | ({"fibres"} if isinstance(material.fibres, HolzapfelGasserOgden) else set())


def fewer(spectrum: Spectrum, terms: int) -> tuple[Spectrum, float]:
    """A spectrum of at most so many terms, and how far its relaxation function is off, a fraction at most.

    Times are spread evenly in their logarithm, strengths are the non-negative least squares over time.
    """
    if len(spectrum.times) <= terms:
        return spectrum, 0.0
    first, last = float(spectrum.times.min()), float(spectrum.times.max())
    times = np.geomspace(first, last, terms)
    at = np.geomspace(0.03 * first, 30.0 * last, 200)
    wanted = np.array([spectrum.modulus(t) for t in at]) - spectrum.equilibrium
    strengths, _ = nnls(np.exp(-at[:, None] / times), wanted)
    found = Spectrum(equilibrium=spectrum.equilibrium, strengths=strengths, times=times)
    off = max(abs(found.modulus(t) / spectrum.modulus(t) - 1.0) for t in [0.0, *at])
    return found, off


def _tags(indent: int, values: Sequence[tuple[str, float]]) -> list[str]:
    return [f"{'  ' * indent}<{name}>{x:.10g}</{name}>" for name, x in values]


def law_tags(form: Form) -> tuple[str, list[tuple[str, float]]]:
    """Type of the material, and its parameters without density."""
    if form.kind in ("neo-hookean", "st-venant-kirchhoff"):
        name = "neo-Hookean" if form.kind == "neo-hookean" else "isotropic elastic"
        return name, [("E", form.young), ("v", form.poisson)]
    bulk = ("k", form.bulk)
    if form.kind == "arruda-boyce":
        return "Arruda-Boyce", [("mu", form.mu[0]), ("N", form.locking**2), bulk]
    if form.kind == "ogden":
        pairs = enumerate(zip(form.mu, form.alpha, strict=True), start=1)
        return "Ogden", [x for i, (m, a) in pairs for x in ((f"c{i}", m * a), (f"m{i}", a))] + [bulk]
    terms = dict(form.terms)
    if all(j == 0 for _, j in terms) and set(terms) != {(1, 0)}:
        return "Yeoh", [*((f"c{i}", c) for (i, _), c in sorted(terms.items())), bulk]
    return "Mooney-Rivlin", [("c1", terms.get((1, 0), 0.0)), ("c2", terms.get((0, 1), 0.0)), bulk]


def material_lines(job: Job) -> tuple[list[str], list[str]]:
    """The <material> element, and remarks."""
    kind, values = law_tags(job.form)
    density = ("density", job.material.density)
    remarks: list[str] = []
    inner: list[str] = []
    close: list[str] = []
    head = f'<material id="1" name="soft" type="{{}}"> <!-- {escape(job.name).replace("--", "- -")}: SI -->'
    level, tag, opened = 3, "material", False

    def open_as(name: str) -> None:
        nonlocal level, opened
        if opened:
            inner.append(f'{"  " * (level - 1)}<{tag} type="{name}">')
        else:
            inner.append("    " + head.format(name))
            opened = True
        inner.extend(_tags(level, [density]))
        close.insert(0, f"{'  ' * (level - 1)}</{tag}>")
        level += 1

    if "viscosity" in job.keeps:
        assert job.material.viscosity is not None
        spectrum, off = fewer(job.material.viscosity.spectrum(), MOST_TERMS)
        open_as("uncoupled viscoelastic")
        shares = (
            spectrum.strengths / spectrum.equilibrium
        )  # of the long-time modulus, which g0 = 1 stands for
        series = [x for i, (g, t) in enumerate(zip(shares, spectrum.times, strict=True), start=1)
                  for x in ((f"g{i}", float(g)), (f"t{i}", float(t)))]  # fmt: skip
        inner.extend(_tags(level - 1, series))
        tag = "elastic"
        if off:
            remarks.append(
                f"the Prony series has {len(job.material.viscosity.spectrum().times)} terms, FEBio takes"
                f" {MOST_TERMS}: as many were fitted, their modulus at most {percent(off)} off at any time"
            )
    if "fibres" in job.keeps:
        fibres = job.material.fibres
        assert isinstance(fibres, HolzapfelGasserOgden)
        open_as("uncoupled solid mixture")
        pad = "  " * (level - 1)
        own = [f'{pad}<solid type="{kind}">', *_tags(level, [density, *values]), f"{pad}</solid>"]
        axis = ",".join(f"{x:.10g}" for x in fibres.axis())
        own += [f'{pad}<solid type="fiber-exp-pow-uncoupled">']
        own += _tags(level, [("ksi", fibres.k1), ("alpha", fibres.k2), ("beta", 2.0)])
        own += [f'{pad}  <fiber type="vector">{axis}</fiber>', f"{pad}</solid>"]
        inner.extend(own)
    else:
        open_as(kind)
        inner.extend(_tags(level - 1, values))
    return [*inner, *close], remarks


def write(job: Job, folder: Path) -> Written:
    lines, remarks = material_lines(job)
    remarks.append(
        "not run by tisim's tests, which have no FEBio: syntax as the User Manual of FEBio 4 has it"
    )
    section = ["  <Material>", *lines, "  </Material>"]
    top = ['<?xml version="1.0" encoding="ISO-8859-1"?>', '<febio_spec version="4.0">']
    material = folder / "material.feb"
    _save(material, [*top, *section, "</febio_spec>"])
    files = {material: "the material: FEBio Studio imports it, or copy its section"}
    if job.scene is None:
        return Written(files=files, remarks=tuple(remarks))
    beam = folder / "beam.feb"
    last = _duration(job)
    _save(beam, [*top, *_before(last), *section, *_after(job.scene, last), "</febio_spec>"])
    return Written(
        files={**files, beam: "the beam, ready to run"}, run="febio4 -i beam.feb", remarks=tuple(remarks)
    )


def _save(path: Path, lines: list[str]) -> None:
    path.write_text("\n".join([*lines, ""]), encoding="latin-1", errors="xmlcharrefreplace")


def _duration(job: Job) -> float:
    """Until what relaxes has relaxed [s]; the load rises over the first half."""
    if "viscosity" not in job.keeps:
        return 1.0
    assert job.material.viscosity is not None
    return 20.0 * float(job.material.viscosity.spectrum().times.max())


def _before(last: float) -> list[str]:
    return [
        '  <Module type="solid"/>',
        "  <Control>",
        "    <analysis>STATIC</analysis>",
        "    <time_steps>20</time_steps>",
        f"    <step_size>{last / 20.0:.10g}</step_size>",
        '    <solver type="solid">',
        '      <qn_method type="BFGS"><max_ups>0</max_ups></qn_method>',
        "    </solver>",
        '    <time_stepper type="default">',
        f"      <dtmin>{last * 1e-5:.10g}</dtmin>",
        f"      <dtmax>{last / 10.0:.10g}</dtmax>",
        "      <max_retries>10</max_retries>",
        "    </time_stepper>",
        "  </Control>",
    ]


def _after(scene: BeamScene, last: float) -> list[str]:
    mesh = scene.mesh
    out = ["  <Mesh>", '    <Nodes name="all">']
    nodes = np.round(mesh.nodes, 12) + 0.0
    out += [f'      <node id="{n}">{",".join(f"{x:.10g}" for x in p)}</node>' for n, p in enumerate(nodes, 1)]
    out += ["    </Nodes>", '    <Elements type="tet10" name="beam">']
    out += [
        f'      <elem id="{e}">{",".join(map(str, c + 1))}</elem>' for e, c in enumerate(mesh.elements, 1)
    ]
    out.append("    </Elements>")
    sets = {"clamp": scene.held, "end": scene.watched}
    loaded = scene.loaded_nodes
    sets.update({f"loaded{n + 1}": np.array([n]) for n in loaded})
    out += [
        f'    <NodeSet name="{k}">{",".join(map(str, np.asarray(s) + 1))}</NodeSet>' for k, s in sets.items()
    ]
    out += ["  </Mesh>", "  <MeshDomains>", '    <SolidDomain name="beam" mat="soft"/>', "  </MeshDomains>"]
    out += ["  <Boundary>", '    <bc name="clamp" node_set="clamp" type="zero displacement">']
    out += [f"      <{k}_dof>1</{k}_dof>" for k in "xyz"]
    # against its vector
    force = ",".join(f"{-g + 0.0:.10g}" for g in scene.beam.gravity)
    out += ["    </bc>", "  </Boundary>", "  <Loads>", '    <body_load type="body force">']
    out += [f'      <force lc="1">{force}</force>', "    </body_load>"]
    for n in loaded:
        value = ",".join(f"{x:.10g}" for x in scene.forces[n])
        out += [f'    <nodal_load name="tip{n + 1}" node_set="loaded{n + 1}" type="nodal_force">']
        out += [f'      <value lc="1">{value}</value>', "    </nodal_load>"]
    out += ["  </Loads>", "  <LoadData>", '    <load_controller id="1" type="loadcurve">']
    out += ["      <interpolate>LINEAR</interpolate>", "      <extend>CONSTANT</extend>"]
    out += [f"      <points><pt>0,0</pt><pt>{last / 2.0:.10g},1</pt></points>", "    </load_controller>"]
    out.append("  </LoadData>")
    out += ["  <Output>", '    <plotfile type="febio">', '      <var type="displacement"/>']
    out += ['      <var type="stress"/>', "    </plotfile>", "    <logfile>"]
    out += [
        '      <node_data data="ux;uy;uz" file="beam_displacements.txt"/>',
        "    </logfile>",
        "  </Output>",
    ]
    return out


TARGET = Target(
    name="febio",
    title="FEBio 4",
    writes=writes,
    keeps=keeps,
    write=write,
    # its tet10 has no pressure of its own, as CalculiX's C3D10
    element_error=0.04,
)
