"""Contact of flat facets with the rod's rounding, and the force it leads to at depth."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tisim
from tisim.discretisation.body import Discretisation
from tisim.mesh.indentation import poke_mesh
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import PokeSystem

REFERENCE = json.loads(
    (Path(__file__).parents[2] / "benchmarks" / "references" / "poke.json").read_text(encoding="utf-8")
)["values"]["0.6"]
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3)


def test_facets_whose_nodes_lie_on_the_rod_touch_it_evenly() -> None:
    """Nodes of the top that a hemisphere overlaps are put onto it: their facets then touch it all over."""
    scene = tisim.Poke(material=SOFT, depth=0.002, rod=tisim.Rod(tip="hemisphere"))
    mesh = poke_mesh(block=scene.block, site=scene.site, rod=scene.rod)
    system = PokeSystem(scene, Discretisation.build(mesh, mesh.node_sets["base"]))
    system.move_to(scene.depth)
    radius = scene.rod.radius
    centre = system.tip + np.array([0.0, 0.0, radius])
    x = mesh.nodes.copy()
    top = mesh.node_sets["top"]
    off = np.linalg.norm(x[top, :2] - centre[:2], axis=1)
    inside = top[off < 0.9 * radius]
    across = np.linalg.norm(x[inside, :2] - centre[:2], axis=1)
    x[inside, 2] = centre[2] - np.sqrt(radius**2 - across**2)

    system.accept(x)
    on_rod = np.isin(system.facets, inside).all(axis=1)
    assert on_rod.sum() > 10
    assert np.abs(system._gap[on_rod]).max() > 1e-5  # flat facets cut into the rod
    system.accept(x)  # now they bulge
    assert np.abs(system._gap[on_rod]).max() < 1e-9
    away = mesh.nodes[system.facets].mean(axis=1)[:, :2]
    away_from_it = np.linalg.norm(away - centre[:2], axis=1) > 2.0 * radius
    assert np.abs(system._bulge[away_from_it]).max() < 1e-12


def test_force_against_an_independent_solver() -> None:
    """Within 2 % of axisymmetric quadratic elements (benchmarks/references/poke.json) down to 5 mm.

    With flat facets that touch by their middles it was 3.1 % off at 2 mm.
    """
    result = solve_poke(tisim.Poke(material=SOFT, depth=0.005))
    assert result.ok
    force = dict(zip((1e3 * result.load).round().astype(int), result.rod_force[:, 2], strict=True))
    for depth in (1, 2, 5):
        assert force[depth] == pytest.approx(REFERENCE[str(depth)]["force"], rel=0.02)
