"""Pokes as an objective: exact scale, first order in shape, its errors, its failures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import made_pokes as made
import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.parameters import parametrisation
from calibration.pokes import PokeObjective, objective
from calibration.search import Objective, Problem, identify, polish

DEPTH = np.linspace(0.0, 1e-3, 41)
LINE = 450.0 * DEPTH
QUICK: dict[str, Any] = {"refinement": 0.6, "workers": 1}


@pytest.fixture(scope="module")
def flat() -> PokeObjective:
    """A flat rod 1 mm deep, linearised."""
    pokes = PokeObjective([made.trial(DEPTH, LINE, depth_sd=1e-5)], **QUICK)
    assert pokes.linearise(made.SOFT)
    return pokes


def simulated(material: tisim.Material) -> tuple[np.ndarray, np.ndarray]:
    """Depth and force of that poke, by tisim alone."""
    scene = tisim.Poke(
        material=material,
        block=tisim.Block(size=(0.06, 0.06, 0.03)),
        depth=1e-3,
        frame_spacing=1e-3 / 6,
        refinement=0.6,
    )
    (result,) = tisim.simulate([scene], workers=1)
    assert result.ok
    return result.load, result.rod_force[:, 2]


def test_force_is_proportional_to_the_modulus(flat: PokeObjective) -> None:
    """Seven times as stiff, simulated anew, is what the known curves say."""
    stiff = tisim.material_from_moduli("neo-hookean", shear=7 * made.SHEAR, bulk=2100 * made.SHEAR)
    load, force = simulated(stiff)
    measured = flat.branches[0].depth
    at_frames = np.interp(load, measured, flat.forces(stiff))
    # the frames lie between measured points: interpolated, to a part of a per cent
    np.testing.assert_allclose(at_frames[1:], force[1:], rtol=3e-3)
    # both are solved to 5e-4 of the load, each on its own way (single precision in the far tissue's tangent)
    assert flat.check(stiff) < 5e-4
    np.testing.assert_allclose(flat.forces(stiff), 7 * flat.forces(made.SOFT), rtol=1e-12)


def test_residuals_are_data_less_model(flat: PokeObjective) -> None:
    """Chi-square under the whole covariance, computed from it and not by profiling."""
    objective: Objective = flat
    (row,) = objective.residuals([made.SOFT])
    assert row.shape == (objective.size(),)
    assert flat.size() == flat.points + len(flat.nuisance_names)
    assert flat._now is not None
    columns = flat._now.nuisances.columns
    white = (flat.branches[0].force - flat.forces(made.SOFT)) / flat.sd
    whole = np.eye(len(white)) + columns @ columns.T
    assert row @ row == pytest.approx(white @ np.linalg.solve(whole, white), rel=1e-8)
    assert row @ row < 0.5 * (white @ white)


def test_a_late_touch_is_a_nuisance(flat: PokeObjective) -> None:
    """Depths all 20 um short, where the lab's sd of the touch is 20 um: it is found, and costs less."""
    truth = flat.forces(made.SOFT)
    depth = flat.branches[0].depth
    late = made.trial(np.r_[0.0, depth - 2e-5], np.r_[0.0, truth], depth_sd=2e-5, force_sd=1e-4)
    blind = PokeObjective([late], touch_sd=0.0, **QUICK)
    seeing = PokeObjective([late], **QUICK)
    for pokes in (blind, seeing):
        assert pokes.linearise(made.SOFT)
    assert "touch of p1" in seeing.nuisance_names
    assert "touch of p1" not in blind.nuisance_names
    # measured shallower than it was: the true depth is more, so the nuisance is positive
    assert 0.3 < seeing.summary(made.SOFT)[1]["touch of p1"] < 1.2
    cost = [float((p.residuals([made.SOFT]) ** 2).sum()) for p in (blind, seeing)]
    assert cost[1] < cost[0]


def modulus_sd(pokes: PokeObjective) -> float:
    """sd of ln G at the G that fits best, K/G known."""
    best = (
        made.SHEAR * np.concatenate([b.force for b in pokes.branches]).sum() / pokes.forces(made.SOFT).sum()
    )
    pair = [
        tisim.material_from_moduli("neo-hookean", shear=g, bulk=300 * g) for g in (1.001 * best, 0.999 * best)
    ]
    up, down = pokes.residuals(pair)
    return float(0.002 / np.linalg.norm(up - down))


def test_many_pokes_do_not_average_the_mesh_away(flat: PokeObjective) -> None:
    """2.5 % at refinement 1 is 6.9 % at 0.6, one error of all pokes; what wanders does average."""
    two = [made.trial(DEPTH, LINE), made.trial(DEPTH, LINE, id="p2", start=(0.01, 0.0, 0.03))]
    pokes = PokeObjective(two, **QUICK)
    assert pokes.linearise(made.SOFT)
    assert pokes.simulated == 4
    alone, both = modulus_sd(flat), modulus_sd(pokes)
    assert 0.025 / 0.36 < both < alone < 1.5 * 0.025 / 0.36


def test_shape_is_first_order(flat: PokeObjective) -> None:
    """Another K/G, simulated anew: the derivative takes most of the difference."""
    other = tisim.material_from_moduli("neo-hookean", shear=made.SHEAR, bulk=40 * made.SHEAR)
    load, force = simulated(other)
    same = np.interp(load, flat.branches[0].depth, flat.forces(made.SOFT))
    found = np.interp(load, flat.branches[0].depth, flat.forces(other))
    assert np.abs(same[2:] / force[2:] - 1).max() > 0.015
    assert np.abs(found[2:] / force[2:] - 1).max() < 0.004


def test_curves_are_taken_again_only_where_the_shape_has_moved() -> None:
    pokes = PokeObjective([made.trial(DEPTH, LINE)], **QUICK)
    for shear, ratio, simulations in ((1e4, 300, 2), (1e6, 300, 2), (1e4, 310, 2), (1e4, 30, 4)):
        assert pokes.linearise(tisim.material_from_moduli("neo-hookean", shear=shear, bulk=shear * ratio))
        assert pokes.simulated == simulations


def test_repeats_share_a_simulation() -> None:
    first = made.trial(DEPTH, LINE)
    again = made.trial(DEPTH[:31], 1.01 * LINE[:31], id="p2")
    pokes = PokeObjective([first, again], **QUICK)
    assert pokes.linearise(made.SOFT)
    assert pokes.simulated == 2
    predicted = pokes.forces(made.SOFT)
    np.testing.assert_array_equal(predicted[:30], predicted[40:])
    assert pokes.points == 70


def test_modulus_of_a_hertzian_contact() -> None:
    """Hertz's closed form for a frictionless ball at 0.2 radii: within 6 %, the mesh's own error here, and
    within the interval; a fit without the mesh's error would claim 0.1 %."""
    soft = tisim.material_from_moduli("neo-hookean", shear=made.SHEAR, bulk=300 * made.SHEAR)
    depth = np.linspace(0.0, 5e-4, 51)
    rng = np.random.default_rng(0)
    force = made.hertz(depth, 0.0025, soft)
    block = tisim.Block(size=(0.15, 0.15, 0.08))
    ball = made.trial(
        depth,
        force + rng.normal(0.0, 1e-4, depth.shape),
        force_sd=1e-4,
        block=block,
        rod_tip="hemisphere",
        start=(0.0, 0.0, 0.08),
    )
    pokes = PokeObjective([ball], friction=0.0, refinement=0.7, workers=1)
    law = parametrisation("neo-hookean").holding("bulk_ratio")
    end = polish(Problem(parametrisation=law, objectives=(pokes,)), law.start(shear=8e3))
    assert end.converged
    known = identify(law, end.u, end.jacobian, reduced_chi2=end.cost / pokes.points).estimates[0]
    assert known.value == pytest.approx(made.SHEAR, rel=0.06)
    assert known.low < made.SHEAR < known.high
    assert 0.03 < known.sd < 0.08


def _cut(monkeypatch: pytest.MonkeyPatch, frames: int, *, which: slice) -> None:
    """Simulations that end after some frames, as one that does not converge does."""

    def simulate(scenes: Sequence[tisim.Scene], *, workers: int | None = None) -> list[tisim.Result]:
        results = tisim.simulate(scenes, workers=workers)
        for i in range(len(results))[which]:
            r = results[i]
            results[i] = replace(
                r,
                status=tisim.Status.NOT_CONVERGED,
                message="not-converged",
                load=r.load[:frames],
                rod_force=r.rod_force[:frames],
            )
        return results

    monkeypatch.setattr(objective, "simulate", simulate)


def test_a_poke_that_stops_early_is_used_as_far_as_it_came(monkeypatch: pytest.MonkeyPatch) -> None:
    _cut(monkeypatch, 3, which=slice(0, 1))
    pokes = PokeObjective([made.trial(DEPTH, LINE)], **QUICK)
    assert pokes.linearise(made.SOFT)
    assert pokes.points == 20
    (said,) = pokes.shortfalls
    assert said == "poke p1: not-converged at 0.50 of 1.00 mm; 20 measured points beyond it are not used"
    (row,) = pokes.residuals([made.SOFT])
    assert np.isfinite(row).all()
    assert (row[20:40] == 0.0).all()
    assert (row[:20] != 0.0).all()
    assert np.isnan(pokes.forces(made.SOFT)[20:]).all()


def test_a_derivative_that_stops_early_shortens_it_too(monkeypatch: pytest.MonkeyPatch) -> None:
    _cut(monkeypatch, 3, which=slice(1, 2))
    pokes = PokeObjective([made.trial(DEPTH, LINE)], **QUICK)
    assert pokes.linearise(made.SOFT)
    assert pokes.points == 20
    assert pokes.shortfalls[0].startswith("poke p1 (bulk_ratio moved): not-converged at 0.50 of 1.00 mm")


def test_a_poke_without_frames_is_no_answer(monkeypatch: pytest.MonkeyPatch, flat: PokeObjective) -> None:
    pokes = PokeObjective([made.trial(DEPTH, LINE)], **QUICK)
    with monkeypatch.context() as patch:
        _cut(patch, 0, which=slice(None))
        assert not pokes.linearise(made.SOFT)
    assert [r.reached for r in pokes.runs] == [0.0, 0.0]
    assert "at 0.00 of 1.00 mm; 40 measured points" in pokes.shortfalls[0]
    with pytest.raises(RuntimeError, match="linearise a PokeObjective"):
        pokes.residuals([made.SOFT])
    # curves known before stay
    before = flat.forces(made.SOFT)
    with monkeypatch.context() as patch:
        _cut(patch, 0, which=slice(None))
        assert not flat.linearise(tisim.material_from_moduli("neo-hookean", shear=1e4, bulk=5e4))
    np.testing.assert_array_equal(flat.forces(made.SOFT), before)
    assert flat.linearise(made.SOFT)


def test_other_laws_have_curves_of_their_own() -> None:
    """Mooney-Rivlin without its second constant is Neo-Hookean but for the volume: the same force."""
    pokes = PokeObjective([made.trial(DEPTH, LINE)], **QUICK)
    assert pokes.linearise(made.SOFT)
    mooney = parametrisation("mooney-rivlin").material([np.log(made.SHEAR), np.log(300.0), 0.0])
    with pytest.raises(RuntimeError, match="mooney-rivlin"):
        pokes.forces(mooney)
    assert pokes.linearise(mooney)
    np.testing.assert_allclose(pokes.forces(mooney), pokes.forces(made.SOFT), rtol=2e-3)


def test_what_cannot_be_simulated_is_refused(tmp_path: Any) -> None:
    with pytest.raises(InputError, match=r"trial p1: inclusion.mesh: expected a sphere, box or cylinder"):
        PokeObjective([made.trial(DEPTH, LINE, inclusion_mesh=tmp_path / "x.stl")])
    near_edge = PokeObjective([made.trial(DEPTH, LINE, start=(0.0295, 0.0, 0.03))], **QUICK)
    with pytest.raises(InputError, match=r"pokes p1: scene 0: poke site"):
        near_edge.linearise(made.SOFT)


@pytest.mark.slow
@pytest.mark.parametrize("tip", ["flat", "hemisphere"])
def test_recovery_from_a_finer_simulation(tip: str) -> None:
    """Made by tisim itself at refinement 2 and another K/G: G within its 95 % interval, chi-square sound."""
    truth = tisim.material_from_moduli("neo-hookean", shear=18e3, bulk=18e3 * 120)
    scene = tisim.Poke(
        material=truth,
        block=tisim.Block(size=(0.06, 0.06, 0.03)),
        rod=tisim.Rod(tip=tip),  # type: ignore[arg-type]
        depth=3e-3,
        frame_spacing=1e-4,
        refinement=2.0,
    )
    (result,) = tisim.simulate([scene])
    assert result.ok
    rng = np.random.default_rng(5)
    force = result.rod_force[:, 2] + rng.normal(0.0, 2e-3, result.load.shape)
    depth = result.load - 1e-5 + rng.normal(0.0, 1e-5, result.load.shape)
    data = made.trial(depth, force, rod_tip=tip, force_sd=2e-3, depth_sd=1e-5)
    pokes = PokeObjective([data])
    law = parametrisation("neo-hookean").holding("bulk_ratio")
    end = polish(Problem(parametrisation=law, objectives=(pokes,)), law.start(shear=5e4))
    assert end.converged
    assert end.cost < 2.0 * pokes.points
    known = identify(law, end.u, end.jacobian, reduced_chi2=end.cost / pokes.points).estimates[0]
    print(tip, known.value, known.low, known.high, end.cost, pokes.points)
    assert known.low < 18e3 < known.high
    assert known.sd < 0.04


@pytest.mark.slow
def test_a_law_that_breaks_down_says_how_far_it_came() -> None:
    """St Venant-Kirchhoff under a rod turns its elements over at 2 mm."""
    depth = np.linspace(0.0, 4e-3, 41)
    brittle = tisim.material_from_moduli("st-venant-kirchhoff", shear=made.SHEAR, bulk=20 * made.SHEAR)
    pokes = PokeObjective([made.trial(depth, 450.0 * depth)], **QUICK)
    assert pokes.linearise(brittle)
    assert 0 < pokes.points < 35
    assert any("of 4.00 mm" in s for s in pokes.shortfalls)
