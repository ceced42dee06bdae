"""Contact kernels: distance against a sampled rod, forces and tangents against finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import tisim
from tisim.discretisation.body import Discretisation
from tisim.kernels.contact import contact_kernels, pack_rod
from tisim.mesh.indentation import poke_mesh
from tisim.problems.indentation.system import PokeSystem

Array = NDArray[np.float64]
AXIS = np.array([0.3, -0.2, -0.9]) / np.linalg.norm([0.3, -0.2, -0.9])


def sampled_rod(rod: tisim.Rod, tip: Array) -> Array:
    """Points on the indenter's surface, a few micrometres apart near the edge."""
    edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
    across = np.cross(AXIS, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    around = np.cross(AXIS, across)
    bend = np.linspace(0, np.pi / 2, 120)
    core = rod.radius - edge
    profile = np.concatenate(
        [
            np.column_stack([np.linspace(0, core, 80), np.zeros(80)]),
            np.column_stack([core + edge * np.sin(bend), -edge * (1 - np.cos(bend))]),
            np.column_stack([np.full(200, rod.radius), -edge - np.linspace(0, 0.008, 200)]),
        ]
    )
    phi = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    ring = np.cos(phi)[:, None] * across + np.sin(phi)[:, None] * around
    return (tip + profile[:, None, 1:] * AXIS + profile[:, None, :1] * ring).reshape(-1, 3)


@pytest.mark.parametrize("rod", [tisim.Rod(), tisim.Rod(tip="hemisphere")], ids=["flat", "hemisphere"])
def test_distance_is_that_of_the_rod(rod: tisim.Rod) -> None:
    tip = np.array([0.001, 0.002, 0.003])
    edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
    surface = sampled_rod(rod, tip)
    rng = np.random.default_rng(0)
    points = tip - 0.001 * AXIS + rng.uniform(-0.004, 0.004, (150, 3))
    packed = pack_rod(tip, AXIS, rod.radius, edge, np.zeros(3))
    conn = np.arange(len(points) * 4, dtype=np.int32).reshape(-1, 4) // 4  # facets degenerated to a point
    distance = np.empty((len(points), 1))
    contact_kernels()[0](points, np.ascontiguousarray(conn), np.full((1, 4), 0.25), packed, distance)
    nearest, _ = cKDTree(surface).query(points)
    assert np.abs(distance[:, 0]) == pytest.approx(nearest, abs=3e-5)
    s = (points - tip) @ AXIS
    r = np.linalg.norm(points - tip - s[:, None] * AXIS, axis=1)
    deep = (s < -edge - 1e-4) & (r < rod.radius - 1e-4)
    far = (s > 1e-4) | (r > rod.radius + 1e-4)
    assert deep.any()
    assert (distance[deep] < 0).all()
    assert (distance[far] > 0).all()


def system(friction: float) -> tuple[PokeSystem, Array]:
    """An indenter 0.8 mm deep in a block with small random displacements; part of the contact slips."""
    scene = tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        friction=friction,
        direction=tuple(AXIS),  # type: ignore[arg-type]
        depth=0.002,
    )
    mesh = poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod, refinement=0.5
    )
    it = PokeSystem(scene, Discretisation.build(mesh, mesh.node_sets["base"]))
    it.move_to(0.0008)
    rng = np.random.default_rng(2)
    x = mesh.nodes + 2e-5 * rng.standard_normal(mesh.nodes.shape)
    x[mesh.node_sets["base"]] = mesh.nodes[mesh.node_sets["base"]]
    it.touch(x)
    return it, x


def residual(it: PokeSystem, x: Array) -> Array:
    return it.linearise(x)[0].copy()


def tangent_times(it: PokeSystem, v: Array) -> Array:
    return it.multiply(v.ravel()).reshape(-1, 3)


@pytest.mark.parametrize("friction", [0.0, 0.05, 5.0], ids=["slippery", "slipping", "sticking"])
def test_tangent_is_the_derivative_of_the_residual(friction: float) -> None:
    it, x = system(friction)
    rng = np.random.default_rng(3)
    free = it.discretisation.pattern.free
    touched = np.unique(it.facets)
    v = np.zeros((len(free), 3))
    rows = it.discretisation.pattern.index[touched]
    v[rows[rows >= 0]] = rng.standard_normal((int((rows >= 0).sum()), 3))
    h = 2e-10
    step = np.zeros_like(x)
    step[free] = h * v
    numeric = (residual(it, x + step) - residual(it, x - step)) / (2 * h)
    residual(it, x)
    assert it.report[4] > 1e-7  # area in contact
    exact = tangent_times(it, v)
    assert np.linalg.norm(exact - numeric) < 2e-3 * np.linalg.norm(numeric)


def test_force_is_the_derivative_of_the_energy_without_friction() -> None:
    it, x = system(0.0)
    r = residual(it, x)
    rng = np.random.default_rng(4)
    free = it.discretisation.pattern.free
    v = rng.standard_normal((len(free), 3))
    h = 1e-9
    step = np.zeros_like(x)
    step[free] = h * v
    numeric = (it.potential(x + step)[0] - it.potential(x - step)[0]) / (2 * h)
    assert float(np.vdot(r, v)) == pytest.approx(numeric, rel=1e-5)


@pytest.mark.parametrize("overlap", [4e-5, 1.5e-4], ids=["linear", "hardened"])
@pytest.mark.parametrize("part", [0.3, 0.99, 3.0])
def test_friction_grows_to_its_limit_over_one_slip_at_any_pressure(part: float, overlap: float) -> None:
    """A point under the flat that moves across it, against mu p min(g / l, 1) and the energy's derivative."""
    _, energy, assemble = contact_kernels()
    across = np.cross(AXIS, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    stiffness, slip, friction, hardens, area = 6e9, 5e-5, 0.6, 1e-4, 2e-7
    pressure = stiffness * overlap * (1.0 + (overlap / hardens) ** 4)
    before = -overlap * AXIS[None]
    rod = pack_rod(np.zeros(3), AXIS, 2.5e-3, 1e-3, np.zeros(3))
    law = np.array([stiffness, slip, friction, hardens])
    conn, shape, weights = np.zeros((1, 4), dtype=np.int32), np.full((1, 4), 0.25), np.full((1, 1), area)
    memory, touches, held = np.zeros((1, 1, 3)), np.ones((1, 1)), np.zeros((1, 1))
    slips, skew, slot = np.zeros((1, 1, 3)), np.zeros((1, 1, 9)), np.full((1, 4, 4), -1, dtype=np.int32)
    force = np.zeros((1, 3))

    def energy_at(distance: float) -> float:
        out = np.zeros(2)
        energy(before + distance * across, before, conn, shape, weights, rod, law, memory, touches, held, out)
        return float(out[0])

    moved = before + part * slip * across
    assemble(
        moved, before, conn, shape, weights, rod, law, memory, touches, held, slips, skew, slot, force,
        np.zeros((1, 3, 3)), np.zeros(6),
    )  # fmt: skip
    wanted = friction * pressure * min(part, 1.0) * area
    assert held[0, 0] == pytest.approx(pressure)
    assert force[0] @ across == pytest.approx(wanted)
    assert force[0] @ AXIS == pytest.approx(-pressure * area)
    assert slips[0, 0] @ across == pytest.approx(min(part, 1.0) * slip)
    h = 1e-9
    derivative = (energy_at(part * slip + h) - energy_at(part * slip - h)) / (2 * h)
    assert derivative == pytest.approx(wanted, rel=1e-5)


def test_coulomb_bound_and_no_tension() -> None:
    it, x = system(0.05)
    residual(it, x)
    assert (it._pressure >= 0).all()
    slip = np.linalg.norm(it._slip, axis=2)
    assert (slip <= it._law[1] * (1 + 1e-12)).all()  # at it, friction is at its limit
    assert (slip[it._pressure > 0] > 0).any()
    assert (slip[it._pressure == 0] == 0).all()
    it.move_to(-0.002)  # no contact
    residual(it, x)
    assert it.report[4] == 0.0
    assert np.abs(it.report[:3]).max() == 0.0
