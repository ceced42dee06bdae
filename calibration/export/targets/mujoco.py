"""MuJoCo 4: material.xml (the attributes of a flex), and beam.xml, a flex of linear tetrahedra.

A flex of dimension 3 with <elasticity young poisson> is St Venant-Kirchhoff on linear tetrahedra. Each node
is a body with three slides and its own share of the mass: `flexcomp` would give all nodes the same, which is
not the weight of a graded mesh. MuJoCo takes the flex's elasticity implicitly with integrator="discrete"
(from 3.13).
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.export._forms import Form
from calibration.export._gmsh import write_msh
from calibration.export._job import Job, Target, Written
from tisim import Material, read

DAMPING = 0.01  # s; brings the scene to rest
STEP = 0.002  # s
ITERATIONS = 2000  # the usual 100 do not solve for a soft beam's accelerations
STILL = 1e-5  # m/s
MOST_STEPS = 5000


def writes(form: Form, material: Material) -> Form | None:  # noqa: ARG001 - one signature for all targets
    return form if form.kind == "st-venant-kirchhoff" else None


def elasticity(form: Form) -> str:
    return f'<elasticity young="{form.young:.10g}" poisson="{form.poisson:.10g}" damping="{DAMPING:g}"/>'


def write(job: Job, folder: Path) -> Written:
    density = job.material.density
    material = folder / "material.xml"
    name = job.name.replace("--", "- -")
    lines = [f"<!-- {name}: density {density:.10g} kg/m3; a flexcomp's mass is that times its volume. -->"]
    lines.append(elasticity(job.form))
    material.write_text("\n".join([*lines, ""]), encoding="utf-8")
    files = {material: "the element of a flex or flexcomp of dimension 3 (SI)"}
    remarks = [f"damping {DAMPING:g} s only brings the scene to rest: it is not the card's"]
    if job.scene is None:
        return Written(files=files, remarks=tuple(remarks))
    scene = job.scene
    gravity = " ".join(f"{g:.10g}" for g in scene.beam.gravity)
    nodes, mass = np.round(scene.mesh.nodes, 12) + 0.0, scene.mass
    held = np.zeros(len(nodes), dtype=bool)
    held[scene.held] = True
    out = [f"<mujoco model={quoteattr(f'{job.name}: {scene.name}')}>"]
    option = f'timestep="{STEP:g}" integrator="discrete" iterations="{ITERATIONS}" gravity="{gravity}"'
    out += [f"  <option {option}/>", "  <worldbody>"]
    out.append('    <light pos="0 0 1"/>')
    for n in np.flatnonzero(~held):
        place = " ".join(f"{x:.10g}" for x in nodes[n])
        out.append(f'    <body name="n{n}" pos="{place}">')
        small = 1e-9 * mass[n]  # of a point; slides do not turn it
        inertia = f"{small:.6g} {small:.6g} {small:.6g}"
        out.append(f'      <inertial pos="0 0 0" mass="{mass[n]:.10g}" diaginertia="{inertia}"/>')
        out += [f'      <joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")]
        out.append("    </body>")
    bodies = " ".join("world" if h else f"n{n}" for n, h in enumerate(held))
    vertex = " ".join(
        " ".join(f"{x:.10g}" for x in p) if h else "0 0 0" for p, h in zip(nodes, held, strict=True)
    )
    elements = " ".join(map(str, scene.mesh.elements.ravel()))
    out += [
        "  </worldbody>",
        "  <deformable>",
        f'    <flex name="beam" dim="3" radius="0.0005" body="{bodies}"',
    ]
    out += [f'      vertex="{vertex}"', f'      element="{elements}">']
    out += [
        f"      {elasticity(job.form)}",
        '      <contact selfcollide="none" contype="0" conaffinity="0"/>',
    ]
    out += ["    </flex>", "  </deformable>", "</mujoco>"]
    beam = folder / "beam.xml"
    beam.write_text("\n".join([*out, ""]), encoding="utf-8")
    mesh = write_msh(scene.mesh, folder / "beam.msh")
    files |= {beam: "the beam, ready to run", mesh: "its mesh (Gmsh 2.2), for a flexcomp of type gmsh"}
    return Written(files=files, run="python -m mujoco.viewer --mjcf=beam.xml", remarks=tuple(remarks))


def check(folder: Path) -> NDArray[np.float64]:
    try:
        mujoco: Any = import_module("mujoco")  # optional, and not among tisim's extras
    except ModuleNotFoundError:
        raise InputError("--check: mujoco is not installed: pip install mujoco") from None
    model = mujoco.MjModel.from_xml_path(str(folder / "beam.xml"))
    data = mujoco.MjData(model)
    for k in range(MOST_STEPS):
        mujoco.mj_step(model, data)
        if not np.isfinite(data.qpos).all():
            raise InputError("--check: MuJoCo's beam has no finite positions")
        if k > 50 and np.abs(data.qvel).max() < STILL:
            if any(warning.number for warning in data.warning):
                raise InputError("--check: MuJoCo warned that its equations were not solved, or of worse")
            mujoco.mj_forward(model, data)
            return np.asarray(data.flexvert_xpos - read(folder / "beam.msh").nodes)
    raise InputError(f"--check: MuJoCo's beam still moves after {MOST_STEPS} steps of {STEP:g} s")


TARGET = Target(
    name="mujoco",
    title="MuJoCo 4",
    writes=writes,
    keeps=lambda *_: set(),
    write=write,
    element="tet4",
    most_poisson=0.45,
    tip_force=False,
    check=check,
)
