"""Pokes that differ only by a modulus share one solve, with proportional forces, marked in the store."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

from factory import open_dataset, verify_dataset
from factory.building.build import build_dataset
from factory.checks.verification import one_solve as one_solve_faults
from factory.plan import Plan
from factory.plan.shared_solves import modulus_ratio, one_solve, scale_with_modulus
from factory.store.staging import Staging
from tests.factory.conftest import Builder
from tisim import Material, Prony, laws, simulate


@pytest.mark.parametrize("name", laws.names())
def test_a_material_and_its_multiple(name: str) -> None:
    law = laws.get(name)
    soft, hard = (Material(law=name, parameters=law.from_moduli(g, 20.0 * g)) for g in (1e4, 2.5e4))
    assert modulus_ratio(hard, soft) == pytest.approx(2.5)
    assert modulus_ratio(soft, hard) == pytest.approx(0.4)
    stiffer = Material(law=name, parameters=law.from_moduli(2.5e4, 21.0 * 2.5e4))
    assert modulus_ratio(stiffer, soft) is None  # another ratio of bulk to shear modulus
    assert modulus_ratio(hard, replace(soft, viscosity=Prony(fractions=(0.1,), times=(1.0,)))) is None


def test_another_shape_of_the_law_is_no_multiple() -> None:
    """All moduli are twice as large, but a dimensionless parameter differs."""
    law = laws.get("stiffening-neo-hookean")
    soft = {"mu": 1e4, "stiffening": 0.2, "lam": 2e5}
    for stiffening, factor in ((0.2, 2.0), (0.3, None)):
        hard = {"mu": 2e4, "stiffening": stiffening, "lam": 4e5}
        assert law.moduli(hard).shear_modulus == pytest.approx(2.0 * law.moduli(soft).shear_modulus)
        found = modulus_ratio(*(Material(law=law.name, parameters=p) for p in (hard, soft)))
        assert found == (factor and pytest.approx(factor))


def test_levels_scale_with_the_modulus_unless_something_else_acts(quick: Plan) -> None:
    scenes = [poke.scene for poke in quick.pokes]
    assert scale_with_modulus(scenes)
    heavy = replace(scenes[0], gravity=(0.0, 0.0, -9.81))
    assert not scale_with_modulus([*scenes, heavy])
    law = laws.get("ogden")
    other = Material(law="ogden", parameters=law.from_moduli(1e4, 5e5))
    assert not scale_with_modulus([*scenes, replace(scenes[0], material=other)])
    relaxing = replace(scenes[0].material, viscosity=Prony(fractions=(0.1,), times=(1.0,)))
    assert not scale_with_modulus([replace(scenes[0], material=relaxing)])


def test_only_the_modulus_may_differ(quick: Plan) -> None:
    first, *others = (p for p in quick.pokes if p.shape == 0 and p.shared)
    assert [p.solved_as for p in others] == [first.index, first.index]
    assert not any(p.derived for p in quick.pokes if not p.shared)
    assert [p.force_factor for p in others] == pytest.approx([0.48358, 0.29922], rel=1e-4)
    pulled = [replace(p, scene=replace(p.scene, gravity=(0.0, 0.0, -9.81))) for p in (first, others[0])]
    assert not any(p.derived for p in one_solve([replace(p, solved_as=-1) for p in pulled]))
    rougher = replace(others[0], solved_as=-1, scene=replace(others[0].scene, friction=0.5))
    assert not any(p.derived for p in one_solve([first, rougher]))


def test_the_same_solve_by_the_solver_itself(quick: Plan) -> None:
    """One shallow poke in two materials, both simulated."""
    first, other, _ = (p for p in quick.pokes if p.shape == 0 and p.shared)
    shallow = [replace(p.scene, depth=1e-3, frame_spacing=5e-4, refinement=0.5) for p in (first, other)]
    a, b = simulate(shallow, workers=1)
    assert a.rod_force is not None
    assert b.rod_force is not None
    assert len(a.positions) == len(b.positions) == 2
    np.testing.assert_allclose(b.positions, a.positions, atol=2e-7)
    np.testing.assert_allclose(b.rod_force, other.force_factor * a.rod_force, rtol=1e-3, atol=1e-5)


def test_the_store_says_whose_solve_a_poke_takes(quick_store: Path) -> None:
    data = open_dataset(quick_store)
    own = np.arange(data.n_pokes)
    taken = np.flatnonzero(data.table["solved_as"] != own)
    assert len(taken) == 4
    for index in taken:
        other, factor = data.table["solved_as"][index], data.table["force_factor"][index]
        rows, its = data.rows(int(index), "frame"), data.rows(int(other), "frame")
        np.testing.assert_array_equal(data.table["rod_force"][rows], factor * data.table["rod_force"][its])
        assert data.table["newton_iterations"][index] == 0 < data.table["newton_iterations"][other]
    assert verify_dataset(quick_store).total == 0


def test_a_store_whose_forces_are_not_in_proportion(
    quick: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(quick, target)
    data = open_dataset(target)
    index = int(np.flatnonzero(data.table["solved_as"] != np.arange(data.n_pokes))[0])
    row = data.rows(index, "frame").start
    for name in ("rod_force", "base_force"):
        array = zarr.open_array(target / name, mode="r+")
        array[row] = 1.001 * np.asarray(array[row])
    (fault,) = verify_dataset(target).faults["solves taken over"]
    assert f"poke {index}: is not" in fault


@pytest.mark.parametrize(("name", "count"), [("surface_displacement", "value"), ("base_force", "frame")])
def test_a_store_whose_surfaces_are_not_those_of_the_solve(
    quick: Plan, standin_build: Builder, tmp_path: Path, name: str, count: Any
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(quick, target)
    data = open_dataset(target)
    index = int(np.flatnonzero(data.table["solved_as"] != np.arange(data.n_pokes))[0])
    rows = data.rows(index, count)
    array = zarr.open_array(target / name, mode="r+")
    array[rows] = 1.005 * np.asarray(array[rows]) + 1e-9
    (fault,) = verify_dataset(target).faults["solves taken over"]
    assert f"poke {index}: is not" in fault


def test_what_a_stopped_build_has_solved_is_not_solved_again(
    quick: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = tmp_path / "log"
    monkeypatch.setenv("STANDIN_LOG", str(log))
    target, reference = tmp_path / "a.zarr", tmp_path / "b.zarr"
    standin_build(quick, reference)
    solves = sum(not p.derived for p in quick.pokes)
    assert len(log.read_text().splitlines()) == solves == 8

    def stop(state: object) -> None:
        if state.outcome is not None:  # type: ignore[attr-defined]
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        standin_build(quick, target, on_progress=stop)
    assert Staging(target).finished() == {0}
    standin_build(quick, target)
    assert len(log.read_text().splitlines()) == 2 * solves
    assert open_dataset(target).attributes["fingerprint"] == open_dataset(reference).attributes["fingerprint"]
    for name in ("rod_force", "grid_displacement", "done"):
        np.testing.assert_array_equal(open_dataset(target).read(name), open_dataset(reference).read(name))


def test_a_partial_store_has_the_pokes_of_each_solve_that_it_has(
    quick: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    """A build that is killed between a solve and the pokes that take it, then --partial."""

    def stop(state: object) -> None:
        if state.outcome is not None:  # type: ignore[attr-defined]
            raise KeyboardInterrupt

    target = tmp_path / "a.zarr"
    with pytest.raises(KeyboardInterrupt):
        standin_build(quick, target, on_progress=stop)
    assert Staging(target).finished() == {0}
    taken = {p.index for p in quick.pokes if p.solved_as == 0}
    build_dataset(quick, target, partial=True)
    data = open_dataset(target)
    assert set(np.flatnonzero(data.table["done"])) == {0, *taken}
    assert data.attributes["pokes_done"] == 1 + len(taken) == 3
    assert verify_dataset(target).faults["solves taken over"] == []


def test_a_poke_that_is_not_done_is_no_fault_of_its_solve(
    quick: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    target = tmp_path / "a.zarr"
    standin_build(quick, target)
    data = open_dataset(target)
    index = int(np.flatnonzero(data.table["solved_as"] != np.arange(data.n_pokes))[-1])
    data.table["done"][index] = False
    data.table["frame_count"][index] = 0
    assert one_solve_faults(data) == []
