"""NVIDIA Newton 1.8: material.json (arguments of ModelBuilder.add_soft_mesh), and beam.py with beam.msh.

SolverVBD's volumetric energy is the stable neo-Hookean one by Lame's parameters k_mu and k_lambda (it adds
k_mu to k_lambda itself, as Smith et al. 2018 do), tisim's law `stable-neo-hookean`, on linear tetrahedra.
SolverSemiImplicit has another energy of the same two numbers. Block descent stops short of equilibrium: a
beam bends too far unless steps are small and iterations many (docs/how-to/export.md).
"""

from __future__ import annotations

import json
import runpy
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.export._forms import Form
from calibration.export._gmsh import write_msh
from calibration.export._job import Job, Target, Written
from tisim import Material

DAMPING = 100.0  # [Pa s]: with twenty times as much, block descent goes on far beyond equilibrium
SCENE = '''"""{title}

Run it by: python beam.py   (needs newton and meshio; README.md says what is lost on the way from tisim)
Units: m, kg, s, Pa.
"""

from pathlib import Path

import meshio
import newton
import numpy as np
import warp as wp

FOLDER = Path(__file__).resolve().parent
DENSITY, K_MU, K_LAMBDA = {density}, {mu}, {lam}
K_DAMP = {damp}  # Pa s: only brings the scene to rest, it is not the card's
GRAVITY = {gravity}
CLAMPED = {clamped}
END = {end}  # where the displacement is printed
LOADED = {loaded}
FORCES = {forces}
STEP, ITERATIONS = 1.0 / 5000.0, 50  # block descent: with larger steps it stops short of equilibrium
LONGEST, STILL = 1.0, 1e-3  # s; part of its way that the end still moves in 0.05 s


def build():
    mesh = meshio.read(FOLDER / "beam.msh", file_format="gmsh")
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=GRAVITY)
    builder.add_soft_mesh(
        pos=wp.vec3(0.0, 0.0, 0.0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0.0, 0.0, 0.0),
        vertices=[wp.vec3(*p) for p in mesh.points], indices=mesh.cells[0].data.ravel().tolist(),
        density=DENSITY, k_mu=K_MU, k_lambda=K_LAMBDA, k_damp=K_DAMP,
    )
    for n in CLAMPED:
        builder.particle_mass[n] = 0.0
        builder.particle_flags[n] = int(builder.particle_flags[n]) & ~int(newton.ParticleFlags.ACTIVE)
    builder.color()
    return builder.finalize()


def main():
    """Displacement of all nodes, and whether the beam has come to rest."""
    model = build()
    solver = newton.solvers.SolverVBD(model, iterations=ITERATIONS)
    now, then, control = model.state(), model.state(), model.control()
    rest = now.particle_q.numpy().copy()  # on the CPU it is the state itself
    pull = np.zeros_like(rest)
    if LOADED:
        pull[LOADED] = FORCES
    end = np.zeros(3)
    for k in range(round(LONGEST / STEP)):
        now.clear_forces()
        now.particle_f.assign(pull)
        solver.step(now, then, control, None, STEP)
        now, then = then, now
        if (k + 1) % 250 == 0:
            before, end = end, (now.particle_q.numpy() - rest)[END].mean(axis=0)
            print(f"{{(k + 1) * STEP:.3f}} s: the end has moved by {{1e3 * end}} mm", flush=True)
            if np.linalg.norm(end - before) < STILL * np.linalg.norm(end):
                return now.particle_q.numpy() - rest, True
    return now.particle_q.numpy() - rest, False


if __name__ == "__main__":
    main()
'''


def writes(form: Form, material: Material) -> Form | None:  # noqa: ARG001 - one signature for all targets
    return form if form.kind == "stable-neo-hookean" else None


def write(job: Job, folder: Path) -> Written:
    form, density = job.form, job.material.density
    material = folder / "material.json"
    content = {"density": density, "k_mu": form.mu[0], "k_lambda": form.lam, "k_damp": 0.0}
    material.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    files = {material: "arguments of ModelBuilder.add_soft_mesh (SI)"}
    remarks = [
        "SolverSemiImplicit and SolverXPBD take other energies of the same numbers: use SolverVBD",
        "SolverVBD stops short of equilibrium where steps are large or iterations few: the beam then bends"
        " too far",
    ]
    if job.scene is None:
        return Written(files=files, remarks=tuple(remarks))
    scene = job.scene
    beam = folder / "beam.py"
    beam.write_text(
        SCENE.format(
            title=job.docstring,
            density=f"{density:.10g}", mu=f"{form.mu[0]:.10g}", lam=f"{form.lam:.10g}",
            damp=DAMPING,
            gravity=tuple(float(g) for g in scene.beam.gravity), clamped=[int(n) for n in scene.held],
            end=[int(n) for n in scene.watched], loaded=scene.loaded_nodes.tolist(),
            forces=[[float(x) for x in scene.forces[n]] for n in scene.loaded_nodes],
        ),
        encoding="utf-8",
    )  # fmt: skip
    mesh = write_msh(scene.mesh, folder / "beam.msh")
    files |= {beam: "the beam, ready to run", mesh: "its mesh (Gmsh 2.2)"}
    return Written(files=files, run="python beam.py", remarks=tuple(remarks))


def check(folder: Path) -> NDArray[np.float64]:
    for package in ("newton", "meshio"):
        if find_spec(package) is None:
            raise InputError(f"--check: {package} is not installed: pip install newton meshio")
    moved, still = runpy.run_path(str(folder / "beam.py"))["main"]()
    if not still:
        raise InputError("--check: Newton's beam still oscillates after 1 s: too soft for the damping")
    return np.asarray(moved, dtype=float)


TARGET = Target(
    name="newton",
    title="NVIDIA Newton 1.8",
    writes=writes,
    keeps=lambda *_: set(),
    write=write,
    element="tet4",
    most_poisson=0.45,
    check=check,
)
