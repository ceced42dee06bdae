"""Stress at nodes against forces, and the history of materials that remember: `python -m benchmarks.fields`.

Seconds. Traction of the stress smoothed to nodes over a clamp's face and over a bonded platen, as a part of
the force there, which the stresses at the points of integration carry to rounding; and the moment in the
clamp of a viscous beam that hangs, by stresses whose history is followed from frame to frame, as a part of
its weight's.
"""

from __future__ import annotations

import argparse

import numpy as np

import tisim
from tisim.discretisation.body import gravity_load
from tisim.discretisation.quadrature import facet_quadrature
from tisim.mesh import boundary_facets
from tisim.problems import kind_of

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=20e3, bulk_modulus=400e3)
SLOW = tisim.Material(
    law="neo-hookean",
    parameters={"mu": 20e3, "lam": 1e6},
    viscosity=tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0)),
)


def traction(result: tisim.Result, name: str) -> np.ndarray:
    """Resultant [N], shape (3,), of the nodal first Piola-Kirchhoff stress over the facets of a node set."""
    mesh = result.mesh
    surface = boundary_facets(mesh.kind, mesh.elements)
    face = surface[np.isin(surface, mesh.node_sets[name]).all(axis=1)]
    shape, slope, weight = facet_quadrature(face.shape[1])
    u, v = np.moveaxis(np.einsum("fai,qad->fqdi", mesh.nodes[face], slope), 2, 0)
    stress = tisim.fields(result).nodes.first_piola[face]
    return np.einsum("qa,faij,fqj->i", shape, stress, np.cross(u, v) * weight[:, None])


def clamp(size: float) -> float:
    """Traction over force across a cantilever's clamp, its elements so long [m]."""
    result = tisim.simulate(tisim.Beam(material=SOFT, length=0.056, axial_element_size=size))
    return 2.0 * float(traction(result, "clamp")[2]) / float(result.support_force[-1, 2])


def platen() -> float:
    """Traction over force of a bonded platen at 20 % of compression."""
    result = tisim.simulate(tisim.Press(material=SOFT, radius=0.025, height=0.030, stretches=(0.8,)))
    assert result.nominal_stress is not None
    force = float(result.nominal_stress[-1]) * np.pi * 0.025**2
    return 4.0 * float(traction(result, "top")[2]) / force


def history(frames: tuple[float, ...]) -> float:
    """Moment of the stresses in the clamp over that of the weight, at the last of these times [s]."""
    course = tisim.Course(frames=frames).jump(1.0).hold(60.0)
    scene = tisim.Beam(material=SLOW, length=0.05, radial_elements=1, course=course)
    result = tisim.simulate(scene)
    held, forces = result.mesh.node_sets["clamp"], tisim.fields(result).node_forces
    weight = gravity_load(kind_of(scene).discretise(result, -1), SLOW.density, scene.gravity)[:, 2]
    inside = result.mesh.nodes[held, 2] @ forces[held, 0]
    return float(inside / (weight @ result.positions[-1][:, 0]))


def main() -> None:
    for size in (0.007, 0.0035):
        print(f"clamp, elements of {1e3 * size:g} mm: traction {clamp(size):.3f} of the force")
    print(f"platen: traction {platen():.3f} of the force")
    for frames in ((0.0, 60.0), (0.0, 1.0, 5.0, 20.0, 60.0)):
        print(f"viscous beam, {len(frames)} frames: moment {history(frames):.5f} of the weight's")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
