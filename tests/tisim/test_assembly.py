"""Internal forces and stiffness blocks against finite differences; fixed components; both direct solvers."""

import numpy as np
import pytest
from static_cases import awkward, body_of

from tisim.linear import direct
from tisim.linear.direct import DirectSolver
from tisim.problems.beam.solve import solve_beam
from tisim.scene import Beam

CASES = [
    ("tet4", "neo-hookean", 50.0),
    ("tet10", "neo-hookean", 50.0),
    ("tet10", "ogden", 1000.0),
    ("tet10", "st-venant-kirchhoff", 50.0),
    ("hex8", "stable-neo-hookean", 50.0),
    ("hex8", "arruda-boyce", 50.0),
    ("hex8", "mooney-rivlin", 1000.0),
    ("hex20", "ogden", 300.0),
]


def case(kind, law, ratio, *, held=False, cells=(2, 1, 1)):
    """A body with two fixed nodes and a random strain of up to 10 %; `held`: with some fixed components."""
    mesh = awkward(kind, cells)
    rng = np.random.default_rng(7)
    components = (rng.uniform(size=(mesh.n_nodes, 3)) < 0.2) if held else None
    body = body_of(mesh, law, [0, 5], ratio=ratio, held=components)
    strain = np.eye(3) + 0.1 * rng.uniform(-1, 1, (3, 3))
    return body, mesh.nodes @ strain + rng.uniform(-2e-4, 2e-4, mesh.nodes.shape)


def dense(body, blocks):
    """Assemble the full symmetric matrix (3 n_free, 3 n_free) from its upper blocks."""
    p = body.discretisation.pattern
    n = len(p.free)
    K = np.zeros((n, 3, n, 3))
    rows = np.repeat(np.arange(n), np.diff(p.indptr))
    K[rows, :, p.indices, :] = blocks
    K[p.indices, :, rows, :] = np.swapaxes(blocks, 1, 2)  # diagonal blocks are symmetric
    return K.reshape(3 * n, 3 * n)


def hessian(body, x, h=1e-7):
    """Central differences of the internal forces with respect to the free nodes."""
    free = body.discretisation.pattern.free
    columns = []
    for node in free:
        for axis in range(3):
            step = np.zeros_like(x)
            step[node, axis] = h
            up, down = body.internal_forces(x + step)[0], body.internal_forces(x - step)[0]
            columns.append((up - down)[free].ravel() / (2 * h))
    return np.array(columns).T


@pytest.mark.parametrize(("kind", "law", "ratio"), CASES)
def test_forces_are_the_slope_of_the_energy(kind, law, ratio):
    body, x = case(kind, law, ratio)
    body.dead_load = np.random.default_rng(0).normal(size=x.shape)
    wanted, h = body.internal_forces(x)[0] - body.dead_load, 1e-6
    for node, axis in np.random.default_rng(1).integers((0, 0), (len(x), 3), (12, 2)):
        step = np.zeros_like(x)
        step[node, axis] = h
        slope = (body.energy(x + step)[0] - body.energy(x - step)[0]) / (2 * h)
        assert slope == pytest.approx(wanted[node, axis], abs=1e-6 * np.abs(wanted).max())
    assert body.stiffness(x)[1] == pytest.approx(body.internal_forces(x)[0], rel=1e-10)


@pytest.mark.parametrize(("kind", "law", "ratio"), CASES)
def test_blocks_are_the_hessian_of_the_energy(kind, law, ratio):
    body, x = case(kind, law, ratio)
    if kind in ("hex8", "hex20"):
        conn = body.discretisation.mesh.elements
        assert (np.diff(np.sort(conn, axis=1), axis=1) == 0).any()  # wedges are among them
    blocks = body.stiffness(x)[0]
    K = dense(body, blocks)
    assert np.abs(K - hessian(body, x)).max() < 1e-6 * np.abs(K).max()
    diagonal = blocks[body.discretisation.pattern.indptr[:-1]]
    assert np.abs(diagonal - np.swapaxes(diagonal, 1, 2)).max() < 1e-12 * np.abs(K).max()


@pytest.mark.parametrize("kind", ["tet10", "hex8", "hex20"])
def test_held_components_leave_the_system(kind):
    body, x = case(kind, "neo-hookean", 50.0, held=True)
    blocks = body.stiffness(x)[0]
    full = dense(body, blocks)
    body.discretisation.hold(blocks)
    held = body.discretisation.held.ravel()
    assert 3 < held.sum() < held.size / 2
    K = dense(body, blocks)
    assert np.array_equal(K[~held][:, ~held], full[~held][:, ~held])
    assert not K[held][:, ~held].any()
    scale = K[held][:, held]
    assert np.array_equal(scale, np.diag(np.full(held.sum(), scale[0, 0])))
    assert scale[0, 0] > 0


@pytest.mark.parametrize("pardiso", [True, False])
@pytest.mark.parametrize("kind", ["tet10", "hex8"])
def test_both_solvers_solve_and_refactorise(kind, pardiso, monkeypatch):
    if pardiso and not direct.HAVE_PARDISO:
        pytest.skip("MKL is not here")
    monkeypatch.setattr(direct, "HAVE_PARDISO", pardiso)
    body, x = case(kind, "neo-hookean", 50.0, held=True)
    p = body.discretisation.pattern
    solver = DirectSolver(p.indptr, p.indices)
    for scale in (1.0, 3.0):
        blocks = scale * body.stiffness(x)[0]
        body.discretisation.hold(blocks)
        rhs = np.random.default_rng(2).normal(size=(len(p.free), 3))
        solver.factorise(blocks)
        found = solver.solve(rhs)
        K = dense(body, blocks)
        assert np.abs(K @ found.ravel() - rhs.ravel()).max() < 1e-9
    if pardiso:
        assert solver.negative == (np.linalg.eigvalsh(K) < 0).sum()


def test_beam_is_the_same_without_pardiso(monkeypatch):
    from static_cases import neo_hookean

    scene = Beam(material=neo_hookean(2e4, 1000.0), length=0.05)
    fast = solve_beam(scene)
    monkeypatch.setattr(direct, "HAVE_PARDISO", False)
    # a separate mesh object has its own discretisation, and so its own solver
    slow = solve_beam(Beam(material=scene.material, length=0.05, mesh=fast.mesh))
    assert fast.ok
    assert slow.ok
    assert (
        np.abs(fast.positions - slow.positions).max() < 1e-6 * np.abs(fast.positions - fast.mesh.nodes).max()
    )
