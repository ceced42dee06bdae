"""Stored frames are equilibria, checked by an assembly that shares no code with the solver."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from factory.checks import equilibrium
from factory.checks.equilibrium import NotCheckedError, check_assembly, check_poke, nodal_forces
from factory.checks.interior import Interior
from factory.reader import Dataset, open_dataset
from factory.store.poke_data import PokeData
from factory.verify import app
from tests.factory.conftest import TINY, run_app, simulate_here
from tisim import Block, Rod
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.inclusions.sphere import SphereInclusion
from tisim.mesh.indentation import poke_mesh

Change = Callable[[PokeData], PokeData]

COARSE = (
    TINY.replace("depth_mm: 30, frame_spacing_mm: 1", "depth_mm: 1, frame_spacing_mm: 0.5")
    .replace("friction: 0.6", "friction: 0.3")  # the mesh depends on it
    .replace("own_sites: 2", "own_sites: 1")
    .replace("softness: [S0, S1]", "softness: [S0]\nrefinement: 0.5")
)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One poke to 1 mm, simulated by tisim."""
    return simulate_here(COARSE, tmp_path_factory.mktemp("assembly"))


@pytest.mark.parametrize("law", ["ogden", "stable-neo-hookean", "st-venant-kirchhoff", "neo-hookean"])
def test_nodal_forces_are_the_solvers(law: str) -> None:
    from factory.materials import load_card

    material = load_card("S0.5").for_law(law)
    mesh = poke_mesh(
        block=Block(
            size=(0.1, 0.1, 0.032), inclusion=SphereInclusion(radius=0.009, centre=(0.012, 0.0, 0.007))
        ),
        site=(0.0, 0.0),
        rod=Rod(radius=2.5e-3, length=0.04, tip="flat", edge_radius=1e-3),
        refinement=0.5,
    )
    random = np.random.default_rng(4)
    shear = np.eye(3) + 0.15 * random.uniform(-1, 1, (3, 3))
    x = mesh.nodes @ shear.T + 2e-5 * random.standard_normal(mesh.nodes.shape)
    body = DiscretisedBody(Discretisation.build(mesh, mesh.node_sets["base"]), material)
    expected, least = body.internal_forces(x)
    assert least > 0.3
    error = np.abs(nodal_forces(mesh, material, x) - expected).max()
    assert error < 1e-9 * np.abs(expected).max()


def test_a_simulated_poke_is_an_equilibrium(simulated: Path) -> None:
    found = list(check_poke(open_dataset(simulated), 0))
    assert len(found) == 2
    tolerance = 5e-4  # tolerance of the solver
    assert [frame.faults(tolerance) for frame in found] == [[], []]
    assert max(frame.free for frame in found) < tolerance


def _change(monkeypatch: pytest.MonkeyPatch, change: Change) -> None:
    """Let a dataset's pokes be read with a change."""
    whole = Dataset.poke
    monkeypatch.setattr(Dataset, "poke", lambda data, index: change(whole(data, index)))


def _lifted(poke: PokeData) -> PokeData:
    """Raise a corner of the top by 0.01 mm in the second frame."""
    surface = poke.surface.copy()
    surface[1, np.argmax(poke.surface_rest @ [1.0, 1.0, 10.0])] += [0.0, 0.0, 1e-5]
    return dataclasses.replace(poke, surface=surface)


def test_a_step_that_turns_elements_over_is_taken_in_part(simulated: Path) -> None:
    """Newton's step, ten times as long: the part that brings the interior nearest to equilibrium first."""
    data = open_dataset(simulated)
    mesh, poke = equilibrium._mesh(data, 0), data.poke(0)
    surface = np.unique(mesh.facet_sets["surface"])
    moved = poke.surface - poke.surface_rest
    inside = Interior(
        mesh, equilibrium._material(data, 0), surface, moved, np.full(2, 1e-5), balanced=lambda *_: True
    )
    at_rest = next(iter(inside))
    body, solver, free = inside._body, inside._discretisation.solver, inside._free
    away = at_rest.copy()
    away[free] += 1e-6 * np.random.default_rng(1).standard_normal((len(at_rest), 3))[free]
    blocks, force, _ = body.stiffness(away)
    solver.factorise(blocks)
    step, left = solver.solve(force[free]), float(np.linalg.norm(force[free]))
    found = inside._nearer(away, 10 * step, left)
    assert found is not None
    there, forces, size = found
    assert size == pytest.approx(np.linalg.norm(forces[free]))
    assert size == pytest.approx(0.25 * left, rel=0.1)
    np.testing.assert_allclose(there[free], (away[free] - 1.25 * step), atol=1e-12)
    assert inside._nearer(away, -step, left) is None
    # a whole step that leaves nothing, but turns an element over; half of it does not
    answers = iter([(0 * force, -0.1), (0.5 * force, 0.2)])
    inside._body = SimpleNamespace(internal_forces=lambda _: next(answers))  # type: ignore[assignment]
    half = inside._nearer(away, step, left)
    assert half is not None
    np.testing.assert_allclose(half[0][free], away[free] - 0.5 * step, atol=1e-15)


@pytest.mark.parametrize(
    ("places", "balanced", "ends_at", "steps"),
    [
        ([1.0], [True], 1.0, [1.0]),
        ([1.0, 2.0, 3.0], [False, True], 3.0, [1.0, 0.5, 1.0]),  # another one, in two steps
        ([1.0, 2.0, 1.0], [False, False], 1.0, [1.0, 0.5, 1.0]),  # found again
        ([1.0, None, 2.0, 3.0, 4.0, 5.0], [False, True], 5.0, [1.0, 0.5, 0.25, 0.5, 0.75, 1.0]),
    ],
)
def test_another_interior_equilibrium_is_sought_while_the_forces_do_not_balance(
    simulated: Path,
    monkeypatch: pytest.MonkeyPatch,
    places: list[float | None],
    balanced: list[bool],
    ends_at: float,
    steps: list[float],
) -> None:
    """Where Newton's method ends (all nodes at `places`) depends on the length of the surface's steps."""
    data = open_dataset(simulated)
    mesh = equilibrium._mesh(data, 0)
    surface = np.unique(mesh.facet_sets["surface"])
    moved = np.ones((1, len(surface), 3))
    answers, found, aims = iter(balanced), iter(places), []

    def step(_self: Interior, x: np.ndarray, aim: np.ndarray, _: float) -> np.ndarray | None:
        aims.append(float(aim[0, 0]))
        place = next(found)
        return None if place is None else np.full_like(x, place)

    monkeypatch.setattr(Interior, "_step", step)
    inside = Interior(
        mesh, equilibrium._material(data, 0), surface, moved, np.full(1, 1e-5),
        balanced=lambda *_: next(answers),
    )  # fmt: skip
    assert (next(iter(inside)) == ends_at).all()
    assert aims == steps


@pytest.mark.parametrize(
    ("change", "frames", "fault"),
    [
        (_lifted, [1], "forces on the free surface"),
        (lambda p: dataclasses.replace(p, rod_force=1.02 * p.rod_force), [0, 1], "less the rod's force"),
        (lambda p: dataclasses.replace(p, base_force=0.98 * p.base_force), [0, 1], "less the base's force"),
        (
            lambda p: dataclasses.replace(p, rod_tip=p.rod_tip + 2e-3 * np.eye(3)[2]),
            [0, 1],
            "on the free surface",
        ),
    ],
)
def test_what_is_no_equilibrium_is_a_fault(
    simulated: Path, monkeypatch: pytest.MonkeyPatch, change: Change, frames: list[int], fault: str
) -> None:
    _change(monkeypatch, change)
    found = list(check_poke(open_dataset(simulated), 0))
    assert [f.frame for f in found if any(fault in text for text in f.faults(5e-4))] == frames


def test_a_surface_that_holds_no_equilibrium_is_counted(
    simulated: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frames before it are checked; it may be wrong, so that the command does not end with 0."""

    def folded(poke: PokeData) -> PokeData:
        surface = poke.surface.copy()
        surface[1, np.argmax(poke.surface_rest @ [1.0, 1.0, 10.0])] -= [0.0, 0.0, 0.02]
        return dataclasses.replace(poke, surface=surface)

    _change(monkeypatch, folded)
    monkeypatch.setattr(equilibrium, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1))
    found = check_assembly(open_dataset(simulated), pokes=1, workers=1)
    assert (found.pokes, found.frames, found.faults, found.no_interior) == (1, 1, [], {0: 1})
    done = run_app(app, simulated, "--assembly", "--pokes", 1)
    assert done.exit_code == 1
    assert "poke 0: no equilibrium was found inside the surface of frame 1" in done.output


def test_a_rod_that_has_been_retracted_presses_with_nothing(
    simulated: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second frame at rest, as after an elastic retraction."""

    def released(poke: PokeData) -> PokeData:
        surface, forces = poke.surface.copy(), {}
        surface[1] = poke.surface_rest
        for name in ("rod_force", "base_force"):
            forces[name] = getattr(poke, name) * [[1.0], [0.0]]
        tip = poke.rod_tip - [[0.0], [5e-3]] * poke.direction
        return dataclasses.replace(poke, surface=surface, rod_tip=tip, **forces)

    _change(monkeypatch, released)
    found = list(check_poke(open_dataset(simulated), 0))
    assert [frame.faults(5e-4) for frame in found] == [[], []]


def test_another_mesh_and_other_materials_are_said_not_to_be_checked(
    simulated: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = open_dataset(simulated)
    whole = equilibrium.poke_mesh
    with monkeypatch.context() as patch:
        patch.setattr(equilibrium, "poke_mesh", lambda **k: whole(**{**k, "refinement": 0.7}))
        with pytest.raises(NotCheckedError, match="not the one that this version of tisim makes"):
            next(check_poke(data, 0))
    stated = data.attributes["identity"]["materials"]["S0"]
    monkeypatch.setitem(stated, "viscosity", {"kind": "prony"})
    with pytest.raises(NotCheckedError, match="has viscosity beside its law"):
        next(check_poke(data, 0))


def test_the_command_counts_what_it_checked(simulated: Path) -> None:
    done = run_app(app, simulated, "--assembly", "--pokes", 1, "--workers", 1)
    assert done.exit_code == 0, done.output
    assert "1 poke, 2 frames: no fault; next: equilibrium by assembly" in done.output
    assert "equilibrium by assembly of 1 poke, 2 frames: 0 faults" in done.output
    refused = run_app(app, simulated, "--pokes", 1)
    assert refused.exit_code == 2
    assert "--pokes and --workers: expected with --assembly" in refused.output


def test_pokes_that_cannot_be_checked_are_listed(
    finished_store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The meshes of the stand-in are not tisim's."""
    monkeypatch.setattr(equilibrium, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1))
    found = check_assembly(open_dataset(finished_store), pokes=2, workers=1)
    assert (found.pokes, found.frames, found.faults, found.largest) == (0, 0, [], None)
    assert len(found.not_checked) == 2
    done = run_app(app, finished_store, "--assembly", "--pokes", 1, "--workers", 1)
    assert done.exit_code == 1
    assert "poke 0 is not checked: its mesh is not the one" in done.output
