"""Linear hexahedra under an indenter: energy of their tetrahedra; shifted solves of their Newton steps."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

import tisim
from tisim.discretisation.body import Discretisation
from tisim.discretisation.quadrature import (
    LARGEST_PART,
    TETRAHEDRAL_PART,
    Reference,
    TetrahedralParts,
    reference,
)
from tisim.mesh import ElementKind, Mesh
from tisim.mesh.indentation import poke_mesh
from tisim.problems.indentation.system import PokeSystem


def block_mesh(kind: ElementKind = "hex8") -> Mesh:
    return poke_mesh(block=tisim.Block(), site=(0.0, 0.0), rod=tisim.Rod(), refinement=0.5, kind=kind)


def part(ref: Reference) -> np.ndarray:
    """Fraction of each hexahedron's volume, and so of its energy, that is integrated at its tetrahedra."""
    return np.asarray(ref.weights[:, 1:].sum(axis=1) / ref.weights.sum(axis=1))


def test_parts_rise_where_a_hexahedron_is_bent_only_and_stay() -> None:
    mesh = block_mesh()
    ref = reference(mesh)
    volume = ref.weights.sum(axis=1)
    parts = TetrahedralParts(mesh, ref)
    assert part(ref) == pytest.approx(TETRAHEDRAL_PART)
    squeezed = mesh.nodes @ np.array([[1.6, 0.5, 0.0], [0.0, 1.2, 0.3], [0.0, 0.0, 0.4]])
    parts.update(squeezed)  # deformed, but all tetrahedra equally
    assert part(ref) == pytest.approx(TETRAHEDRAL_PART)

    element = int(np.argmax(mesh.nodes[mesh.elements][:, :, 2].mean(axis=1)))
    bent = mesh.nodes.copy()
    node = mesh.elements[element, 0]
    bent[node] += 0.55 * (mesh.nodes[mesh.elements[element, 6]] - bent[node])  # towards the far corner
    parts.update(bent)
    touched = (mesh.elements == node).any(axis=1)
    assert part(ref)[element] == pytest.approx(LARGEST_PART)
    assert part(ref)[~touched] == pytest.approx(TETRAHEDRAL_PART)
    assert ref.weights.sum(axis=1) == pytest.approx(volume, rel=1e-12)
    before = ref.weights.copy()
    parts.update(mesh.nodes)
    assert np.array_equal(ref.weights, before)


def system() -> tuple[PokeSystem, np.ndarray]:
    scene = tisim.Poke(
        material=tisim.material_from_moduli("ogden", shear_modulus=30e3, bulk_modulus=600e3),
        depth=0.001,
        refinement=0.5,
    )
    mesh = block_mesh("hex20")
    it = PokeSystem(scene, Discretisation.build(mesh, mesh.node_sets["base"]))
    it.move_to(0.0003)
    x = mesh.nodes.copy()
    it.touch(x)
    return it, x


def test_the_residual_is_the_same_with_and_without_its_tangent() -> None:
    it, x = system()
    cheap, load = it.residual(x)
    report = it.report.copy()
    full, same = it.linearise(x)
    assert load == pytest.approx(same, rel=1e-12)
    assert it.report == pytest.approx(report, rel=1e-12)
    assert np.abs(full - cheap).max() < 1e-9 * np.abs(full).max()
    assert it.residual_norm(x) == pytest.approx(float(np.linalg.norm(full)), rel=1e-9)


def test_a_shift_shortens_the_step_and_fades() -> None:
    it, x = system()
    residual, _ = it.linearise(x)
    plain = np.abs(it.step(residual, forcing=1e-6)).max()
    it.linear.stiffen()
    it.linear.stiffen()
    held = np.abs(it.step(residual, forcing=1e-6)).max()
    assert held < 0.98 * plain
    for _ in range(3):
        it.linear.relax()
    assert np.abs(it.step(residual, forcing=1e-6)).max() == pytest.approx(plain, rel=1e-3)


def test_a_layout_is_left_as_it_was() -> None:
    """Pokes that share a discretisation are independent of each other's distortions."""
    scene = tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        depth=0.001,
    )
    mesh = block_mesh()
    discretisation = Discretisation.build(mesh, mesh.node_sets["base"])
    before = discretisation.reference.weights.copy()
    it = PokeSystem(scene, discretisation)
    bent = mesh.nodes.copy()
    bent[:, 2] -= 0.008 * np.exp(-1e5 * (bent[:, :2] ** 2).sum(axis=1)) * (bent[:, 2] / 0.032) ** 8
    it.accept(bent)
    assert np.abs(it.discretisation.reference.weights / before - 1.0).max() > 0.1
    assert np.array_equal(discretisation.reference.weights, before)
    # the weights keep the largest distortion while the indenter advances, and follow it during retraction
    it.accept(mesh.nodes)
    assert np.abs(it.discretisation.reference.weights / before - 1.0).max() > 0.1
    it.turn(-1.0)
    it.accept(mesh.nodes)
    assert it.discretisation.reference.weights / before == pytest.approx(1.0, rel=1e-9)


def test_overlap_is_looked_for_between_the_points_of_contact_too() -> None:
    """The middle of a facet overlaps the indenter's edge while its contact points stay on the surface."""
    it, x = system()
    assert it.overlap(x) == pytest.approx(0.3e-3, rel=0.05)  # the depth of the indenter
    facet = it.facets[np.argmin(np.linalg.norm(x[it.facets].mean(axis=1) - it.tip, axis=1))]
    bulged = x.copy()
    bulged[facet, 2] += 1e-3 * np.array([-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])
    it.residual(bulged)
    assert it.overlap(bulged) > -float(it.report[3]) + 1e-5


def test_a_quadratic_poke_is_written_as_quadratic(tmp_path: Path) -> None:
    scene = tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        depth=0.0005,
        refinement=0.5,
    )
    result = tisim.simulate(scene)
    read = meshio.read(tisim.write(result, tmp_path / "poke.vtu"))
    (cells,) = read.cells
    assert cells.type == "hexahedron20"
    assert read.points == pytest.approx(result.positions[-1])
    skin = tisim.write(result, tmp_path / "poke.ply")
    assert trimesh.load_mesh(skin).is_watertight
