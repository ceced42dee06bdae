"""Stress, strain and energy of results: closed forms, equilibrium, mirror images, output files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from static_cases import awkward, body_of, boundary

import tisim
from tisim.discretisation.body import Discretisation, DiscretisedBody, gravity_load
from tisim.discretisation.quadrature import facet_quadrature
from tisim.fields import fields_at, unfold_quantities
from tisim.laws import evaluate
from tisim.mesh import boundary_facets, unfold
from tisim.problems import kind_of
from tisim.problems.beam.system import beam_discretisation

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=20e3, bulk_modulus=400e3)
F = np.array([[1.15, 0.25, -0.1], [0.05, 0.9, 0.2], [-0.12, 0.08, 1.05]])


@pytest.fixture(scope="module")
def beam() -> tisim.Result:
    return tisim.simulate(tisim.Beam(material=SOFT, length=0.05, radial_elements=2, tip_force=(0.01, 0, 0)))


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8", "hex20"])
def test_an_affine_motion_has_the_laws_stress_everywhere(kind: str) -> None:
    mesh = awkward(kind)
    body = body_of(mesh, "neo-hookean", boundary(mesh))
    psi, P, _ = (v[0] for v in evaluate("neo-hookean", body.material.parameters, F[None]))
    found = fields_at(body, mesh.nodes @ F.T)
    for at in (found.elements, found.nodes):
        size = np.abs(P).max()
        np.testing.assert_allclose(at.first_piola, np.broadcast_to(P, at.first_piola.shape), atol=1e-8 * size)
        cauchy = P @ F.T / np.linalg.det(F)
        np.testing.assert_allclose(at.cauchy, np.broadcast_to(cauchy, at.cauchy.shape), atol=1e-8 * size)
        strain = 0.5 * (F.T @ F - np.eye(3))
        np.testing.assert_allclose(at.green_lagrange, np.broadcast_to(strain, at.cauchy.shape), atol=1e-9)
        np.testing.assert_allclose(at.energy_density, psi, rtol=1e-9)
        stretches = np.linalg.svd(F, compute_uv=False)
        np.testing.assert_allclose(at.principal_stretches, np.tile(stretches, (len(at.cauchy), 1)), atol=1e-9)
    volume = body.discretisation.nodal_volume().sum()
    assert found.energy == pytest.approx(psi * volume, rel=1e-9)


def test_uniaxial_stretch_and_simple_shear_are_the_closed_forms() -> None:
    """Neo-Hookean: sigma = (mu (b - I) + lam ln J I)/J."""
    mu, lam = SOFT.parameters["mu"], SOFT.parameters["lam"]
    pulled, sheared = tisim.simulate(
        [
            tisim.Coupon(material=SOFT, stretches=(1.5,)),
            tisim.Coupon(material=SOFT, mode="simple-shear", stretches=(1.4,)),
        ]
    )
    at = tisim.fields(pulled).nodes
    thin = float(pulled.positions[-1][:, 1].max() / pulled.mesh.nodes[:, 1].max())
    J = 1.5 * thin**2
    assert at.cauchy[:, 0, 0] == pytest.approx((mu * (1.5**2 - 1.0) + lam * np.log(J)) / J, rel=1e-9)
    assert at.first_piola[:, 0, 0] == pytest.approx(pulled.nominal_stress[-1], rel=1e-6)
    assert np.abs(at.cauchy[:, 1:, 1:]).max() < 1e-4 * at.cauchy[0, 0, 0], "free sides"
    assert at.von_mises == pytest.approx(at.cauchy[:, 0, 0], rel=1e-4)
    at = tisim.fields(sheared).elements
    assert at.cauchy[:, 0, 2] == pytest.approx(0.4 * mu, rel=1e-9)
    assert at.cauchy[:, 0, 0] - at.cauchy[:, 2, 2] == pytest.approx(0.4**2 * mu, rel=1e-9)
    assert at.energy_density == pytest.approx(0.5 * mu * 0.4**2, rel=1e-9)


def test_stresses_carry_the_supports_force(beam: tisim.Result) -> None:
    """Nodal forces agree to rounding; the smoothed traction as well as the singular clamp edge allows."""
    found, mesh = tisim.fields(beam), beam.mesh
    clamp = mesh.node_sets["clamp"]
    force = 2.0 * found.node_forces[clamp].sum(axis=0) * [1.0, 0.0, 1.0]
    dead = gravity_load(beam_discretisation(beam.scene), SOFT.density, beam.scene.gravity)
    weight = 2.0 * dead[clamp].sum(axis=0)
    assert force - weight == pytest.approx(beam.support_force[0], abs=1e-12)
    surface = boundary_facets(mesh.kind, mesh.elements)
    face = surface[np.isin(surface, clamp).all(axis=1)]
    traction = 2.0 * integral_over(mesh, face, found.nodes.first_piola)
    assert traction[2] == pytest.approx(force[2], rel=0.15)
    assert traction[0] == pytest.approx(force[0], abs=0.02 * abs(force[2]))


@pytest.mark.parametrize("element", ["hex20", "hex8"])
def test_the_base_of_a_poke_carries_what_the_rod_pushes(element: tisim.scene.ElementChoice) -> None:
    """Holds with additional volumetric stiffness at some points and weights that follow the distortion."""
    scene = tisim.Poke(material=SOFT, depth=1e-3, retract_to=5e-4, frame_spacing=5e-4, refinement=0.5)
    poke = tisim.simulate(replace(scene, element=element))
    assert len(poke.load) == 3
    for found in tisim.fields_of_frames(poke):
        base = found.node_forces[poke.mesh.node_sets["base"]].sum(axis=0)
        size = np.abs(poke.support_force[found.frame]).max()
        assert base == pytest.approx(poke.support_force[found.frame], abs=1e-9 * size)
        assert found.nodes.pressure.max() > 0.0
    assert found.energy < tisim.fields(poke, 1).energy


def integral_over(mesh: tisim.Mesh, facets: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Integral (3,) over facets of nodal tensors applied to the facets' area vectors."""
    n, dn, w = facet_quadrature(facets.shape[1])
    tangents = np.einsum("fai,qad->fqdi", mesh.nodes[facets], dn)
    area = np.cross(tangents[:, :, 0], tangents[:, :, 1]) * w[:, None]
    return np.einsum("qa,faij,fqj->i", n, values[facets], area)


def test_a_mirrored_half_has_the_fields_of_the_whole(beam: tisim.Result) -> None:
    half = tisim.fields(beam)
    mesh, x = unfold(beam.mesh, beam.positions[-1])
    whole = fields_at(body_like(beam, mesh), x)
    for nodes in (False, True):
        of_half = unfold_quantities(beam.mesh, half.nodes if nodes else half.elements, nodes=nodes)
        of_whole = whole.nodes if nodes else whole.elements
        size = np.abs(of_whole.cauchy).max()
        np.testing.assert_allclose(of_half.cauchy, of_whole.cauchy, atol=1e-9 * size)
        np.testing.assert_allclose(of_half.energy_density, of_whole.energy_density, rtol=1e-6, atol=1e-9)
    assert half.energy == pytest.approx(whole.energy, rel=1e-12)


def test_a_material_that_remembers_has_the_stress_of_its_history() -> None:
    """The history is integrated from frame to frame, so its accuracy depends on the spacing of frames."""
    slow = replace(SOFT, viscosity=tisim.Prony(fractions=(0.5,), times=(2.0,)))
    frames = tuple(np.concatenate([np.linspace(0.1, 1.0, 10), 1.0 + np.geomspace(0.1, 4.0, 12)]))
    course = tisim.Course(start=1.0, frames=frames).ramp(to=1.3, duration=1.0).hold(4.0)
    pulled = tisim.simulate(tisim.Coupon(material=slow, course=course))
    assert pulled.dissipated is not None
    for frame in (9, -1):
        found = tisim.fields(pulled, frame)
        assert found.elements.first_piola[:, 0, 0] == pytest.approx(pulled.nominal_stress[frame], rel=5e-3)
    assert list(tisim.fields_of_frames(pulled))[-1].energy == pytest.approx(found.energy, rel=1e-12)
    at_once = tisim.fields(pulled, 9).elements.first_piola[0, 0, 0]
    assert found.elements.first_piola[0, 0, 0] < 0.9 * at_once, "it relaxes"
    length = np.concatenate([[0.01], pulled.positions[:, -1, 0]])
    force = np.concatenate([[0.0], 1e-4 * pulled.nominal_stress])
    work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(length)))
    assert found.energy + pulled.dissipated[-1] == pytest.approx(work, rel=1e-2)


def test_an_uneven_beam_has_the_stiffness_of_its_points() -> None:
    scene = tisim.Beam(
        material=SOFT,
        length=0.03,
        axial_element_size=0.01,
        radial_elements=1,
        imperfections=tisim.Imperfections(axial_gradient=20.0, curvature=1.0),
    )
    result = tisim.simulate(scene)
    found = tisim.fields(result)
    load = gravity_load(kind_of(scene).discretise(result, 0), SOFT.density, scene.gravity)
    free = np.setdiff1d(np.arange(result.mesh.n_nodes), result.mesh.node_sets["clamp"])
    left = (found.node_forces - load)[free]
    left[np.isin(free, result.mesh.node_sets["mirror_y"]), 1] = 0.0
    assert np.abs(left).max() < 1e-5 * np.abs(found.node_forces).max()


def test_files_hold_the_fields(beam: tisim.Result, tmp_path: Path) -> None:
    read = meshio.read(tisim.write(beam, tmp_path / "beam.vtu"))
    found, n, m = tisim.fields(beam), beam.mesh.n_nodes, beam.mesh.n_elements
    for name, attribute in tisim.export.FIELDS.items():
        at_nodes, by_element = read.point_data[name], read.cell_data[name][0]
        assert len(at_nodes) == len(read.points)
        wanted = getattr(found.nodes, attribute)
        assert at_nodes[:n] == pytest.approx(wanted.reshape(at_nodes[:n].shape))
        wanted = getattr(found.elements, attribute)
        assert by_element[:m] == pytest.approx(wanted.reshape(by_element[:m].shape))


def test_a_series_holds_all_frames(tmp_path: Path) -> None:
    coupon = tisim.simulate(tisim.Coupon(material=SOFT, stretches=(1.1, 1.2)))
    path = tisim.write(coupon, tmp_path / "pull.pvd")
    assert path.read_text().count("<DataSet timestep=") == 2
    assert {p.name for p in (tmp_path / "pull").iterdir()} == {"pull-000.vtu", "pull-001.vtu"}
    second = meshio.read(tmp_path / "pull" / "pull-001.vtu")
    assert second.points == pytest.approx(coupon.positions[1])


def body_like(result: tisim.Result, mesh: tisim.Mesh) -> DiscretisedBody:
    return DiscretisedBody(Discretisation.build(mesh, mesh.node_sets["clamp"]), result.scene.material)


def test_the_energy_of_a_softened_material_is_what_it_gives_back() -> None:
    """Work = stored + dissipated, at the largest stretch, on the way back and at rest again."""
    softened = replace(
        tisim.material_from_moduli("neo-hookean", shear_modulus=2e4, bulk_modulus=2e6),
        softening=tisim.OgdenRoxburgh(r=2.0, m=2e3, beta=0.1),
    )
    path = np.concatenate([np.linspace(1.0, 1.5, 71), np.linspace(1.5, 1.0, 71)[1:]])
    found = tisim.simulate(tisim.Coupon(material=softened, stretches=tuple(path)))
    assert found.nominal_stress is not None
    assert found.dissipated is not None
    mean = 0.5 * (found.nominal_stress[1:] + found.nominal_stress[:-1])
    volume = float(np.ptp(found.mesh.nodes[:, 0])) ** 3
    work = volume * np.concatenate([[0.0], np.cumsum(mean * np.diff(path))])
    for k in (0, 35, 70, 105, 140):
        stored = tisim.fields(found, k).energy
        assert stored == pytest.approx(work[k] - found.dissipated[k], abs=2e-4 * work[70])
