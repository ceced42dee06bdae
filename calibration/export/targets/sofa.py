"""SOFA 25.12 and newer: material.json, and beam.py (a SofaPython3 scene) with beam.msh, linear tetrahedra.

TetrahedronHyperelasticityFEMForceField has tisim's StVenantKirchhoff, NeoHookean and StableNeoHookean ("mu
lambda"), MooneyRivlin ("C10 C01 K"), Ogden of one term ("mu1 alpha K", mu1 is alpha times tisim's) and
ArrudaBoyce ("mu K", its locking stretch always the root of 8): the docstrings of `tisim.laws` have their
energies.
"""

from __future__ import annotations

import json
from pathlib import Path

from calibration.export._forms import Form
from calibration.export._gmsh import write_msh
from calibration.export._job import Job, Target, Written
from tisim import Material
from tisim.laws.arruda_boyce import SOFA_LOCKING

_COUPLED = {
    "neo-hookean": "NeoHookean",
    "stable-neo-hookean": "StableNeoHookean",
    "st-venant-kirchhoff": "StVenantKirchhoff",
}

SCENE = '''"""{title}

Run it by: runSofa -l SofaPython3 beam.py Units: m, kg, s, Pa. It moves, damped, until it hangs still:
README.md says what is lost on the way from tisim.
"""

from pathlib import Path

FOLDER = Path(__file__).resolve().parent
PLUGINS = (
    "Constraint.Projective", "IO.Mesh", "LinearSolver.Direct", "Mass", "MechanicalLoad",
    "ODESolver.Backward",
    "SolidMechanics.FEM.HyperElastic", "StateContainer", "Topology.Container.Dynamic", "Visual",
)
CLAMPED = {clamped}
LOADED = {loaded}
FORCES = {forces}


def createScene(root):
    root.gravity = {gravity}
    root.dt = 0.01
    for plugin in PLUGINS:
        root.addObject("RequiredPlugin", name="Sofa.Component." + plugin)
    root.addObject("DefaultAnimationLoop")
    root.addObject("VisualStyle", displayFlags="showBehaviorModels showForceFields")
    root.addObject("MeshGmshLoader", name="loader", filename=str(FOLDER / "beam.msh"))
    beam = root.addChild("beam")
    beam.addObject("EulerImplicitSolver", rayleighStiffness=0.1, rayleighMass=0.1)
    beam.addObject("SparseLDLSolver", template="CompressedRowSparseMatrixMat3x3d")
    beam.addObject("TetrahedronSetTopologyContainer", name="topology", src="@../loader")
    beam.addObject("TetrahedronSetGeometryAlgorithms", template="Vec3")
    beam.addObject("MechanicalObject", name="state", template="Vec3", src="@../loader")
    beam.addObject("MeshMatrixMass", topology="@topology", massDensity={density})
    beam.addObject(
        "TetrahedronHyperelasticityFEMForceField",
        name="FEM", topology="@topology", materialName="{law}", ParameterSet="{parameters}",
    )
    beam.addObject("FixedProjectiveConstraint", indices=CLAMPED)
    if LOADED:
        beam.addObject("ConstantForceField", indices=LOADED, forces=FORCES)
    return root
'''


def writes(form: Form, material: Material) -> Form | None:  # noqa: ARG001 - one signature for all targets
    if form.kind == "ogden":
        return form if len(form.mu) == 1 else None
    if form.kind == "arruda-boyce":
        return form if abs(form.locking / SOFA_LOCKING - 1.0) < 1e-6 else None
    if form.kind == "polynomial":
        return form if {ij for ij, _ in form.terms} <= {(1, 0), (0, 1)} else None
    return form


def parameter_set(form: Form) -> tuple[str, list[float]]:
    """materialName and ParameterSet."""
    if form.kind == "ogden":
        return "Ogden", [form.mu[0] * form.alpha[0], form.alpha[0], form.bulk]
    if form.kind == "arruda-boyce":
        return "ArrudaBoyce", [form.mu[0], form.bulk]
    if form.kind == "polynomial":
        terms = dict(form.terms)
        return "MooneyRivlin", [terms.get((1, 0), 0.0), terms.get((0, 1), 0.0), form.bulk]
    return _COUPLED[form.kind], [form.mu[0], form.lam]


def write(job: Job, folder: Path) -> Written:
    law, values = parameter_set(job.form)
    text = " ".join(f"{x:.10g}" for x in values)
    material = folder / "material.json"
    content = {"materialName": law, "ParameterSet": text, "massDensity": job.material.density}
    material.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    files = {material: "the force field's materialName and ParameterSet, and the density (SI)"}
    remarks = ["not run by tisim's tests, which have no SOFA: components as its sources of 2026 have them"]
    if job.scene is None:
        return Written(files=files, remarks=tuple(remarks))
    scene = job.scene
    beam = folder / "beam.py"
    beam.write_text(
        SCENE.format(
            title=job.docstring,
            clamped=[int(n) for n in scene.held],
            loaded=scene.loaded_nodes.tolist(),
            forces=[[float(x) for x in scene.forces[n]] for n in scene.loaded_nodes],
            gravity=[float(g) for g in scene.beam.gravity],
            density=f"{job.material.density:.10g}",
            law=law,
            parameters=text,
        ),
        encoding="utf-8",
    )
    mesh = write_msh(scene.mesh, folder / "beam.msh")
    files |= {beam: "the beam as a SofaPython3 scene", mesh: "its mesh (Gmsh 2.2)"}
    remarks.append(
        "the scene's Rayleigh damping (0.1 s, 0.1 /s) only brings it to rest: it is not the card's"
    )
    return Written(files=files, run="runSofa -l SofaPython3 beam.py", remarks=tuple(remarks))


TARGET = Target(
    name="sofa",
    title="SOFA 25.12 and newer",
    writes=writes,
    keeps=lambda *_: set(),
    write=write,
    element="tet4",
    most_poisson=0.45,
)
