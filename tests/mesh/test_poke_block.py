"""Blocks meshed for an indentation: volumes, conformity, positive elements, fixed nodes, errors."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from poke_cases import assert_good, assert_matching_facets, gauss_jacobians, random_poke

from tisim.bodies import Block, BoxInclusion, CylinderInclusion, Rod, SphereInclusion
from tisim.discretisation.quadrature import reference
from tisim.mesh._elements import HEX_EDGES
from tisim.mesh._mesh import MeshError
from tisim.mesh.indentation import poke_mesh

BLOCK, ROD = Block(), Rod()
DOWN, TILTED = (0.0, 0.0, -1.0), (0.6, 0.37, -0.709)
VOLUME = 0.1 * 0.1 * 0.032
LOW = (0.0, 0.0, -0.02)
BOX = BoxInclusion(size=(0.020, 0.020, 0.015), centre=(0.008, 0.004, 0.0075), angle=0.4)
SPHERE = SphereInclusion(radius=0.010, centre=(-0.01, 0.0, 0.010))
CYLINDER = CylinderInclusion(radius=0.008, height=0.012, centre=(0.0, -0.012, 0.006))
INCLUSIONS = [BOX, SPHERE, CYLINDER]


def linear(**arguments):
    return poke_mesh(**({"kind": "hex8"} | arguments))


def quad_areas(mesh, facets):
    x = mesh.nodes[facets]
    return 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])


@pytest.mark.parametrize("site", [(0.0, 0.0), (0.030, 0.030), (-0.030, 0.012)])
@pytest.mark.parametrize("direction", [DOWN, TILTED])
@pytest.mark.parametrize(("kind", "some"), [("hex8", 3500), ("hex20", 2930)])
def test_plain_block_has_its_volume_and_some_nodes(kind, some, site, direction):
    mesh = poke_mesh(block=BLOCK, site=site, direction=direction, rod=ROD, kind=kind)
    assert mesh.n_nodes == pytest.approx(some, rel=0.13)
    assert gauss_jacobians(mesh).min() > 0
    assert gauss_jacobians(mesh).sum() == pytest.approx(VOLUME, rel=1e-12)
    assert_matching_facets(mesh)
    assert (mesh.nodes[mesh.node_sets["base"], 2] == 0.0).all()
    assert (mesh.nodes[:, 2] == 0.0).sum() == len(mesh.node_sets["base"])
    corners = {(x, y) for x in (-0.05, 0.05) for y in (-0.05, 0.05)}
    assert corners <= {tuple(p) for p in mesh.nodes[mesh.node_sets["top"], :2].tolist()}


@pytest.mark.parametrize("inclusion", [None, *INCLUSIONS])
def test_top_facets_cover_the_top_and_face_up(inclusion):
    mesh = linear(block=Block(inclusion=inclusion), site=(0.004, -0.003), rod=ROD)
    normals = quad_areas(mesh, mesh.facet_sets["top"])
    assert (normals[:, 2] > 0).all()
    assert normals.sum(axis=0) == pytest.approx([0, 0, 0.01], abs=1e-14)
    assert set(np.unique(mesh.facet_sets["top"])) == set(mesh.node_sets["top"].tolist())
    assert (mesh.nodes[mesh.node_sets["top"], 2] == 0.032).all()


def test_the_fine_zone_covers_the_ellipse_in_which_a_tilted_rod_cuts_the_surface():
    direction = (np.sqrt(0.5), 0.0, -np.sqrt(0.5))
    mesh = linear(block=BLOCK, site=(0.01, -0.01), direction=direction, rod=ROD)
    top = mesh.nodes[mesh.facet_sets["top"]][..., :2] - [0.01, -0.01]
    centre, length = top.mean(axis=1), np.linalg.norm(np.roll(top, -1, axis=1) - top, axis=-1)
    radius = np.hypot(centre[:, 0] / np.sqrt(2), centre[:, 1])
    rim = np.abs(radius - ROD.radius) < 0.6e-3
    assert rim.sum() == 40
    # radial spacing 0.5 mm, stretched along the tilt; 20 cells around the rim
    assert length[rim].min(axis=1).max() < 0.75e-3
    assert length[rim].max() < 1.38e-3
    # a ring of nodes lies on the ellipse
    x, y = (mesh.nodes[mesh.node_sets["top"], :2] - [0.01, -0.01]).T
    assert (np.abs(np.hypot(x / np.sqrt(2), y) - ROD.radius) < 1e-9).sum() == 20


def test_layers_are_tall_at_the_top_and_grow_downwards():
    for refinement in (1.0, 1.5):
        mesh = linear(block=BLOCK, site=(0.0, 0.0), rod=ROD, refinement=refinement)
        steps = np.diff(np.unique(mesh.nodes[:, 2]))
        assert steps.min() >= 0.0012 - 1e-12
        assert (np.diff(steps) < 0).all()
        assert steps.max() < 0.0065 / refinement


def test_refinement_scales_all_spacings():
    nodes = [linear(block=BLOCK, site=(0.0, 0.0), rod=ROD, refinement=r).n_nodes for r in (0.7, 1.0, 1.5)]
    assert nodes[0] < 0.5 * nodes[1]
    assert 9_000 < nodes[2] < 13_000


@pytest.mark.parametrize("inclusion", INCLUSIONS)
@pytest.mark.parametrize("site", [(0.008, 0.004), (-0.03, 0.03), (0.018, 0.0)])
@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_inclusions_are_met(inclusion, site, kind):
    block = Block(inclusion=inclusion)
    mesh = poke_mesh(block=block, site=site, direction=TILTED, rod=ROD, kind=kind)
    assert_good(mesh, block)
    assert_matching_facets(mesh)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 2**32 - 1))
@example(10632)
@example(358610562)
def test_any_poke_gets_a_good_mesh(seed):
    case = random_poke(np.random.default_rng(seed))
    mesh = linear(**case, rod=ROD)
    assert_good(mesh, case["block"])
    # a large sphere leaves little height above it for layers; in the plane nothing is coarser than without it
    plain = linear(block=BLOCK, site=(0.0, 0.0), rod=ROD)
    assert len(mesh.node_sets["top"]) >= len(plain.node_sets["top"])
    assert mesh.n_nodes < 16_000


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32 - 1))
@example(243)  # a cylinder of which straight chords would lose over 5 % of the volume
@example(647)  # a box that needs more rays
@example(1027)  # a shallow cap that the first grid cuts in half
def test_any_poke_gets_a_good_quadratic_mesh(seed):
    case = random_poke(np.random.default_rng(seed))
    mesh = poke_mesh(**case, rod=ROD)
    assert mesh.kind == "hex20"
    assert_good(mesh, case["block"])
    assert_matching_facets(mesh)
    assert (reference(mesh).weights > 0.0).all()
    # an edge is straight unless both of its ends are fixed on the inclusion
    ends = mesh.elements[:, HEX_EDGES]
    free = ~np.isin(ends, mesh.node_sets["base"]).all(axis=2)
    off = mesh.nodes[mesh.elements[:, 8:]][free] - mesh.nodes[ends].mean(axis=2)[free]
    assert np.abs(off).max() <= 1e-12


@pytest.mark.parametrize(
    ("radius", "centre", "site", "direction"),
    [
        # few rays pass through a sphere that is far from the rod
        (0.013404, (0.023035, 0.022812, 0.013404), (-0.004659, -0.024789), (0.24541, 0.0113, -0.96935)),
        (0.013075, (-0.026485, -0.010567, 0.013075), (-0.00241, -0.024562), (0.13402, -0.27871, -0.95098)),
        # of a cap that has its plan area, the facets kept 64 % of the volume
        (0.004706, (-0.016799, 0.023426, 0.0), (0.02555, -0.020647), (0.06525, 0.07138, -0.99531)),
    ],
    ids=["far", "far and beside", "cap"],
)
def test_a_sphere_far_from_the_rod_is_met_by_linear_elements(radius, centre, site, direction):
    block = Block(inclusion=SphereInclusion(radius=radius, centre=centre))
    assert_good(linear(block=block, site=site, direction=direction, rod=ROD), block)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_1320_random_pokes_all_get_good_meshes(kind):
    rng = np.random.default_rng(20260)
    for k in range(1320):
        case = random_poke(rng)
        mesh = poke_mesh(**case, rod=ROD, kind=kind)
        assert_good(mesh, case["block"])
        if k % 20 == 0:
            assert_matching_facets(mesh)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["tet4", "tet10"]))
@example(236, "tet4")
def test_tetrahedra_fill_the_same_body(seed, kind):
    case = random_poke(np.random.default_rng(seed))
    mesh = poke_mesh(**case, rod=ROD, kind=kind)
    whole = linear(**case, rod=ROD)
    assert mesh.kind == kind
    assert gauss_jacobians(mesh).sum() == pytest.approx(gauss_jacobians(whole).sum(), rel=0.01)
    if kind == "tet4":
        # the plane grid may differ: the grid that is valid at the quadrature points depends on the element
        # type
        assert_good(mesh, case["block"])
    assert_matching_facets(mesh)
    top = mesh.facet_sets["top"]
    assert (mesh.nodes[top, 2] == 0.032).all()


def test_a_floating_box_has_soft_material_below_it():
    box = BoxInclusion(size=(0.016, 0.016, 0.010), centre=(0.0, 0.0, 0.011), angle=0.2)
    mesh = linear(block=Block(inclusion=box), site=(0.002, 0.001), rod=ROD)
    assert_good(mesh, Block(inclusion=box))
    middle = mesh.nodes[mesh.elements].mean(axis=1)
    assert (np.hypot(middle[:, 0], middle[:, 1]) < 0.006)[middle[:, 2] < 0.006].any()


def test_an_inclusion_far_from_the_rod_is_not_lost():
    cylinder = CylinderInclusion(radius=0.004, height=0.008, centre=(0.042, 0.042, 0.004))
    mesh = linear(block=Block(inclusion=cylinder), site=(-0.03, -0.03), rod=ROD)
    assert_good(mesh, Block(inclusion=cylinder))
    held = mesh.nodes[mesh.node_sets["base"]]
    assert (held[:, 2] == 0.008).sum() >= 8


def test_the_top_under_the_rod_is_the_same_with_and_without_an_inclusion_deep_below():
    cylinder = CylinderInclusion(radius=0.004, height=0.008, centre=(0.001, 0.0, 0.004))
    tops = []
    for inclusion in (None, cylinder):
        mesh = linear(block=Block(inclusion=inclusion), site=(0.0, 0.0), rod=ROD)
        top = mesh.nodes[mesh.node_sets["top"]]
        near = top[np.hypot(top[:, 0], top[:, 1]) < 0.0035 + 1e-9, :2]
        tops.append({tuple(p) for p in np.round(near * 1e6).tolist()})
    assert len(tops[0]) > 120
    assert tops[0] == tops[1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"site": (0.049, 0.0)}, r"poke site \(0.049, 0.0\): expected two coordinates"),
        ({"site": (0.0, float("nan"))}, "poke site"),
        ({"site": (0.0, 0.0, 0.0)}, "poke site"),
        ({"direction": (1.0, 0.0, -0.5)}, "63 degrees from straight down; at most 45"),
        ({"direction": (0.0, 0.0, 0.0)}, "poke direction: expected three finite numbers"),
        ({"refinement": 0.0}, "refinement: expected 0.5 to 6, got 0.0"),
        ({"kind": "tet20"}, "expected kind hex20, hex8, tet4 or tet10, got 'tet20'"),
        ({"rod": Rod(radius=-1.0)}, "rod radius: expected a length above 0"),
        ({"block": Block(size=(0.1, 0.1, 0.0))}, "block size: expected three lengths above 0"),
    ],
)
def test_what_cannot_be_meshed_is_said_in_one_sentence(change, words):
    arguments = {"block": BLOCK, "site": (0.0, 0.0), "rod": ROD} | change
    with pytest.raises(MeshError, match=words):
        poke_mesh(**arguments)


@pytest.mark.parametrize(
    ("inclusion", "words"),
    [
        (SphereInclusion(radius=0.016, centre=(0, 0, 0.0155)), "leaves less than 1 mm of soft material"),
        (SphereInclusion(radius=0.0, centre=(0, 0, 0)), "sphere radius: expected a length above 0"),
        (SphereInclusion(radius=0.01, centre=LOW), "the sphere lies below the block's base"),
        (SphereInclusion(radius=0.01, centre=(0.045, 0, 0)), "within 1 mm of the block's side"),
        (BoxInclusion(size=(0.01, 0.01, 0.01), centre=LOW), "at or below the block's base"),
        (BoxInclusion(size=(0.01, float("nan"), 0.01), centre=LOW), "box size: expected 3 finite numbers"),
        (CylinderInclusion(radius=0.01, height=-1, centre=LOW), "cylinder height: expected a length above 0"),
        (
            CylinderInclusion(radius=0.01, height=0.01, centre=(0, 0)),
            "cylinder centre: expected 3 finite numbers",
        ),
    ],
)
def test_an_inclusion_that_cannot_be_met_is_refused(inclusion, words):
    with pytest.raises(MeshError, match=words):
        linear(block=Block(inclusion=inclusion), site=(0.0, 0.0), rod=ROD)


@pytest.mark.parametrize(
    ("site", "direction"),
    [
        ((0.02572594163975595, -0.028353964550106834), (-0.231, -0.643, -0.731)),
        ((0.0179226492638343, -0.01884594549249195), (-0.467, -0.248, -0.849)),
    ],
)
def test_tetrahedra_of_hexahedra_above_a_dome_stay_upright(site, direction):
    """For this sphere the first grid gives a hexahedron that is valid at its own quadrature points only.

    One of its tetrahedra, over which the solver integrates too, is inverted.
    """
    centre = (-0.005932481361387259, 0.0033707093804314415, 0.009)
    block = Block(inclusion=SphereInclusion(radius=0.011, centre=centre))
    mesh = linear(block=block, site=site, direction=direction, rod=ROD)
    assert (reference(mesh).weights >= 0.0).all()
    assert_good(mesh, block)
