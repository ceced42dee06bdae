"""Two beams in tisim, CalculiX, FElupe, MuJoCo and Newton: error, time, lines of input; prints two tables.

    python -m benchmarks.comparison                  # all that is installed; 10 minutes of one core
    python -m benchmarks.comparison --only tisim calculix --beam bar

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1. Needs `ccx`, the extra `bench`, and
`pip install mujoco newton meshio warp-lang` for the last two; what is missing is said. SOFA, FEBio and
Abaqus are in no registry.

Beams: the paper's (a cylinder of 10 mm radius, 100 mm long, 1000 kg/m3, G = 40 kPa), and the Dragon Skin
bar of the released-bar measurements (30 x 30 x 100 mm, 1070 kg/m3, G = 85 kPa). One end clamped, under
their weight; Neo-Hookean with K = 100 G where the program has it. Error: displacement at the middle of
the end face against a converged reference, in % of its size; below 0 is too stiff. References: the
paper's beam from references/beams.json (centre of the face), the bar solved here in the same way,
FElupe's mixed Q2/P-1 hexahedra, the last difference of two levels stated. Seconds: of one core, from mesh
to equilibrium. Lines of input: what a user writes, mesh not counted.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any

import numpy as np

import tisim
from benchmarks.accuracy_beams import FILE
from calibration.export._convert import convert
from calibration.export._job import Job, Target
from calibration.export._registry import get
from calibration.export._scene import BeamScene
from tisim.mesh import beam_mesh

Array = np.ndarray[Any, Any]
STRETCHES = (0.7, 1.3)  # over which another law is fitted to Neo-Hookean
TISIM = """\
rubber = tisim.material_from_moduli("neo-hookean", shear_modulus=G, bulk_modulus=100 * G, density=rho)
(result,) = tisim.simulate([tisim.Beam(material=rubber, length=0.1, section=section)])
"""
FELUPE = """\
mesh = fe.Mesh(points, cells, "tetra10")
region = fe.RegionQuadraticTetra(mesh)
field = fe.FieldContainer([fe.Field(region, dim=3)])
solid = fe.SolidBody(fe.NeoHookeCompressible(mu=G, lmbda=98 * G), field)
load = fe.SolidBodyForce(field)
clamp = fe.Boundary(field[0], fx=0)
dof0, dof1 = fe.dof.partition(field, {"clamp": clamp})
for level in np.linspace(0.2, 1.0, 5):
    load.update(rho * level * gravity)
    fe.newtonraphson(items=[solid, load], x0=field, dof0=dof0, dof1=dof1, ext0=np.zeros(len(dof0)))
"""


@dataclass(frozen=True)
class Case:
    """A beam. reference: displacement at the middle of its end face [m], (3,); stated: its own error [%]."""

    name: str
    section: tisim.Circle | tisim.Rectangle
    density: float
    modulus: float
    reference: Array
    stated: float

    @property
    def material(self) -> tisim.Material:
        return tisim.material_from_moduli(
            "neo-hookean", shear_modulus=self.modulus, bulk_modulus=100 * self.modulus, density=self.density
        )

    @property
    def beam(self) -> tisim.Beam:
        return tisim.Beam(material=self.material, length=0.1, section=self.section)


@dataclass(frozen=True)
class Line:
    """Result of one program for a beam. end : displacement at the middle of the end face [m], (3,)."""

    program: str
    how: str
    end: Array
    seconds: float
    lines: int


def paper_beam() -> Case:
    entry = next(
        e
        for e in json.loads(FILE.read_text())["beams"]
        if (e["case"], e["set"], e["G"]) == ("cantilever-100", "neo_hookean-100", 40e3)
    )
    end = np.array([entry["dx"], 0.0, entry["dz"]])
    return Case("the paper's beam", tisim.Circle(radius=0.010), 1000.0, 40e3, end, entry["error_percent"])


def bar() -> Case:
    section = tisim.Rectangle(width=0.030, height=0.030)
    coarse, fine = (bar_reference(level) for level in (1, 2))
    error = 100 * float(np.linalg.norm(fine - coarse) / np.linalg.norm(fine))
    return Case("the Dragon Skin bar", section, 1070.0, 85e3, fine, error)


BEAMS = {"paper": paper_beam, "bar": bar}


def bar_reference(level: int) -> Array:
    """End of the bar by FElupe's Q2/P-1 on half of it (mirror plane y = 0); the centre of the end face."""
    import felupe as fe

    from benchmarks.references.boxes import box, two_sided
    from benchmarks.references.cylinder import graded
    from benchmarks.references.laws import mixed_law
    from benchmarks.references.mixed import MixedModel, mixed_fields

    along = 0.1 * graded(8 * level, 2.5)
    across = np.linspace(0.0, 0.015, 2 * 2 * level + 1)
    up = 0.030 * (two_sided(4 * level, 2.0) - 0.5)
    mesh = box([along, across, up])
    region = fe.RegionTriQuadraticHexahedron(mesh)
    field = mixed_fields(region)
    dof = np.arange(3 * mesh.npoints).reshape(-1, 3)
    fixed = np.concatenate([dof[mesh.points[:, 0] < 1e-9].ravel(), dof[mesh.points[:, 1] < 1e-9, 1]])
    share = np.einsum("aqc,qc->ca", np.broadcast_to(region.h, (27, *region.dV.shape)), region.dV)
    weight = np.zeros((mesh.npoints, 3))
    np.add.at(weight[:, 2], mesh.cells.ravel(), -share.ravel() * 1070.0 * 9.81)
    law = mixed_law("neo_hookean", 100 * 85e3, mu=85e3)
    model = MixedModel(field, law, np.unique(fixed), lambda t: weight.ravel() * t)
    found: list[Array] = []
    centre = int(np.argmin(np.linalg.norm(mesh.points - [0.1, 0, 0], axis=1)))
    if not model.path(0.0, [1.0], lambda _: found.append(field[0].values[centre].copy()), 1.0):
        raise RuntimeError(f"the reference has no equilibrium at level {level}")
    return found[-1]


def centre_of(nodes: Array, displacement: Array) -> Array:
    """Displacement at the centre of the end face."""
    return np.asarray(displacement[np.argmin(np.linalg.norm(nodes - [0.1, 0.0, 0.0], axis=1))])


def ours(case: Case) -> Iterator[Line]:
    tisim.simulate([case.beam])  # kernels are compiled once
    for element, how in (("default", "mixed 10-node tetrahedra"), ("tet4", "4-node tetrahedra")):
        scene = case.beam if element == "default" else replace(case.beam, element="tet4")
        start = time.process_time()
        (result,) = tisim.simulate([scene])
        seconds = time.process_time() - start
        if result.status != "converged":
            raise RuntimeError(f"tisim, {element}: {result.message}")
        end = centre_of(result.mesh.nodes, result.positions[-1] - result.mesh.nodes)
        yield Line("tisim", how, end, seconds, len(TISIM.splitlines()))


def felupe(case: Case) -> Iterator[Line]:
    from benchmarks.peers import felupe_beam

    mesh = quadratic(case)
    law = felupe_beam.material("neo_hookean", 100 * case.modulus, mu=case.modulus)
    found = felupe_beam.solve(mesh.nodes, mesh.elements, law, mesh.node_sets["clamp"], density=case.density)
    if not found.converged:
        raise RuntimeError("FElupe found no equilibrium")
    end = centre_of(mesh.nodes, found.displacement)
    yield Line("FElupe", "10-node tetrahedra", end, found.cpu_seconds, len(FELUPE.splitlines()))


def quadratic(case: Case) -> tisim.Mesh:
    """Mesh of the other programs: whole beam, 10-node tetrahedra, as fine as the exported scenes."""
    return beam_mesh(
        length=0.1, section=case.section, supports="clamped-free", kind="tet10", axial_element_size=0.007,
        radial_elements=2,
    )  # fmt: skip


def exported(name: str, how: str, written: Callable[[Path], int]) -> Callable[[Case], Iterator[Line]]:
    """A program by the scene that `calibration.export` writes for it, and its `--check`."""

    def run(case: Case) -> Iterator[Line]:
        target: Target = get(name)
        assert target.check is not None
        linear = target.element == "tet4"
        mesh = beam_mesh(
            length=0.1, section=case.section, supports="clamped-free", kind=target.element,  # type: ignore[arg-type]
            axial_element_size=0.0058 if linear else 0.007, radial_elements=2,
        )  # fmt: skip
        conversion = convert(
            case.material, lambda form: target.writes(form, case.material), low=STRETCHES[0],
            high=STRETCHES[1], most_loss=1.0, program=name, most_poisson=target.most_poisson,
        )  # fmt: skip
        scene = BeamScene(
            name=case.name, beam=case.beam, mesh=mesh, held=mesh.node_sets["clamp"],
            watched=mesh.node_sets["tip"], forces=np.zeros((mesh.n_nodes, 3)),
        )  # fmt: skip
        job = Job(
            name=case.name, material=case.material, conversion=conversion, keeps=frozenset(), scene=scene
        )
        with tempfile.TemporaryDirectory() as folder:
            target.write(job, Path(folder))
            start = sum(time_used())
            moved = target.check(Path(folder))
            seconds = sum(time_used()) - start
            lines = written(Path(folder))
        end = centre_of(mesh.nodes, moved)
        law = f"{how}, {conversion.form.kind}" + (", nu 0.45" if conversion.poisson else "")
        yield Line(target.title, law, end, seconds, lines)

    return run


def time_used() -> tuple[float, float, float, float]:
    """CPU seconds of this process and of those that it has waited for."""
    from os import times

    used = times()
    return used.user, used.system, used.children_user, used.children_system


def deck_lines(folder: Path) -> int:
    """Lines of a CalculiX deck that are neither nodes, elements nor sets."""
    kept, mesh = 0, False
    for line in (folder / "beam.inp").read_text().splitlines():
        if line.startswith("*"):
            mesh = line.startswith(("*NODE,", "*ELEMENT", "*NSET", "*ELSET")) and "PRINT" not in line
        kept += not mesh
    return kept


def xml_lines(folder: Path) -> int:
    """Lines of a MuJoCo scene but for its points (bodies), with the mesh as one line of a flexcomp."""
    text = (folder / "beam.xml").read_text()
    points = ("<body", "</body", "<inertial", "<joint", "vertex=", "element=")
    return sum(not line.strip().startswith(points) for line in text.splitlines()) + 1


def script_lines(folder: Path) -> int:
    """Lines of the Newton script that say something; numbers of nodes are one line."""
    text = (folder / "beam.py").read_text().split('"""', 2)[2]
    return sum(bool(line.strip()) and not line.strip().startswith("#") for line in text.splitlines())


PROGRAMS: dict[str, tuple[Callable[[], bool], Callable[[Case], Iterator[Line]]]] = {
    "tisim": (lambda: True, ours),
    "felupe": (lambda: find_spec("felupe") is not None, felupe),
    "calculix": (
        lambda: which("ccx") is not None,
        exported("calculix", "10-node tetrahedra (C3D10)", deck_lines),
    ),
    "mujoco": (
        lambda: find_spec("mujoco") is not None,
        exported("mujoco", "4-node tetrahedra", xml_lines),
    ),
    "newton": (
        lambda: find_spec("newton") is not None,
        exported("newton", "4-node tetrahedra", script_lines),
    ),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="*", choices=list(PROGRAMS), default=list(PROGRAMS))
    parser.add_argument("--beam", nargs="*", choices=list(BEAMS), default=list(BEAMS))
    given = parser.parse_args()
    for case in (BEAMS[name]() for name in given.beam):
        size = float(np.linalg.norm(case.reference))
        print(f"\n{case.name}: the end moves by {1e3 * size:.2f} mm, known to {case.stated:.2f} %\n")
        print("| program | elements and law | error % | core-s | of tisim's | lines of input |")
        print("| --- | --- | --- | --- | --- | --- |")
        first: float | None = None
        for name in given.only:
            there, run = PROGRAMS[name]
            if not there():
                print(f"| {name} | not installed | | | | |", flush=True)
                continue
            try:
                for line in run(case):
                    first = line.seconds if first is None else first
                    error = 100 * (float(np.linalg.norm(line.end)) / size - 1.0)
                    ratio = line.seconds / first
                    print(
                        f"| {line.program} | {line.how} | {error:+.2f} | {line.seconds:.2f} | {ratio:.1f} "
                        f"| {line.lines} |",
                        flush=True,
                    )
            except Exception as error:  # a program's failure is its line of the table
                print(f"| {name} | {type(error).__name__}: {str(error)[:120]} | | | | |", flush=True)


if __name__ == "__main__":
    main()
