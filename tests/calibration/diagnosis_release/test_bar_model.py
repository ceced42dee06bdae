"""The reduced beam against beam theory, the model's derivatives and folds, and unusable input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from release_models import bar_model

from benchmarks.blind.release import DENSITY, GRAVITY, HEIGHT, LENGTH, WIDTH, Truth, write_bars
from calibration.diagnosis import model_of
from calibration.diagnosis.effects.release import EFFECTS
from calibration.errors import InputError
from calibration.experiment import read
from calibration.measurements._state import State
from calibration.measurements.release._beam import BeamParameters, ReducedBeam
from calibration.measurements.release._vibration import beam_markers, free_vibration
from calibration.measurements.release.model import ReleaseModel
from tisim import Rectangle

BEAM = BeamParameters(
    section=Rectangle(width=WIDTH, height=HEIGHT),
    shear_modulus=6e5,
    density=DENSITY,
    length=LENGTH,
    relaxation_time=4e-4,
)


def test_small_loads_bend_it_as_timoshenko_says() -> None:
    young, inertia, area = 3.0 * 6e5, WIDTH * HEIGHT**3 / 12.0, WIDTH * HEIGHT
    light = replace(BEAM, gravity=(0.0, -1e-6 * GRAVITY))
    q = ReducedBeam(light).equilibrium()
    tip = beam_markers(light, q[None], [(LENGTH, 0.0)]).displacement[0, 0, 1]
    line = 1e-6 * DENSITY * area * GRAVITY
    expected = line * LENGTH**4 / (8.0 * young * inertia) + line * LENGTH**2 / (
        2.0 * (15.0 / 17.5) * 6e5 * area
    )
    assert -tip == pytest.approx(expected, rel=1e-6)


def test_a_slender_bar_swings_as_euler_says() -> None:
    thin = replace(BEAM, section=Rectangle(width=WIDTH, height=1e-3), shear_modulus=1e9)
    young, inertia, area = 3e9, WIDTH * 1e-9 / 12.0, WIDTH * 1e-3
    first = 1.8751040687**2 / LENGTH**2 * np.sqrt(young * inertia / (DENSITY * area)) / (2.0 * np.pi)
    assert free_vibration(thin).frequencies[0] == pytest.approx(first, rel=2e-3)


def test_the_elastica_under_an_end_load() -> None:
    """F L^2 / EI = 1: Bisshopp and Drucker (1945), drop 0.3017 L and shortening 0.0564 L."""
    thin = replace(BEAM, section=Rectangle(width=WIDTH, height=1e-3), shear_modulus=1e9, gravity=(0.0, 0.0))
    force = 3e9 * WIDTH * 1e-9 / 12.0 / LENGTH**2
    bent = replace(thin, tip_force=(0.0, -force))
    tip = beam_markers(bent, ReducedBeam(bent).equilibrium()[None], [(LENGTH, 0.0)]).displacement[0, 0]
    assert tip / LENGTH == pytest.approx([-0.0564, -0.3017], abs=1e-3)


def test_zero_is_the_baseline_and_more_is_not(tmp_path: Path) -> None:
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False, further=True)
    state = State(u=model.start())
    model.update_nuisances(state)
    base = model.residuals([state])[0]
    assert {c.effect for c in model.candidates} == set(EFFECTS)
    for name, effect in EFFECTS.items():
        assert effect.bounds[0] <= 0.0 < effect.bounds[1]
        assert 0.0 < effect.step < effect.prior_scale <= effect.bounds[1]
        candidate = next(c for c in model.candidates if c.effect == name)
        none, some = model.residuals(
            [State(u=state.u, amplitudes={candidate: a}) for a in (0.0, 0.1 * effect.prior_scale)]
        )
        assert none == pytest.approx(base, abs=1e-9), name
        assert np.abs(some - base).max() > 1e-3, name


def test_derivatives_are_those_of_the_residuals(tmp_path: Path) -> None:
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False)
    state = State(u=model.start())
    model.update_nuisances(state)
    linear = model.linearise(state, model.candidates)
    step = 1e-4 * np.ones(len(model.names))
    there, back = model.residuals([State(u=state.u + step), State(u=state.u - step)])
    assert (there - back) / 2.0 == pytest.approx(linear.by_u @ step, abs=2e-3)
    for k, c in enumerate(model.candidates):
        small = 1e-3 * EFFECTS[c.effect].prior_scale
        (moved,) = model.residuals([State(u=state.u, amplitudes={c: small})])
        column = linear.columns[:, k] * small
        assert moved - linear.z == pytest.approx(column, abs=0.05 * np.abs(column).max()), c.label


def test_a_swing_out_of_step_has_no_answer(tmp_path: Path) -> None:
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False)
    state = State(u=model.start())
    model.update_nuisances(state)
    slow = state.u.copy()
    slow[0] += np.log(0.8)
    assert np.isnan(model.residuals([State(u=slow)])).all()


def test_parts_keep_the_coordinates(tmp_path: Path) -> None:
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False)
    state = State(u=model.start())
    model.update_nuisances(state)
    families = model.folds()
    assert list(families) == ["leave-one-load-out", "vibration-or-equilibrium-out"]
    for groups in families.values():
        parts = [model.subset(group, others=False) for _, group in groups]
        assert sum(p.points for p in parts) == model.points
        for p, (_, group) in zip(parts, groups, strict=True):
            assert len(p.residuals([state])[0]) == int(model.rows(group).sum()) + len(model.names) - 1
    left_out = dict(families["leave-one-load-out"])["10 g hung"]
    unseen = [n for n, hit in zip(model.names, model.unconstrained(left_out), strict=True) if hit]
    assert unseen == ["run-1 release", "run-1 start", "error with 10 g hung"]


def test_markers_make_it_a_bar(tmp_path: Path) -> None:
    experiment = read(write_bars(tmp_path / "e", Truth()))
    assert isinstance(model_of(experiment), ReleaseModel)
    with pytest.raises(InputError, match="--kind coupons: the experiment has none"):
        model_of(experiment, kind="coupons")
    with pytest.raises(InputError, match="--without skin: expected some of clamp-compliance"):
        model_of(experiment, without=["skin"])
    with pytest.raises(InputError, match="only outlines are simulated in several ways"):
        model_of(experiment, simulator="early-stop")


def test_names_of_earlier_versions_are_understood(tmp_path: Path) -> None:
    """`radius`, ambiguous among models, is now `section-scale`; `relaxation-branch` is `relaxation`."""
    experiment = read(write_bars(tmp_path / "e", Truth()))
    model = model_of(experiment, kind="bars", without=["radius", "relaxation-branch"])
    assert set(EFFECTS) - set(model.effects) == {"section-scale", "relaxation"}
    assert not {"radius", "relaxation-branch"} & set(EFFECTS)


def test_a_record_states_its_groups_and_ranges(tmp_path: Path) -> None:
    own, hung = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False).records
    assert hung.groups == {"material": "S0", "specimen": "S0", "load": "10 g hung", "trial": "run-1"}
    assert own.groups["load"] == "own weight"
    assert own.ranges["free_length_mm"] == pytest.approx((100.0, 100.0))
    assert own.ranges["time_s"] == pytest.approx((1.595, 1.595))


def test_a_record_without_an_answer_leaves_the_others(tmp_path: Path) -> None:
    """An effect that leaves one beam without a solution does not change the rows of other records."""
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), fem=False)
    state = State(u=model.start())
    heavy = next(c for c in model.candidates if (c.effect, c.at) == ("added-mass", "10 g hung"))
    misfit = model._misfit([State(u=state.u, amplitudes={heavy: 30.0})])[0]
    measured = np.isfinite(model.noise.sd)
    assert np.isfinite(misfit[measured & (model.row_record == 0)]).all()
    assert np.isnan(misfit[model.row_record == 1]).all()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"tip_force_N": [0.1, 0.0, 0.0]}, "tip_force_N: expected a force along gravity"),
        ({"free_length_mm": 250.0}, "marker_positions_mm: expected a marker on the beam's outer half"),
    ],
)
def test_what_cannot_be_used_is_said(tmp_path: Path, changed: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        bar_model(read(write_bars(tmp_path / "e", Truth(), **changed)))


def test_a_record_must_hold_a_swing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected 4\.2 periods of free vibration after the release"):
        bar_model(read(write_bars(tmp_path / "short", Truth(), seconds=0.25)))
    still = read(write_bars(tmp_path / "still", Truth(shear=6e9)))
    with pytest.raises(InputError, match="expected a release, but no marker of the outer half moves"):
        bar_model(still)


@pytest.mark.slow
def test_fem_swings_and_settles_as_the_corrected_bar(tmp_path: Path) -> None:
    model = bar_model(read(write_bars(tmp_path / "e", Truth())), workers=1)
    state = State(u=model.start())
    model.update_nuisances(state)
    assert model.not_corrected == []
    for c in model.corrections:
        assert 0.0 < c.stiff_root < 0.15 * HEIGHT
        assert abs(c.extra_inertia) < 0.01
        assert np.abs(c.markers).max() < 0.05 * c.drop
