"""Structured beam meshes: node counts, section, conformity, half models, grips, outline."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_checks import assert_conforming, assert_positive, facet_set

from tisim.bodies import Circle, Rectangle
from tisim.mesh._elements import NODE_PLACES, TET_EDGES
from tisim.mesh._mesh import MeshError, boundary_facets
from tisim.mesh._section import half, moments
from tisim.mesh.beam import PAPER_LAYER, PAPER_RINGS, beam_mesh, outline, plane_section
from tisim.mesh.quality import quality, volumes

R = 0.010
CIRCLE = Circle(radius=R)
BOX = Rectangle(width=0.02, height=0.012)
KINDS = ["tet4", "tet10", "hex8"]


@pytest.mark.parametrize(
    ("length", "supports", "nodes"),
    [(0.05, "clamped-free", 525), (0.10, "clamped-free", 1015), (0.15, "clamped-clamped", 1505)],
)
def test_default_half_beam_has_the_few_nodes_that_the_answer_needs(length, supports, nodes):
    assert beam_mesh(length=length, section=CIRCLE, supports=supports, mirror=True).n_nodes == nodes


def test_paper_like_mesh_has_about_its_7257_nodes():
    mesh = beam_mesh(
        length=0.1, section=CIRCLE, kind="tet4", radial_elements=PAPER_RINGS, axial_element_size=PAPER_LAYER
    )
    assert abs(mesh.n_nodes - 7257) < 50


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mirror", [True, False])
@pytest.mark.parametrize("section", [CIRCLE, BOX])
@pytest.mark.parametrize("supports", ["clamped-free", "clamped-clamped"])
def test_conforming_with_true_volume_and_complete_sets(kind, mirror, section, supports):
    mesh = beam_mesh(
        length=0.06, section=section, kind=kind, mirror=mirror, supports=supports, with_grips=True
    )
    assert_conforming(mesh)
    assert_positive(mesh)
    area = np.pi * R**2 if section is CIRCLE else 0.02 * 0.012
    grips = 0.04 if supports == "clamped-clamped" else 0.02
    assert quality(mesh).volume * (2 if mirror else 1) == pytest.approx(area * (0.06 + grips), rel=1e-9)

    x, y, _ = mesh.nodes.T
    expected = {"clamp": x <= 0, ("far_clamp" if grips == 0.04 else "tip"): x >= 0.06}
    if mirror:
        expected["mirror_y"] = np.abs(y) < 1e-9
        assert mesh.symmetry == ("y",)
        assert y.min() == 0
    assert set(mesh.node_sets) == set(expected)
    for name, mask in expected.items():
        assert mesh.node_sets[name].tolist() == np.flatnonzero(mask).tolist()
    surface = facet_set(mesh.facet_sets["surface"])
    plane = facet_set(boundary_facets(kind, mesh.elements)) - surface
    assert all((np.abs(y[list(f)]) < 1e-9).all() for f in plane)
    assert bool(plane) == mirror
    if supports == "clamped-free":
        assert (x[mesh.facet_sets["tip"]] == 0.06).all()
        assert _area(mesh, "tip") * (2 if mirror else 1) == pytest.approx(area, rel=1e-9)


def _area(mesh, name):
    """Area of a plane face x = const by the divergence theorem on its boundary: integral of y dz."""
    facets = mesh.facet_sets[name]
    corners = 4 if mesh.kind == "hex8" else 3
    total = 0.0
    for k in range(corners):
        a, b = mesh.nodes[facets[:, k]], mesh.nodes[facets[:, (k + 1) % corners]]
        middle = mesh.nodes[facets[:, 3 + k]] if mesh.kind == "tet10" else 0.5 * (a + b)
        # Simpson's rule is exact for y dz/ds along a parabola, which is at most cubic
        for weight, y, dz in (
            (1 / 6, a, -3 * a + 4 * middle - b),
            (4 / 6, middle, b - a),
            (1 / 6, b, a - 4 * middle + 3 * b),
        ):
            total += weight * float((y[:, 1] * dz[:, 2]).sum())
    return total


@pytest.mark.parametrize(
    ("kind", "rings", "tolerance"),
    [("tet10", 1, 3e-6), ("tet10", 2, 2e-8), ("tet10", 4, 1e-9), ("tet4", 6, 6e-6), ("hex8", 2, 2e-4)],
)
def test_circular_section_has_the_true_area_and_inertia(kind, rings, tolerance):
    section = plane_section(CIRCLE, kind=kind, radial_elements=rings)
    area, about_z, about_y = moments(section, quadratic=kind == "tet10")
    assert area == pytest.approx(np.pi * R**2, rel=1e-12)
    assert about_z == pytest.approx(np.pi * R**4 / 4, rel=tolerance)
    assert about_y == pytest.approx(np.pi * R**4 / 4, rel=tolerance)
    assert moments(half(section), quadratic=kind == "tet10")[0] == pytest.approx(area / 2, rel=1e-12)


def test_quadratic_body_is_its_section_drawn_out():
    """The quadratic elements fill the circular section, unlike a faceted one."""
    mesh = beam_mesh(length=0.05, section=CIRCLE)
    # sample points in the curved elements
    rng = np.random.default_rng(0)
    L = rng.dirichlet(np.ones(4), size=4000)
    a, b = TET_EDGES.T
    shape = np.concatenate([L * (2 * L - 1), 4 * L[:, a] * L[:, b]], axis=1)
    pick = rng.choice(mesh.n_elements, size=4000, p=volumes(mesh) / volumes(mesh).sum())
    point = np.einsum("kn,kni->ki", shape, mesh.nodes[mesh.elements[pick]])
    assert np.linalg.norm(point[:, 1:], axis=1).max() < R * 1.0002
    # and the region near the rim is filled: an inscribed 12-gon lacks 4.5 % of the area
    assert (np.linalg.norm(point[:, 1:], axis=1) > 0.966 * R).mean() == pytest.approx(1 - 0.966**2, abs=0.012)


@given(
    length=st.floats(0.02, 0.2),
    radius=st.floats(0.002, 0.02),
    layer=st.floats(0.002, 0.02),
    rings=st.integers(1, 4),
    kind=st.sampled_from(KINDS),
    mirror=st.booleans(),
    both=st.booleans(),
)
@settings(max_examples=40, deadline=None)
def test_no_element_is_turned_over(length, radius, layer, rings, kind, mirror, both):
    mesh = beam_mesh(
        length=length,
        section=Circle(radius=radius),
        supports="clamped-clamped" if both else "clamped-free",
        axial_element_size=layer,
        radial_elements=rings,
        kind=kind,
        mirror=mirror,
    )
    assert_positive(mesh)
    area = np.pi * radius**2 * (0.5 if mirror else 1)
    assert quality(mesh).volume == pytest.approx(area * length, rel=1e-9)
    assert mesh.nodes[:, 0].max() == length


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("section", [CIRCLE, BOX])
def test_whole_beam_is_its_half_and_the_mirror_image(kind, section):
    """The elements agree, including their diagonals: otherwise half and whole models would differ."""
    one = beam_mesh(length=0.05, section=section, kind=kind, mirror=True)
    whole = beam_mesh(length=0.05, section=section, kind=kind)

    def elements(mesh, sign):
        place = np.round(mesh.nodes * [1, sign, 1], 9) + 0.0
        return {frozenset(map(tuple, place[e])) for e in mesh.elements.tolist()}

    assert elements(whole, 1) == elements(one, 1) | elements(one, -1)


def test_layers_are_graded_towards_the_clamps_only():
    def widths(supports, **more):
        mesh = beam_mesh(length=0.1, section=CIRCLE, kind="tet4", supports=supports, **more)
        return np.diff(np.unique(np.round(mesh.nodes[:, 0], 12)))

    free, both = widths("clamped-free"), widths("clamped-clamped")
    assert len(free) == len(both) == 14
    assert free[0] < 0.3 * free[-1]
    assert free[2:] == pytest.approx(free[-1])
    assert both == pytest.approx(both[::-1])
    assert both[0] < 0.3 * both[7]
    assert widths("clamped-free", grading=(1.0,)) == pytest.approx(0.1 / 14)


def test_tet10_middles_of_straight_edges_are_in_the_middle():
    mesh = beam_mesh(length=0.05, section=BOX)
    x = mesh.nodes[mesh.elements]
    assert x[:, 4:] == pytest.approx(x[:, TET_EDGES].mean(axis=2), abs=1e-15)
    assert NODE_PLACES["tet10"].shape == (10, 3)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mirror", [True, False])
def test_outline_follows_the_beam(kind, mirror):
    mesh = beam_mesh(length=0.05, section=BOX, kind=kind, mirror=mirror)
    moved = mesh.nodes + np.stack(
        [0 * mesh.nodes[:, 0], 0 * mesh.nodes[:, 0], -(mesh.nodes[:, 0] ** 2)], axis=1
    )
    line = outline(mesh, moved)
    assert line.x[[0, -1]].tolist() == [0, 0.05]
    assert (np.diff(line.x) > 0).all()
    for edge, z in ((line.upper, 0.006), (line.lower, -0.006), (line.centreline, 0.0)):
        assert edge[:, 0] == pytest.approx(line.x)
        assert edge[:, 1] == pytest.approx(z - line.x**2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"length": 0.0}, "length must be a positive length"),
        ({"length": float("nan")}, "length must be a positive length"),
        ({"axial_element_size": -1.0}, "axial element size must be a positive length"),
        ({"radial_elements": 0}, "at least 1 element from axis"),
        ({"section": Circle(radius=-1.0)}, "radius must be a positive length"),
        ({"section": Rectangle(width=0.01, height=0.0)}, "height must be a positive length"),
        ({"grading": (0.0,)}, "grading must be positive"),
        ({"supports": "free"}, "supports must be"),
        ({"with_grips": True, "grip_length": 0.0}, "grip length must be a positive length"),
    ],
)
def test_bad_input_is_named(change, message):
    with pytest.raises(MeshError, match=message):
        beam_mesh(**{"length": 0.05, "section": CIRCLE, **change})


def test_outline_of_other_positions_is_refused():
    mesh = beam_mesh(length=0.05, section=CIRCLE)
    with pytest.raises(MeshError, match="positions must have shape"):
        outline(mesh, mesh.nodes[1:])
