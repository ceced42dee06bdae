"""The near field of a poke: what it moves, when it is left alone, and that it changes no answer."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import tisim
from tisim import _poke_near
from tisim._body import Layout
from tisim._newton import Outcome
from tisim._poke import solve_poke
from tisim._poke_near import NearField
from tisim._poke_system import PokeSystem
from tisim.mesh.poke_block import poke_mesh
from tisim.result import Status

Array = NDArray[np.float64]


def scene(depth: float = 0.002) -> tisim.Poke:
    return tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear=30e3, bulk=600e3),
        direction=(0.3, 0.0, -0.9),
        depth=depth,
        refinement=0.5,
        gravity=(0.0, 0.0, -9.81),
    )


def pressed() -> tuple[PokeSystem, Array]:
    """A rod 0.3 mm into a block that has not yielded."""
    poke = scene()
    mesh = poke_mesh(
        block=poke.block, site=poke.site, direction=poke.direction, rod=poke.rod, refinement=poke.refinement
    )
    it = PokeSystem(poke, Layout.build(mesh, mesh.node_sets["base"]))
    it.move_to(0.0003)
    x = mesh.nodes.copy()
    it.touch(x)
    return it, x


def close(it: PokeSystem) -> NDArray[np.bool_]:
    """Free nodes within 1.6 radii of the tip, by row of the system's residual."""
    rest = it.layout.mesh.nodes[it.layout.pattern.free]
    return np.asarray(np.linalg.norm(rest - it.tip, axis=1) < 1.6 * it.scene.rod.radius)


def test_near_nodes_come_to_rest_and_others_stay() -> None:
    it, x = pressed()
    near = NearField(it)
    before, _ = it.residual(x)
    relaxed = near.relax(x)
    after, load = it.residual(relaxed)
    rows = close(it)
    assert 30 < rows.sum() < 0.5 * len(rows)
    moved = np.zeros(len(x), dtype=bool)
    moved[it.layout.pattern.free[rows]] = True
    assert np.array_equal(relaxed[~moved], x[~moved])
    assert np.abs(relaxed[moved] - x[moved]).max() > 1e-5
    # 1e-3 of the load is more than the goal, 3 % of what the near residual was at most
    assert np.linalg.norm(before[rows]) > 0.1 * load
    assert np.linalg.norm(after[rows]) < 0.04 * np.linalg.norm(before[rows])
    assert near.iterations > 0


def test_a_part_has_the_residual_and_the_tangent_of_the_whole() -> None:
    it, x = pressed()
    near = NearField(it)
    near.relax(x)
    assert near._body is not None
    rng = np.random.default_rng(3)
    x = x + 2e-5 * rng.standard_normal(x.shape)
    part = it.restricted(near._body, near._linear, near._slot)
    whole, _ = it.linearise(x)
    rows = close(it)
    assert part.linearise(x)[0] == pytest.approx(whole[rows], rel=1e-10, abs=1e-12)
    diagonal = it.layout.pattern.indptr[:-1][rows]
    assert part._blocks[part.layout.pattern.indptr[:-1]] == pytest.approx(it._blocks[diagonal], rel=1e-9)


def test_trying_a_part_leaves_the_state_of_contact_alone() -> None:
    it, x = pressed()
    it.linearise(x)
    kept = [a.copy() for a in (it._pressure, it._slip, it._skew, it._memory, it._part, it.report)]
    NearField(it).relax(x)
    for a, b in zip(kept, (it._pressure, it._slip, it._skew, it._memory, it._part, it.report), strict=True):
        assert np.array_equal(a, b)


def test_a_near_field_that_fails_changes_nothing_and_rests(monkeypatch: pytest.MonkeyPatch) -> None:
    it, x = pressed()
    near = NearField(it)
    near.begin()
    with monkeypatch.context() as change:
        worse = Outcome(x + 1e-4, Status.NOT_CONVERGED, 1e6, 8)
        change.setattr(_poke_near, "contact_newton", lambda *_a, **_k: worse)
        assert near.relax(x) is x
    for _ in range(2):
        assert near.relax(x) is x  # in this load step and the next
        near.begin()
    assert near.relax(x) is not x


def test_a_shift_takes_its_weights() -> None:
    """Rows without weight move as by the plain step, up to what the others pass on."""
    it, x = pressed()
    residual, _ = it.linearise(x)
    rows = close(it)
    plain = it.step(residual, forcing=1e-6)
    sizes = []
    for far in (1.0, 0.0):
        it.linear.weights[:, 0] = np.where(rows, 0.0, far)
        it.linear.reset()
        for _ in range(3):
            it.linear.stiffen()
        sizes.append(np.abs(it.step(residual, forcing=1e-6) - plain).max() / np.abs(plain).max())
    assert sizes[0] > 0.01
    assert sizes[1] < 1e-5


def test_the_force_is_that_of_newton_on_the_whole_block(monkeypatch: pytest.MonkeyPatch) -> None:
    near = solve_poke(scene())
    monkeypatch.setattr(NearField, "relax", lambda _self, x: x)
    whole = solve_poke(scene())
    assert near.ok
    assert whole.ok
    assert near.cost.newton_iterations < 0.7 * whole.cost.newton_iterations
    size = np.linalg.norm(whole.rod_force, axis=1)
    assert (np.linalg.norm(near.rod_force - whole.rod_force, axis=1) < 2e-3 * size).all()
