"""Scenes on meshes of one's own: what holds them, where the rod first touches, what is refused and how."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tisim
from tisim.mesh import Mesh, boundary_facets, to_quadratic, with_facet_set, with_node_set

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=15e3, bulk_modulus=150e3)
ROD = tisim.Rod(radius=0.006, tip="hemisphere")
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def box(count: tuple[int, int, int], low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    ticks = [np.linspace(a, b, n + 1) for n, a, b in zip(count, low, high, strict=True)]
    nodes = np.stack(np.meshgrid(*ticks, indexing="ij"), -1).reshape(-1, 3)
    index = np.arange(len(nodes)).reshape([n + 1 for n in count])
    nx, ny, nz = count
    elements = np.stack([index[a : a + nx, b : b + ny, c : c + nz].ravel() for a, b, c in CORNERS], axis=1)
    surface = boundary_facets("hex8", elements.astype(np.int32))
    return Mesh(kind="hex8", nodes=nodes, elements=elements, facet_sets={"surface": surface})


def bar() -> Mesh:
    mesh = box((8, 2, 2), (0.0, -0.005, -0.005), (0.06, 0.005, 0.005))
    mesh = with_node_set(mesh, "clamp", lambda x: x[:, 0] < 1e-9)
    return with_facet_set(mesh, "tip", lambda x: x[:, 0] > 0.06 - 1e-9)


def slab(count: tuple[int, int, int] = (10, 10, 4)) -> Mesh:
    mesh = to_quadratic(box(count, (-0.03, -0.03, 0.0), (0.03, 0.03, 0.02)))
    mesh = with_node_set(mesh, "base", lambda x: x[:, 2] < 1e-9)
    return with_facet_set(mesh, "top", lambda x: x[:, 2] > 0.02 - 1e-9)


def poke(mesh: Mesh, **more: Any) -> tisim.Result:
    scene = {"depth": 0.002, "friction": 0.3, "rod": ROD, **more}
    return tisim.simulate(tisim.Poke(material=SOFT, mesh=mesh, **scene), workers=1)


def test_the_supports_decide_what_is_held_and_not_the_sets_that_a_mesh_has() -> None:
    """A free end that also bears the name far_clamp hangs down, in a batch with one that is clamped."""
    alone = bar()
    both = with_node_set(alone, "far_clamp", lambda x: x[:, 0] > 0.06 - 1e-9)
    scenes = [
        tisim.Beam(material=SOFT, mesh=alone),
        tisim.Beam(material=SOFT, mesh=both),
        tisim.Beam(material=SOFT, mesh=both, supports="clamped-clamped"),
    ]
    hung, same, held = tisim.simulate(scenes, workers=1)
    np.testing.assert_allclose(same.positions, hung.positions, atol=1e-9)
    assert np.abs(hung.positions[-1] - alone.nodes)[:, 2].max() > 0.03
    assert np.abs(held.positions[-1] - alone.nodes)[:, 2].max() < 0.002


def test_depth_counts_from_first_contact_on_a_top_that_is_no_plane() -> None:
    """The same force at the same depth, though the top rises by 6 mm towards an edge."""
    flat = slab()
    nodes = flat.nodes.copy()
    nodes[:, 2] *= 1.0 + 0.3 * np.clip((nodes[:, 0] - 0.012) / 0.018, 0.0, 1.0)
    forces = [np.linalg.norm(poke(m).rod_force, axis=1) for m in (flat, replace(flat, nodes=nodes))]  # type: ignore[arg-type]
    np.testing.assert_allclose(forces[1], forces[0], rtol=5e-3)


@pytest.mark.parametrize("way", [(0.0, 0.0, -1.0), (0.3, 0.0, -1.0)])
def test_a_rod_touches_a_dome_where_geometry_says(way: tuple[float, float, float]) -> None:
    """A dome of 60 mm radius under a hemisphere: the centres are the sum of the radii apart."""
    flat = slab()
    nodes = flat.nodes.copy()
    sunk = 0.06 - np.sqrt(0.06**2 - nodes[:, 0] ** 2 - nodes[:, 1] ** 2)
    nodes[:, 2] *= 1.0 - sunk / 0.02
    found = poke(replace(flat, nodes=nodes), direction=way, depth=0.001)
    assert found.rod_tip is not None
    axis = np.array(way) / np.linalg.norm(way)
    first = found.rod_tip[0] - found.load[0] * axis  # at first contact
    apart = first - ROD.radius * axis - np.array([0.0, 0.0, 0.02 - 0.06])
    assert np.linalg.norm(apart) == pytest.approx(0.06 + ROD.radius, abs=3e-5)


def test_a_body_may_lie_anywhere_and_be_higher_than_the_default_block() -> None:
    flat = slab()
    moved = replace(flat, nodes=flat.nodes + np.array([0.08, 0.0, 0.1]))
    here, there = (np.linalg.norm(r.rod_force, axis=1) for r in (poke(flat), poke(moved, site=(0.08, 0.0))))  # type: ignore[arg-type]
    np.testing.assert_allclose(there, here, rtol=1e-3)  # of the solver's tolerance
    coarse = slab((6, 6, 4))
    high = replace(coarse, nodes=coarse.nodes * [1.0, 1.0, 4.0])
    assert poke(high, depth=0.035, frame_spacing=0.035).load[-1] == pytest.approx(0.035)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"site": (0.2, 0.0)}, r"site: expected a place on the top \(x -30 to 30, y -30 to 30 mm\)"),
        ({"depth": 0.025}, "depth: expected less than the body's height of 0.02 m"),
        ({"direction": (1.0, 0.0, -1.2), "site": (0.029, 0.0)}, "expected a path within the body's sides"),
        (
            {"block": tisim.Block(inclusion=tisim.SphereInclusion(radius=0.008, centre=(0, 0, 0.008)))},
            r"block\.inclusion: expected none beside a mesh",
        ),
    ],
)
def test_a_poke_that_does_not_fit_its_mesh_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        poke(slab(), **change)


def test_a_top_with_a_hole_below_the_site_is_refused() -> None:
    mesh = slab()
    ring = mesh.facet_sets["top"][
        np.linalg.norm(mesh.nodes[mesh.facet_sets["top"]].mean(axis=1)[:, :2], axis=1) > 0.028
    ]
    with pytest.raises(ValueError, match="site: expected a place on the mesh's top"):
        poke(replace(mesh, facet_sets={"top": ring}), depth=0.001, rod=tisim.Rod(radius=0.002))


def test_a_bad_mesh_is_refused_before_anything_is_solved() -> None:
    good = tisim.Beam(material=SOFT, mesh=bar())
    turned = bar().elements.copy()
    turned[5] = turned[5][[4, 5, 6, 7, 0, 1, 2, 3]]
    done: list[float] = []
    with pytest.raises(ValueError, match=r"scene 1: Beam\.mesh: expected elements of positive volume"):
        tisim.simulate(
            [good, tisim.Beam(material=SOFT, mesh=replace(bar(), elements=turned))],
            workers=1,
            on_progress=lambda n, _: done.append(n),
        )
    assert not done
    first = bar()
    other = box((1, 1, 1), (0.2, 0.0, 0.0), (0.21, 0.01, 0.01))
    two = Mesh(
        kind="hex8",
        nodes=np.concatenate([first.nodes, other.nodes]),
        elements=np.concatenate([first.elements, other.elements + first.n_nodes]),
        node_sets=first.node_sets,
    )
    with pytest.raises(ValueError, match="elements that are all connected to clamp, others would fall"):
        tisim.simulate(tisim.Beam(material=SOFT, mesh=two, length=0.06), workers=1)


def test_a_facet_that_is_given_twice_is_refused() -> None:
    """Its share of a tip force, of a tip mass and of contact would count twice."""
    mesh = bar()
    tip = mesh.facet_sets["tip"]
    again = replace(mesh, facet_sets={**mesh.facet_sets, "tip": np.concatenate([tip, tip[:1, [1, 2, 3, 0]]])})
    words = r"Beam\.mesh: expected a facet set 'tip' with each facet once, got '1 given again'"
    with pytest.raises(ValueError, match=words):
        tisim.simulate(tisim.Beam(material=SOFT, mesh=again, tip_force=(0.0, 0.0, -0.01)))
    top = slab()
    twice = np.concatenate([top.facet_sets["top"]] * 2)
    with pytest.raises(ValueError, match=r"Poke\.mesh: expected a facet set 'top' with each facet once"):
        poke(replace(top, facet_sets={**top.facet_sets, "top": twice}))


def test_sets_may_be_lists_and_masks() -> None:
    mesh = bar()
    mask = mesh.nodes[:, 0] < 1e-9
    for given in (mask, np.flatnonzero(mask).tolist()):
        found = replace(mesh, node_sets={"clamp": given})  # type: ignore[dict-item]
        np.testing.assert_array_equal(found.node_sets["clamp"], mesh.node_sets["clamp"])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "tetra"}, "mesh kind: expected one of tet4, tet10, hex8, hex20, got 'tetra'"),
        ({"node_sets": {"clamp": [0, 4000]}}, "mesh node set 'clamp': a node index is out of range"),
        ({"node_sets": {"clamp": [0.5, 1.0]}}, "mesh node set 'clamp': expected whole numbers"),
        ({"node_sets": {"clamp": [[0, 1]]}}, "mesh node set 'clamp': expected indices of nodes, got shape"),
        (
            {"facet_sets": {"tip": [1, 2, 3, 4]}},
            r"facet set 'tip': expected the nodes of facets, shape \(f, 4\)",
        ),
        ({"elements": np.array([[0.4] * 8])}, "mesh elements: expected whole numbers"),
        ({"symmetry": ("y",)}, r"mesh symmetry: expected axis names, each with its node set \(mirror_y\)"),
    ],
)
def test_arrays_that_are_no_mesh_are_refused_in_one_sentence(change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        replace(bar(), **change)


def test_nodes_that_no_element_uses_have_no_part_in_the_length() -> None:
    mesh = bar()
    more = replace(mesh, nodes=np.vstack([mesh.nodes, [[0.5, 0.0, 0.0]]]))
    assert tisim.Beam(material=SOFT, mesh=more).length == pytest.approx(0.06)


@pytest.mark.parametrize("imperfections", [tisim.Imperfections(), tisim.Imperfections(curvature=2.0)])
def test_nodes_that_no_element_uses_stay_at_rest(imperfections: tisim.Imperfections) -> None:
    """They bent with the start value of the beam, and were its largest displacement."""
    mesh = bar()
    more = replace(mesh, nodes=np.vstack([mesh.nodes, [[0.05, 0.0, 0.4]]]))
    scenes = [tisim.Beam(material=SOFT, mesh=m, imperfections=imperfections) for m in (mesh, more)]
    alone, found = (tisim.simulate(scene, workers=1) for scene in scenes)
    np.testing.assert_allclose(found.positions[:, :-1], alone.positions, atol=1e-9)
    assert np.array_equal(found.positions[-1, -1], found.rest_positions[-1])
    assert found._summary()[-3] == alone._summary()[-3]
    assert found._summary()[-3][0] == "largest displacement"


def test_a_half_mesh_is_refused_where_a_load_crosses_its_mirror() -> None:
    """It would not move, and be called converged."""
    first = tisim.simulate(tisim.Beam(material=SOFT, length=0.05), workers=1)
    assert first.mesh.symmetry == ("y",)
    again = tisim.Beam(material=SOFT, mesh=first.mesh, length=0.05)
    assert tisim.simulate(again, workers=1).ok
    for change in ({"gravity": (0.0, -9.81, 0.0)}, {"tip_force": (0.0, 0.01, 0.0)}):
        with pytest.raises(ValueError, match=r"mesh: expected a whole body \(tisim\.mesh\.unfold\)"):
            tisim.simulate(replace(again, **change), workers=1)  # type: ignore[arg-type]


def test_imperfections_are_refused_on_a_mesh_that_they_are_not_measured_on() -> None:
    own = bar()
    moved = replace(own, nodes=own.nodes + np.array([0.03, 0.0, 0.0]))
    tilted = tisim.ClampImperfections(tilt=0.1)
    assert tisim.simulate(tisim.Beam(material=SOFT, mesh=own, clamp_imperfections=tilted), workers=1).ok
    for mesh, more in ((moved, {}), (own, {"length": 0.05})):
        scene = tisim.Beam(material=SOFT, mesh=mesh, clamp_imperfections=tilted, **more)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="mesh: expected a beam from its clamp's face at x = 0"):
            tisim.simulate(scene, workers=1)
    assert tisim.simulate(tisim.Beam(material=SOFT, mesh=moved), workers=1).ok


def test_a_compliant_clamp_turns_about_y_alone() -> None:
    clamps = tisim.ClampImperfections(compliance=30.0)
    with pytest.raises(ValueError, match=r"clamp_imperfections\.compliance: expected 0 where gravity"):
        tisim.simulate(
            tisim.Beam(material=SOFT, length=0.05, gravity=(0.0, -9.81, 0.0), clamp_imperfections=clamps),
            workers=1,
        )


def test_a_series_of_loading_and_unloading_has_rising_steps(tmp_path: Path) -> None:
    coupon = tisim.Coupon(material=SOFT, mode="uniaxial", stretches=(1.1, 1.3, 1.1))
    path = tisim.write(tisim.simulate(coupon, workers=1), tmp_path / "coupon.pvd")
    steps = [float(s) for s in re.findall(r'timestep="([^"]+)"', path.read_text(encoding="utf-8"))]
    assert steps == [0.0, 1.0, 2.0]
