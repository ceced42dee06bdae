"""Local refinement, smoothing and quadratic elements preserve shape, sets and conformity."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_checks import assert_conforming, assert_positive, facet_set

from tisim.bodies import Circle, Rectangle
from tisim.mesh._elements import TET_EDGES
from tisim.mesh._mesh import Mesh, MeshError, boundary_facets, with_facet_set, with_node_set
from tisim.mesh.beam import beam_mesh
from tisim.mesh.quality import nodal_determinants, quality, smooth
from tisim.mesh.refine import refine, refine_around, to_quadratic

CENTRE = (0.025, 0.0, 0.01)


@pytest.fixture(scope="module")
def block():
    mesh = beam_mesh(
        length=0.05,
        section=Rectangle(width=0.04, height=0.02),
        kind="tet4",
        axial_element_size=0.01,
        grading=(1.0,),
    )
    mesh = with_facet_set(mesh, "top", lambda x: x[:, 2] > 0.01 - 1e-9)
    return with_node_set(mesh, "base", lambda x: x[:, 2] < -0.01 + 1e-9)


def longest_edges(mesh):
    x = mesh.nodes[mesh.elements[:, TET_EDGES]]
    return np.linalg.norm(x[:, :, 0] - x[:, :, 1], axis=-1), x.mean(axis=2)


@pytest.mark.parametrize("smoothing", [0, 3])
def test_refined_to_the_size_asked_for_and_nowhere_else(block, smoothing):
    fine = refine_around(
        block, centre=CENTRE, radius=0.004, edge_length=0.0015, growth=0.7, smoothing=smoothing
    )
    assert_conforming(fine)
    assert_positive(fine)
    length, middle = longest_edges(fine)
    away = np.linalg.norm(middle - np.array(CENTRE), axis=-1)
    wanted = 0.0015 + 0.7 * np.maximum(away - 0.004, 0)
    assert (length <= wanted * (1.0 + 1e-9 if not smoothing else 1.5)).all()
    far = np.linalg.norm(fine.nodes - np.array(CENTRE), axis=1) > 0.015
    assert far.sum() < 0.35 * fine.n_nodes
    assert quality(fine).volume == pytest.approx(quality(block).volume, rel=1e-12)
    assert quality(fine).min_scaled_jacobian > 0.5 * quality(block).min_scaled_jacobian


def test_refined_mesh_keeps_its_sets(block):
    fine = refine_around(block, centre=CENTRE, radius=0.004, edge_length=0.0015)
    assert fine.n_nodes > 2 * block.n_nodes
    boundary = facet_set(boundary_facets("tet4", fine.elements))
    assert facet_set(fine.facet_sets["surface"]) == boundary
    x = fine.nodes
    for name, inside in (
        ("clamp", x[:, 0] == 0),
        ("tip", x[:, 0] == 0.05),
        ("base", x[:, 2] < -0.01 + 1e-9),
    ):
        assert sorted(fine.node_sets[name]) == np.flatnonzero(inside).tolist()
    assert facet_set(fine.facet_sets["top"]) == {f for f in boundary if (x[list(f), 2] > 0.01 - 1e-9).all()}
    corner = x[fine.facet_sets["top"]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert (normal[:, 2] > 0).all()
    assert normal[:, 2].sum() / 2 == pytest.approx(0.04 * 0.05)


def test_refining_again_and_again_does_not_spoil_the_angles(block):
    least = []
    for edge in (0.004, 0.002, 0.001):
        fine = refine_around(block, centre=CENTRE, radius=0.002, edge_length=edge, growth=1.0, smoothing=0)
        least.append(quality(fine).min_scaled_jacobian)
    # 0.24 at every level; 0.15 if the longest edges are not bisected too
    assert min(least) > 0.2


@given(seed=st.integers(0, 10_000), h=st.floats(0.15, 0.6))
@settings(max_examples=15, deadline=None)
def test_conforming_on_irregular_meshes_and_any_size(seed, h):
    rng = np.random.default_rng(seed)
    mesh = beam_mesh(
        length=2.0,
        section=Rectangle(width=1.0, height=1.0),
        kind="tet4",
        axial_element_size=0.7,
        radial_elements=1,
    )
    mesh = Mesh(
        kind="tet4", nodes=mesh.nodes + rng.uniform(-0.05, 0.05, mesh.nodes.shape), elements=mesh.elements
    )
    point = rng.uniform(-0.5, 1.5, 3)
    fine = refine(mesh, size=lambda x: h + 0.5 * np.linalg.norm(x - point, axis=1))
    assert_conforming(fine)
    assert quality(fine).volume == pytest.approx(quality(mesh).volume, rel=1e-10)
    assert quality(fine).min_scaled_jacobian > 0


def test_edge_through_the_body_does_not_pass_its_set_on(block):
    """Two adjacent faces are fixed: the midpoint of an edge from one to the other is free."""

    def held(x):
        return (x[:, 0] == 0) | (x[:, 2] < -0.01 + 1e-9)

    mesh = with_node_set(block, "held", held)
    for finer in (refine(mesh, size=lambda x: np.full(len(x), 0.006)), to_quadratic(mesh)):
        # at the sides all nodes of a facet in the corner are fixed, so that its midpoints are fixed too
        inner = np.abs(finer.nodes[:, 1]) < 0.02 - 1e-9
        member = np.isin(np.arange(finer.n_nodes), finer.node_sets["held"])
        assert (member == held(finer.nodes))[inner].all()


def test_gripped_volume_passes_its_set_on():
    mesh = beam_mesh(length=0.05, section=Circle(radius=0.01), kind="tet4", with_grips=True)
    for finer in (refine(mesh, size=lambda x: np.full(len(x), 0.006)), to_quadratic(mesh)):
        assert sorted(finer.node_sets["clamp"]) == np.flatnonzero(finer.nodes[:, 0] <= 0).tolist()


def test_smoothing_betters_the_mesh_and_leaves_the_boundary(block):
    rng = np.random.default_rng(3)
    inner = np.ones(block.n_nodes, dtype=bool)
    inner[boundary_facets("tet4", block.elements)] = False
    nodes = block.nodes + inner[:, None] * rng.uniform(-0.0015, 0.0015, block.nodes.shape)
    rough = Mesh(kind="tet4", nodes=nodes, elements=block.elements)
    better = smooth(rough, rounds=5)
    assert quality(better).min_scaled_jacobian > 1.2 * quality(rough).min_scaled_jacobian
    assert np.array_equal(better.nodes[~inner], rough.nodes[~inner])
    assert not np.array_equal(better.nodes[inner], rough.nodes[inner])


def test_quadratic_mesh_follows_the_true_surface():
    """A coarse 12-gon of linear tetrahedra projected onto its circle gains the missing volume."""
    linear = beam_mesh(length=0.05, section=Circle(radius=0.01), kind="tet4")
    radius = np.linalg.norm(linear.nodes[:, 1:], axis=1).max()

    def onto_circle(x):
        r = np.linalg.norm(x[:, 1:], axis=1)
        side = r > 0.9 * radius
        return np.where(side[:, None], x * np.stack([r / r, radius / r, radius / r], axis=1), x)

    straight = to_quadratic(linear)
    curved = to_quadratic(linear, project=onto_circle)
    for mesh in (straight, curved):
        assert_conforming(mesh)
        assert_positive(mesh)
        assert facet_set(mesh.facet_sets["surface"]) == facet_set(boundary_facets("tet10", mesh.elements))
        assert sorted(mesh.node_sets["tip"]) == np.flatnonzero(mesh.nodes[:, 0] == 0.05).tolist()
    assert quality(straight).volume == pytest.approx(quality(linear).volume, rel=1e-12)
    assert quality(curved).volume == pytest.approx(np.pi * radius**2 * 0.05, rel=3e-4)


def test_projection_that_would_turn_elements_over_is_taken_back(block):
    wild = to_quadratic(block, project=lambda x: x * 3.0)
    straight = nodal_determinants(block).mean(axis=1)
    assert (nodal_determinants(wild).min(axis=1) > 0.099 * straight).all()
    mild = to_quadratic(block, project=lambda x: x * 1.01)
    assert not np.allclose(mild.nodes, to_quadratic(block).nodes, atol=1e-5)


def test_an_edge_keeps_the_part_of_its_curve_that_leaves_its_element_sound(block):
    def bulge(x):  # grows outwards, so that some edges can follow and some cannot
        return x * (1.0 + 0.9 * (x[:, :1] / np.abs(block.nodes[:, 0]).max()) ** 2)

    straight, wild = to_quadratic(block), to_quadratic(block, project=bulge)
    n = block.n_nodes
    asked, got = bulge(straight.nodes[n:]) - straight.nodes[n:], wild.nodes[n:] - straight.nodes[n:]
    kept = np.linalg.norm(got, axis=1) / np.linalg.norm(asked, axis=1).clip(1e-9)
    assert (nodal_determinants(wild).min(axis=1) > 0.099 * nodal_determinants(straight).mean(axis=1)).all()
    assert {0.25, 0.5, 0.75} & set(np.round(kept, 6))


def test_wrong_kinds_and_endless_refinement_are_refused(block):
    quadratic = to_quadratic(block)
    for action in (to_quadratic, smooth, lambda m: refine(m, size=lambda x: x[:, 0])):
        with pytest.raises(MeshError, match="only a tet4"):
            action(quadratic)
    with pytest.raises(MeshError, match="went past 500 nodes"):
        refine(block, size=lambda x: np.full(len(x), 0.001), max_nodes=500)
    with pytest.raises(MeshError, match="positive edge length"):
        refine_around(block, centre=CENTRE, radius=0.01, edge_length=0.0)


def test_sets_by_place_and_their_errors(block):
    assert block.nodes[block.node_sets["base"], 2].max() == pytest.approx(-0.01)
    with pytest.raises(MeshError, match="'none' would be empty: no node"):
        with_node_set(block, "none", lambda x: x[:, 0] > 1)
    with pytest.raises(MeshError, match="'none' would be empty: no boundary facet"):
        with_facet_set(block, "none", np.zeros(block.n_nodes, dtype=bool))
    with pytest.raises(MeshError, match="booleans, one a node"):
        with_node_set(block, "bad", np.array([1, 2, 3]))
