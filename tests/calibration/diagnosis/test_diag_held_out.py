"""Held-out improvement against linear least squares, fold by fold."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from fake_model import LENGTHS, FakeModel, column, library, noise, of_length, of_material

from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.diagnosis.engine.held_out import HeldOut, held_out_improvement
from calibration.diagnosis.engine.skill import Prediction, skill, together
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State

BEND = Candidate(effect="bend")


@pytest.fixture(autouse=True)
def _to_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lower the fits' tolerance on chi-square, 0.05, for comparisons with least squares."""
    monkeypatch.setattr("calibration.diagnosis.engine.fitting.TOLERANCE", 1e-10)


def both(model: FakeModel, *candidates: Candidate) -> tuple[Fit, Fit]:
    start = State(u=model.start())
    return fit(model, start), fit(model, start, candidates)


def left_out(model: FakeModel, columns: np.ndarray, groups: list[np.ndarray]) -> np.ndarray:
    """Residuals of each group predicted from all others; moduli without other data are fitted to it."""
    found = np.zeros(len(model.data))
    for group in groups:
        seen = np.linalg.norm(model.by_u[~group], axis=0) > 0
        u = model.by_u[:, seen]
        rest = np.column_stack([u, columns])
        best = np.linalg.lstsq(rest[~group], model.data[~group], rcond=None)[0]
        z = rest[group] @ best - model.data[group]
        own = model.by_u[group][:, ~seen]
        if own.size:
            z = z - own @ np.linalg.lstsq(own, z, rcond=None)[0]
        found[group] = z
    return found


def test_folds_of_length_are_those_of_least_squares() -> None:
    model = FakeModel(hidden=12.0 * library()["bend"], drawn=noise(1), shared=True)
    baseline, chosen = both(model, BEND)
    gain = held_out_improvement(model, baseline, chosen)
    groups = [of_length(n) for n in LENGTHS]
    before = left_out(model, np.zeros((72, 0)), groups)
    after = left_out(model, library()["bend"][:, None], groups)
    assert gain.held_out == "leave-one-length-out"
    assert gain.folds == 3
    assert gain.note == ""
    assert gain.rms_before == pytest.approx(1e-3 * np.sqrt(np.mean(before**2)), rel=1e-6)
    assert gain.rms_after == pytest.approx(1e-3 * np.sqrt(np.mean(after**2)), rel=1e-6)
    assert gain.log_likelihood == pytest.approx(0.5 * (before @ before - after @ after), rel=1e-6)
    assert gain.rms_noise == pytest.approx(1e-3)
    assert gain.rms_after < 0.8 * gain.rms_before
    assert 0.5 <= gain.kept < 1.0


def test_what_is_kept_is_the_least_part_of_the_information() -> None:
    model = FakeModel(drawn=noise(2), shared=True)
    baseline, chosen = both(model, BEND, Candidate(effect="slope"))
    columns = np.column_stack([library()["bend"], library()["slope"]])
    whole = np.column_stack([model.by_u, columns])

    def information(rows: np.ndarray) -> np.ndarray:
        return np.asarray(1.0 / np.diag(np.linalg.inv(whole[rows].T @ whole[rows]))[1:])

    everything = information(np.ones(72, dtype=bool))
    expected = [
        min(np.min(information(~g) / everything) for g in groups)
        for groups in ([of_length(n) for n in LENGTHS], [of_material(m) for m in ("S0", "S1")])
    ]
    name, kept = max(
        zip(("leave-one-length-out", "leave-one-material-out"), expected, strict=True),
        key=lambda pair: (pair[1] >= 0.5, pair[1]),
    )
    gain = held_out_improvement(model, baseline, chosen)
    assert gain.kept == pytest.approx(expected[0] if expected[0] >= 0.5 else kept, rel=1e-6)
    assert gain.held_out == ("leave-one-length-out" if expected[0] >= 0.5 else name)


def test_an_effect_that_lives_in_one_length_is_held_out_by_material() -> None:
    model = FakeModel(hidden=12.0 * library()["slack"], drawn=noise(3))  # in the longest beams only
    baseline, chosen = both(model, Candidate(effect="slack"))
    gain = held_out_improvement(model, baseline, chosen)
    assert gain.held_out == "leave-one-material-out"
    assert gain.folds == 2
    assert gain.kept == pytest.approx(0.5, abs=0.05)
    # no other fold constrains the modulus of the left-out material: it is fitted there, the effect is not
    groups = [of_material(m) for m in ("S0", "S1")]
    after = left_out(model, library()["slack"][:, None], groups)
    before = left_out(model, np.zeros((72, 0)), groups)
    assert gain.rms_after == pytest.approx(1e-3 * np.sqrt(np.mean(after**2)), rel=1e-4)
    assert gain.rms_before == pytest.approx(1e-3 * np.sqrt(np.mean(before**2)), rel=1e-4)
    assert gain.rms_after < 0.8 * gain.rms_before


def test_only_what_the_training_does_not_tell_of_is_fitted_to_the_fold() -> None:
    """The left-out material's modulus is fitted to the fold, a coordinate shared by all materials is not.

    If the shared coordinate moved too, it would undo its share of the effect.
    """
    model = FakeModel(hidden=12.0 * library()["slack"], drawn=noise(3))
    common = library()["slack"] + 0.3 * library()["slope"]
    model.by_u = np.column_stack([model.by_u, 3.0 * common])
    model.data = model.data + 3.0 * common
    model.baseline.__dict__["bounds"] = np.tile([-np.inf, np.inf], (3, 1))  # for the third coordinate as well
    baseline, chosen = both(model, Candidate(effect="slack"))
    gain = held_out_improvement(model, baseline, chosen)
    assert gain.held_out == "leave-one-material-out"
    groups = [of_material(m) for m in ("S0", "S1")]
    after = left_out(model, library()["slack"][:, None], groups)
    before = left_out(model, np.zeros((72, 0)), groups)
    assert gain.rms_after == pytest.approx(1e-3 * np.sqrt(np.mean(after**2)), rel=1e-4)
    assert gain.rms_before == pytest.approx(1e-3 * np.sqrt(np.mean(before**2)), rel=1e-4)


def test_each_fold_has_its_skill_and_its_amplitudes() -> None:
    model = FakeModel(hidden=12.0 * library()["bend"], drawn=noise(1), shared=True)
    gain = held_out_improvement(model, *both(model, BEND))
    assert [p.name for p in gain.parts] == ["0", "1", "2"]
    assert together(gain.parts).rms_after == pytest.approx(gain.rms_after)
    assert gain.skill == pytest.approx(
        (gain.rms_before**2 - gain.rms_after**2) / (gain.rms_before**2 - 1e-6), rel=1e-9
    )
    assert 0.6 < gain.skill < 1.2
    assert gain.helps_everywhere
    assert np.array(gain.amplitudes)[:, 0] == pytest.approx(12.0, abs=4.0)
    assert math.isnan(skill(1.0, 0.5, 1.0))  # no improvement possible
    assert skill(2.0, 3.0, 1.0) < 0.0


def held(*skills: float, points: int = 10) -> HeldOut:
    """Folds with these skills, for a baseline whose error is ten times the noise."""
    parts = tuple(
        Prediction(
            name=f"{k}",
            points=points,
            rms_before=10.0,
            rms_after=float(np.sqrt(100.0 - 99.0 * s)),
            rms_noise=1.0,
        )
        for k, s in enumerate(skills)
    )
    whole = together(parts)
    return HeldOut(
        held_out="x",
        kept=1.0,
        rms_before=whole.rms_before,
        rms_after=whole.rms_after,
        rms_noise=whole.rms_noise,
        log_likelihood=0.0,
        folds=len(parts),
        parts=parts,
    )


@pytest.mark.parametrize(
    ("skills", "mostly"),
    [
        ([0.9] * 17 + [-0.1] * 2, True),
        ([0.9] * 12 + [-0.1] * 7, False),  # chance alone improves as many of 19
        ([0.9] * 17 + [-6.0] * 2, False),  # two folds become much worse
        ([0.4] * 19, False),
        ([0.9] * 3 + [-0.1], False),  # of few folds all have to improve
        ([], False),
    ],
)
def test_many_parts_may_hold_some_that_gain_nothing(skills: list[float], mostly: bool) -> None:
    found = held(*skills) if skills else replace(held(0.5), parts=())
    assert found.helps_mostly(least_skill=0.5, sure=0.95, draws=400, seed=0) == mostly


def test_a_loss_beside_a_baseline_within_noise_is_no_skill() -> None:
    """Most parts improve a little, three get much worse; the baseline's error is below the noise in all."""
    found = held(*[0.9] * 16)
    parts = [replace(p, rms_before=0.9, rms_after=5.0 if k < 3 else 0.89) for k, p in enumerate(found.parts)]
    few = replace(found, parts=tuple(parts))
    assert not few.helps_mostly(least_skill=0.5, sure=0.95, draws=400, seed=0)


def test_where_no_family_keeps_half_the_best_is_taken() -> None:
    thirds = [np.arange(72) % 3 == k for k in range(3)]
    shapes = {"bend": column(lambda x: np.where(x < 0.5, 1.0, -1.0))}
    heavy = np.where(np.arange(72) % 3 == 0, 3.0, 1.4) * shapes["bend"]  # mostly in one third
    model = FakeModel(
        shapes={"bend": heavy},
        hidden=2.0 * heavy,
        split={"longs": [thirds[0] | thirds[1], thirds[2]], "thirds": thirds},
    )
    baseline, chosen = both(model, BEND)
    gain = held_out_improvement(model, baseline, chosen)
    assert gain.held_out == "thirds"
    assert 0.2 < gain.kept < 0.5
    assert gain.rms_after < 1e-6


def test_where_no_fold_keeps_the_effect_it_is_said() -> None:
    only = np.where(of_length(3.0) & of_material("S0"), library()["bend"], 0.0)
    model = FakeModel(shapes={"bend": only}, hidden=12.0 * only, drawn=noise(4))
    baseline, chosen = both(model, BEND)
    gain = held_out_improvement(model, baseline, chosen)
    assert gain.held_out == ""
    assert gain.kept == pytest.approx(0.0, abs=1e-9)
    assert gain.folds == 0
    assert gain.note == "no fold leaves enough of the effect in training"
    assert math.isnan(gain.rms_before)
    assert math.isnan(gain.rms_after)


@pytest.mark.parametrize("split", [{"one": [np.ones(72, dtype=bool)]}])
def test_one_group_is_no_fold(split: dict[str, list[np.ndarray]]) -> None:
    model = FakeModel(hidden=12.0 * library()["bend"], split=split)
    baseline, chosen = both(model, BEND)
    assert held_out_improvement(model, baseline, chosen).held_out == ""


def test_an_effect_that_is_not_there_gains_nothing() -> None:
    gained = []
    for k in range(20):
        model = FakeModel(drawn=noise(600 + k), shared=True)
        baseline, chosen = both(model, BEND)
        gained.append(held_out_improvement(model, baseline, chosen).log_likelihood)
    assert np.mean(gained) < 0.0
    assert json.dumps(gained)  # JSON accepts plain floats only
