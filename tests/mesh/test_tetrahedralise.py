"""Bodies from surfaces, by fTetWild."""

import numpy as np
import pytest
import trimesh
from mesh_checks import assert_closed, assert_conforming, assert_positive, facet_set

from tisim.mesh import tetrahedralise
from tisim.mesh._mesh import Mesh, MeshError, boundary_facets
from tisim.mesh.block_around import _onto_planes, block_around
from tisim.mesh.quality import quality
from tisim.mesh.refine import refine_around
from tisim.mesh.tetrahedralise import body_from_surface

BALL = trimesh.creation.icosphere(subdivisions=2, radius=0.01)
SIZE = (0.04, 0.04, 0.03)


def sunk_ball():
    """Ball of which a third lies below the block's base."""
    return BALL.copy().apply_translation((0.004, 0.0, 0.003))


def test_block_with_a_ball_cut_out(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh = block_around(sunk_ball(), size=SIZE, edge_length=0.006)
    assert not list(tmp_path.iterdir())  # fTetWild writes a file into its working folder
    assert_conforming(mesh)
    assert_positive(mesh)
    box = trimesh.creation.box(SIZE).apply_translation((0, 0, SIZE[2] / 2))
    cut = trimesh.boolean.intersection([box, sunk_ball()]).volume
    assert quality(mesh).volume == pytest.approx(np.prod(SIZE) - cut, rel=2e-3)
    assert quality(mesh).min_scaled_jacobian > 0.02
    x = mesh.nodes
    distance = np.linalg.norm(x - [0.004, 0.0, 0.003], axis=1)
    on_ball = (distance < 0.01 + 2e-4) & (x[:, 2] >= 0)
    assert set(mesh.node_sets["base"]) == set(np.flatnonzero((x[:, 2] == 0) | on_ball))
    assert (distance[mesh.node_sets["inclusion"]] > 0.0093).all()
    assert (x[mesh.facet_sets["top"], 2] == SIZE[2]).all()
    corner = x[mesh.facet_sets["top"]]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2].sum() / 2
    assert area == pytest.approx(SIZE[0] * SIZE[1])

    fine = refine_around(mesh, centre=(-0.01, 0, SIZE[2]), radius=0.003, edge_length=0.0015)
    assert_conforming(fine)
    assert (fine.nodes[fine.facet_sets["top"], 2] == SIZE[2]).all()
    free = np.setdiff1d(np.arange(fine.n_nodes), fine.node_sets["base"])
    assert (np.linalg.norm(fine.nodes[free] - [0.004, 0, 0.003], axis=1) > 0.009).all()
    assert (fine.nodes[free, 2] > 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["tet4", "tet10"])
def test_body_of_a_file_in_millimetres(tmp_path, kind):
    path = tmp_path / "ball.stl"
    BALL.copy().apply_scale(1000).export(path)
    mesh = body_from_surface(path, edge_length=0.004, units="mm", kind=kind)
    assert_conforming(mesh)
    assert_positive(mesh)
    assert quality(mesh).volume == pytest.approx(BALL.volume, rel=1e-2)
    assert facet_set(mesh.facet_sets["surface"]) == facet_set(boundary_facets(kind, mesh.elements))


@pytest.mark.slow
def test_inclusion_in_mid_block_is_a_cavity():
    inside = BALL.copy().apply_scale(0.8).apply_translation((0.0, 0.0, 0.015))
    mesh = block_around(inside, size=SIZE, edge_length=0.006)
    assert_closed(mesh.facet_sets["surface"], mesh, euler=4)
    assert quality(mesh).volume == pytest.approx(np.prod(SIZE) - inside.volume, rel=2e-3)
    assert (mesh.nodes[mesh.node_sets["base"], 2] > 0.005).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"edge_length": 0.0}, "edge length must lie between 0 and the body's size"),
        ({"edge_length": 4.0}, "edge length must lie between 0 and the body's size"),
        ({"edge_length": 2e-5}, "would give about .* tetrahedra"),
        ({"edge_length": 0.004, "kind": "hex8"}, "kind: expected tet4 or tet10, got 'hex8'"),
        ({"edge_length": 0.004, "tolerance": -1e-4}, "tolerance: expected a length above 0"),
        ({"edge_length": 0.001, "time_limit": 0.01}, r"not done after 0\.01 s"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(MeshError, match=message):
        body_from_surface(BALL, **options)


def test_a_crash_of_the_mesher_is_a_mesh_error(tmp_path, monkeypatch):
    script = tmp_path / "_ftetwild.py"
    script.write_text("import os; os.abort()")
    monkeypatch.setattr(tetrahedralise, "__file__", str(tmp_path / "tetrahedralise.py"))
    with pytest.raises(MeshError, match="could not mesh the surface: exit status -6"):
        body_from_surface(BALL, edge_length=0.004)


@pytest.mark.parametrize(
    ("move", "message"),
    [
        ((0, 0, -0.02), "below the block"),
        ((0, 0, 0.025), "the block's top"),
        ((0.015, 0, 0.01), "the block's sides"),
    ],
)
def test_inclusions_out_of_place_are_refused(move, message):
    with pytest.raises(MeshError, match=message):
        block_around(BALL.copy().apply_translation(move), size=SIZE, edge_length=0.005)


def test_block_without_a_size_is_refused():
    with pytest.raises(MeshError, match="three positive lengths"):
        block_around(None, size=(0.1, 0.1, 0.0), edge_length=0.005)


def flat_body(height: float) -> Mesh:
    """A tetrahedron on the base whose fourth node is at `height` [m]."""
    nodes = np.array([[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0], [0.002, 0.002, height]])
    return Mesh(kind="tet4", nodes=nodes, elements=np.array([[0, 1, 2, 3]], dtype=np.int32))


def test_a_block_with_a_flat_element_is_made_anew(monkeypatch):
    made = iter([flat_body(2e-5), flat_body(-0.01), flat_body(0.008)])
    monkeypatch.setitem(block_around.__globals__, "body_from_surface", lambda *_, **__: next(made))
    mesh = block_around(None, size=SIZE, edge_length=1e-3, tolerance=1e-6)
    assert quality(mesh).min_scaled_jacobian > 0.1


def test_a_block_that_is_flat_each_time_is_refused(monkeypatch):
    monkeypatch.setitem(block_around.__globals__, "body_from_surface", lambda *_, **__: flat_body(2e-5))
    with pytest.raises(MeshError, match=r"turn an element over or flatten it: ask for a smaller tolerance"):
        block_around(None, size=SIZE, edge_length=1e-3, tolerance=1e-6)


def test_slivers_in_a_plane_are_left_out():
    """Two tetrahedra below the top, and one within the tolerance of it, as fTetWild sometimes makes them."""
    nodes = np.array([[0, 0, 1.0], [1, 0, 1 - 1e-4], [1, 1, 1.0], [0, 1, 1 - 1e-4], [0.4, 0.5, 0.2]])
    sliver, below = [0, 1, 2, 3], [[0, 2, 1, 4], [0, 3, 2, 4]]
    elements = np.array([sliver, *below], dtype=np.int32)
    corner = nodes[elements]
    turned = np.linalg.det(corner[:, 1:] - corner[:, :1]) < 0
    elements[turned] = elements[turned][:, [0, 2, 1, 3]]
    flattened = _onto_planes(Mesh(kind="tet4", nodes=nodes, elements=elements), (9.0, 9.0, 1.0), 1e-3)
    assert flattened.n_elements == 2
    assert_conforming(flattened)
    assert_positive(flattened)
    assert len(flattened.facet_sets["top"]) == 2
    assert (flattened.nodes[:4, 2] == 1).all()


@pytest.mark.parametrize(
    ("move", "plane"),
    [((0.0, 0.0, 0.0248), "top"), ((0.0, 0.0, 0.0051), "base"), ((0.0149, 0.0, 0.012), "sides")],
)
def test_an_inclusion_closer_to_a_plane_than_the_tolerance_is_refused(move, plane):
    """The tissue between them would be taken for a part of the plane, and the block would have a hole."""
    box = trimesh.creation.box((0.01, 0.01, 0.01)).apply_translation(move)
    with pytest.raises(
        MeshError, match=f"comes within .* of the block's {plane}, which the mesh's tolerance"
    ):
        block_around(box, size=(0.04, 0.04, 0.03), edge_length=0.006)


@pytest.mark.slow
def test_a_plain_block_of_few_edges_is_meshed():
    """With edges of 5 mm the default tolerance alone fails in most attempts."""
    mesh = block_around(None, size=(0.04, 0.04, 0.03), edge_length=0.005)
    assert quality(mesh).volume == pytest.approx(0.04 * 0.04 * 0.03, rel=1e-6)
