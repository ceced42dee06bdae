"""Loads, supports, sections, elements and user meshes of static beams; invariance under rotation."""

import numpy as np
import pytest
from static_cases import deflection, neo_hookean

from tisim.bodies import Circle, Rectangle
from tisim.material import Material
from tisim.mesh import Mesh
from tisim.mesh.beam import beam_mesh
from tisim.mesh.refine import to_quadratic
from tisim.problems.beam.solve import solve_beam
from tisim.problems.beam.system import beam_discretisation
from tisim.scene import Beam, Solver
from tisim.simulate import simulate

SOFT = neo_hookean(2e4, 100.0)
EXACT = Solver(tolerance=1e-9)
WEIGHT = 1000.0 * 9.81 * np.pi * 0.01**2
QUARTER = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # y to z, z to -y


@pytest.mark.parametrize("element", ["default", "tet4", "tet10", "hex8"])
@pytest.mark.parametrize(("supports", "length"), [("clamped-free", 0.1), ("clamped-clamped", 0.15)])
def test_support_force_is_the_weight(element, supports, length):
    result = solve_beam(Beam(material=SOFT, length=length, supports=supports, element=element))
    assert result.ok
    assert result.mesh.kind == ("tet10" if element == "default" else element)
    weight = WEIGHT * length
    # laterally, the two grips of a bridge pull in opposite directions
    assert result.support_force[0] == pytest.approx([0, 0, weight], abs=1e-6 * weight)
    assert result.residual[0] <= Solver().tolerance
    assert result.min_jacobian[0] > 0.5
    assert result.load.tolist() == [1.0]


def test_linear_elements_come_near_as_the_mesh_gets_finer():
    """tet4, the paper's element, converges but locks; hex8 has an element pressure and does not lock."""
    scene = Beam(material=neo_hookean(4e4, 1000.0), length=0.05)
    right = deflection(solve_beam(scene))[2]
    errors = {}
    for element, rings in (("tet4", 2), ("tet4", 4), ("hex8", 2), ("hex8", 4)):
        finer = Beam(
            material=scene.material,
            length=0.05,
            element=element,
            radial_elements=rings,
            axial_element_size=0.014 / rings,
        )
        errors[element, rings] = 1 - deflection(solve_beam(finer))[2] / right
    assert 0.5 < errors["tet4", 4] < errors["tet4", 2] < 0.75
    assert abs(errors["hex8", 4]) < 0.03
    assert abs(errors["hex8", 4]) < abs(errors["hex8", 2]) < 0.10


def test_load_sideways_is_the_load_down_turned():
    """Half a beam under gravity along z and a whole one along y agree: the mesh has a square's symmetry."""
    down = solve_beam(Beam(material=SOFT, length=0.1))
    aside = solve_beam(Beam(material=SOFT, length=0.1, gravity=(0.0, -9.81, 0.0)))
    assert down.mesh.symmetry == ("y",)
    assert aside.mesh.symmetry == ()
    a, b = deflection(down), deflection(aside)
    assert [b[0], b[1]] == pytest.approx([a[0], a[2]], rel=2e-3)
    assert abs(b[2]) < 1e-3 * abs(b[1])
    assert aside.support_force[0] == pytest.approx([0, WEIGHT * 0.1, 0], abs=1e-6)


def test_half_a_beam_moves_as_the_whole():
    half = solve_beam(Beam(material=SOFT, length=0.05, solver=EXACT))
    mesh = beam_mesh(length=0.05, section=Circle(radius=0.01))
    whole = solve_beam(Beam(material=SOFT, length=0.05, mesh=mesh, solver=EXACT))
    rest = {tuple(np.round(p, 9)): q for p, q in zip(mesh.nodes, whole.positions[0], strict=True)}
    other = np.array([rest[tuple(np.round(p, 9))] for p in half.mesh.nodes])
    assert np.abs(other - half.positions[0]).max() < 1e-7
    assert whole.support_force[0] == pytest.approx(half.support_force[0], abs=1e-8)


@pytest.mark.parametrize("kind", ["tet10", "hex8", "tet4"])
def test_turned_scene_gives_the_turned_answer(kind):
    mesh = beam_mesh(length=0.06, section=Rectangle(width=0.012, height=0.02), kind=kind)
    turned = Mesh(
        kind=kind,
        nodes=mesh.nodes @ QUARTER.T,
        elements=mesh.elements,
        node_sets=mesh.node_sets,
        facet_sets=mesh.facet_sets,
    )
    force = np.array([1e-3, 2e-3, -4e-3])
    gravity = np.array([1.0, -3.0, -9.0])
    common = {"material": SOFT, "length": 0.06, "solver": EXACT}
    one = solve_beam(
        Beam(mesh=mesh, section=Rectangle(width=0.012, height=0.02), gravity=tuple(gravity),
             tip_force=tuple(force), **common)
    )  # fmt: skip
    two = solve_beam(
        Beam(mesh=turned, section=Rectangle(width=0.02, height=0.012), gravity=tuple(QUARTER @ gravity),
             tip_force=tuple(QUARTER @ force), **common)
    )  # fmt: skip
    assert one.ok
    assert two.ok
    assert np.ptp(one.positions[0] - mesh.nodes) > 1e-3
    assert np.abs(two.positions[0] - one.positions[0] @ QUARTER.T).max() < 1e-9
    assert two.support_force[0] == pytest.approx(QUARTER @ one.support_force[0], abs=1e-8)
    assert one.support_force[0] == pytest.approx(-force - gravity * 1000 * 0.012 * 0.02 * 0.06, abs=1e-8)


@pytest.mark.parametrize("sign", [1, -1])
def test_beam_along_gravity_stretches_or_shortens_as_a_bar(sign):
    section, length, mu = Circle(radius=0.003), 0.1, 4e5  # at 1e5 the beam in compression buckles
    result = solve_beam(
        Beam(material=neo_hookean(mu, 20.0), length=length, section=section, gravity=(sign * 9.81, 0, 0))
    )
    young = 9 * 20 / 61 * mu
    assert deflection(result)[0] == pytest.approx(sign * 1000 * 9.81 * length**2 / 2 / young, rel=0.01)
    assert np.abs(deflection(result)[1:]).max() < 1e-6
    assert result.support_force[0] == pytest.approx([-sign * WEIGHT * 0.09 * 0.1, 0, 0], abs=1e-7)


def test_rectangle_is_stiffer_on_edge_by_the_square_of_its_sides():
    small = Material(law="ogden", parameters={"mu": 1e5, "alpha": 4.0, "bulk": 1e7})
    flat = Beam(
        material=small, length=0.2, section=Rectangle(width=0.012, height=0.006), gravity=(0, 0, 0),
        tip_force=(0.0, 0.0, -2e-4),
    )  # fmt: skip
    edge = Beam(
        material=small, length=0.2, section=Rectangle(width=0.006, height=0.012), gravity=(0, 0, 0),
        tip_force=(0.0, 0.0, -2e-4),
    )  # fmt: skip
    a, b = deflection(solve_beam(flat))[2], deflection(solve_beam(edge))[2]
    young = 9 * 100 / 301 * 2e5
    assert a == pytest.approx(-2e-4 * 0.2**3 / 3 / young / (0.012 * 0.006**3 / 12), rel=0.01)
    assert a / b == pytest.approx(4.0, rel=0.015)


def test_own_unstructured_mesh_of_the_same_beam():
    """A beam mesh of perturbed, renumbered tetrahedra gives the same deflection."""
    section = Rectangle(width=0.016, height=0.016)
    plain = beam_mesh(length=0.05, section=section, kind="tet4", radial_elements=2, axial_element_size=0.005)
    rng = np.random.default_rng(4)
    x = plain.nodes.copy()
    inside = (np.abs(x[:, 1:]).max(axis=1) < 0.0079) & (x[:, 0] > 1e-6) & (x[:, 0] < 0.05 - 1e-6)
    x[inside] += rng.uniform(-5e-4, 5e-4, (inside.sum(), 3))
    order = rng.permutation(len(x))
    place = np.argsort(order)
    mesh = to_quadratic(
        Mesh(
            kind="tet4",
            nodes=x[order],
            elements=place[rng.permutation(plain.elements)],
            node_sets={name: place[nodes].astype(np.int32) for name, nodes in plain.node_sets.items()},
            facet_sets={name: place[facets].astype(np.int32) for name, facets in plain.facet_sets.items()},
        )
    )
    tip = (0.0, 0.01, -0.02)
    own = solve_beam(Beam(material=SOFT, length=0.05, section=section, mesh=mesh, tip_force=tip))
    ours = solve_beam(Beam(material=SOFT, length=0.05, section=section, tip_force=tip))
    assert deflection(own) == pytest.approx(deflection(ours), abs=0.01 * np.abs(deflection(ours)).max())
    weight = 1000 * 9.81 * 0.016**2 * 0.05
    assert own.support_force[0] == pytest.approx([0, -0.01, weight + 0.02], abs=1e-6)


@pytest.mark.parametrize("with_grips", [False, True])
def test_length_of_an_own_mesh_is_how_far_it_reaches_from_its_clamp(with_grips):
    section = Circle(radius=0.01)
    mesh = beam_mesh(length=0.05, section=section, with_grips=with_grips)
    turned = Mesh(
        kind="tet10", nodes=mesh.nodes[:, [2, 0, 1]], elements=mesh.elements, node_sets=mesh.node_sets
    )
    for own in (mesh, turned):
        assert Beam(material=SOFT, mesh=own).length == pytest.approx(0.05)
    assert Beam(material=SOFT, mesh=mesh, length=0.04).length == 0.04
    bridge = beam_mesh(length=0.12, section=section, supports="clamped-clamped", with_grips=with_grips)
    assert Beam(material=SOFT, mesh=bridge, supports="clamped-clamped").length == pytest.approx(0.12)
    with pytest.raises(TypeError, match="expected length"):
        Beam(material=SOFT)


def test_scene_that_cannot_be_built_says_why():
    mesh = beam_mesh(length=0.05, section=Circle(radius=0.01))
    bare = Mesh(kind="tet10", nodes=mesh.nodes, elements=mesh.elements)
    with pytest.raises(ValueError, match="expected a node set 'clamp'"):
        solve_beam(Beam(material=SOFT, length=0.05, mesh=bare))
    with pytest.raises(ValueError, match="mesh: expected a node set 'clamp'"):
        simulate(Beam(material=SOFT, mesh=bare))
    with pytest.raises(ValueError, match="mesh: expected Mesh"):
        simulate(Beam(material=SOFT, mesh="finger.stl"))
    bridge = Beam(material=SOFT, length=0.05, supports="clamped-clamped", tip_force=(0, 0, 1.0))
    with pytest.raises(ValueError, match="a tip force needs a free end"):
        solve_beam(bridge)


def test_candidates_on_one_mesh_share_its_layout():
    one, two = Beam(material=SOFT, length=0.07), Beam(material=neo_hookean(1e4, 20), length=0.07)
    assert beam_discretisation(one) is beam_discretisation(two)
    assert beam_discretisation(one) is not beam_discretisation(Beam(material=SOFT, length=0.08))


def test_what_is_in_a_grip_does_not_change_the_beam():
    """Whatever its length, and whether it is meshed: the default mesh begins at the grip's face."""
    short, long = (Beam(material=SOFT, length=0.05, grip_length=g) for g in (0.005, 0.04))
    mesh = beam_mesh(length=0.05, section=short.section, grip_length=0.04, with_grips=True)
    one, other, meshed = map(solve_beam, (short, long, Beam(material=SOFT, mesh=mesh)))
    assert one.mesh.nodes[:, 0].min() == 0.0
    np.testing.assert_array_equal(one.positions, other.positions)
    assert meshed.mesh.nodes[:, 0].min() == -0.04
    assert deflection(meshed)[2] == pytest.approx(deflection(one)[2], rel=1e-4)
