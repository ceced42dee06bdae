"""Intervals of a run from the other folds: from shapes unseen in training, never from its own test part."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from learn.errors import InputError
from learn.evaluation.cross_conformal import Predicted, across_folds, inside_alone
from learn.evaluation.intervals import (
    coverage,
    fit_intervals,
    force_fault,
)
from learn.evaluation.intervals_file import load_intervals, replaced_text, save_intervals
from learn.metrics import Predictions, join_predictions
from learn.training import Recipe, Run


def _answers(
    fold: int, factor: float, *, seed: int = 0, name: str = "invariant-gnn", **recipe: object
) -> Predicted:
    """Predictions of a run whose errors are `factor` times those of a run with factor 1."""
    random = np.random.default_rng([fold, seed])
    pokes, n = 12, 200
    frames = 3 * pokes
    away = random.uniform(0, 0.05, (frames, n))
    depth = np.tile([2e-3, 5e-3, 8e-3], pokes)
    truth = np.zeros((frames, n, 3), dtype=np.float32)
    wrong = factor * 2e-5 * random.normal(size=truth.shape)
    force = depth * 500
    cases = Predictions(
        truth=truth,
        predicted=(truth + wrong).astype(np.float32),
        force=force,
        force_predicted=force * np.exp(0.02 * factor * random.normal(size=frames)),
        away=away,
        depth=depth,
        poke=1000 * fold + np.repeat(np.arange(pokes), 3),
        softness=np.full(frames, "S0"),
    )
    run = SimpleNamespace(recipe=Recipe(fold=fold, **recipe), folder=Path(f"f{fold}"))  # type: ignore[arg-type]
    return Predicted(cast(Run, run), name, cases, np.zeros(frames))


def test_shapes_that_differ_are_covered_on_average_over_folds() -> None:
    """Intervals from one other fold vary; those from all others cover 90 % on average."""
    shares, beside = [], []
    for seed in range(12):
        factors = np.exp(0.5 * np.random.default_rng(seed).normal(size=5))
        answers = [_answers(k, f, seed=seed) for k, f in enumerate(factors)]
        found = across_folds(answers)
        assert [one.run.recipe.fold for one, _ in found] == [0, 1, 2, 3, 4]
        shares.append([coverage(i, one.predictions).points for one, i in found])
        neighbour = fit_intervals(answers[1].predictions)
        beside.append(coverage(neighbour, answers[0].predictions).points)
    assert 0.86 <= np.mean(shares) <= 0.94
    assert np.std([s[0] for s in shares]) < np.std(beside)


def test_a_run_takes_no_part_in_its_own_intervals() -> None:
    """A fold with ten times the others' errors is not covered, since its own errors are not used."""
    found = across_folds([_answers(k, 10.0 if k == 2 else 1.0) for k in range(4)])
    shares = {one.run.recipe.fold: coverage(i, one.predictions).points for one, i in found}
    assert shares[2] < 0.3
    assert min(shares[k] for k in (0, 1, 3)) > 0.9


def test_frames_outside_what_was_trained_calibrate_nothing() -> None:
    """Half of each fold is outside, with ten times the errors: only the other half calibrates."""
    alone = [_answers(fold, 1.0) for fold in range(4)]
    whole = []
    for fold, near in enumerate(alone):
        far = _answers(fold, 10.0, seed=1).predictions
        both = join_predictions([near.predictions, replace(far, poke=far.poke + 500)])
        whole.append(near._replace(predictions=both, distance=np.repeat([0.0, 0.4], len(near.distance))))
    found = [intervals for _, intervals in across_folds(whole)]
    assert found == [intervals for _, intervals in across_folds(alone)]
    assert coverage(found[0], whole[0].predictions).points < 0.7


def test_pokes_of_the_own_test_part_calibrate_nothing() -> None:
    """Test parts of few groups overlap: here folds 0 and 3 are tested on the same pokes."""
    answers = [_answers(fold, 1.0) for fold in range(4)]
    same = answers[0].predictions
    answers[3] = answers[3]._replace(predictions=replace(same, predicted=5 * same.predicted))
    found = {one.run.recipe.fold: i for one, i in across_folds(answers)}
    alone = {one.run.recipe.fold: i for one, i in across_folds(answers[:3])}
    assert found[0] == alone[0]
    assert found[1].pokes == alone[1].pokes  # a poke that two runs predict is one draw


def test_validation_parts_of_the_others_calibrate_too() -> None:
    """The validation parts of the three others count as much as their test parts."""
    alone = [_answers(fold, 1.0) for fold in range(4)]
    parts = [_answers(fold, 1.0, seed=1).predictions for fold in range(4)]
    parts = [replace(part, poke=part.poke + 100) for part in parts]
    with_parts = [one._replace(validation=part) for one, part in zip(alone, parts, strict=True)]
    found = {one.run.recipe.fold: i for one, i in across_folds(with_parts)}
    joined = [join_predictions([one.predictions, part]) for one, part in zip(alone, parts, strict=True)]
    assert found[0] == fit_intervals(join_predictions(joined[1:]))
    # those that are pokes of the own test part calibrate nothing
    tested = replace(parts[1], poke=alone[0].predictions.poke)
    again = [alone[0], alone[1]._replace(validation=tested), *alone[2:]]
    assert across_folds(again)[0][1] == across_folds(alone)[0][1]
    assert across_folds(again)[2][1] != across_folds(alone)[2][1]


def test_copies_of_a_solve_are_no_further_draws() -> None:
    """Three levels that differ by the modulus alone calibrate as one."""
    alone = [_answers(fold, 1.0) for fold in range(3)]
    copies = np.zeros(3000, dtype=bool)
    whole = []
    for one in alone:
        again = [replace(one.predictions, poke=one.predictions.poke + 100 * k) for k in (1, 2)]
        for part in again:
            copies[part.poke] = True
        both = join_predictions([one.predictions, *again])
        whole.append(one._replace(predictions=both, distance=np.zeros(len(both.depth))))
    expected = [intervals for _, intervals in across_folds(alone)]
    assert [intervals for _, intervals in across_folds(whole, copies=copies)] == expected
    assert [intervals.pokes for _, intervals in across_folds(whole)] == [72, 72, 72]


def test_a_model_without_positive_forces_has_no_intervals() -> None:
    answers = [_answers(fold, 1.0) for fold in range(3)]
    bad = answers[0].predictions
    force = np.where(np.arange(len(bad.depth)) < 4, -1.0, bad.force_predicted)
    answers[0] = answers[0]._replace(predictions=replace(bad, force_predicted=force))
    assert "which 4 of 36 are not" in str(force_fault(answers[0].predictions))
    assert force_fault(answers[1].predictions) is None
    assert across_folds(answers) == []
    intervals = fit_intervals(answers[1].predictions)
    assert coverage(intervals, answers[0].predictions).force <= 32 / 36  # they count as misses


def test_where_hardly_any_frame_is_inside_all_calibrate() -> None:
    cases = _answers(0, 1.0).predictions
    distance = np.where(cases.poke == cases.poke[0], 0.0, 0.4)
    assert inside_alone(cases, distance) is cases


@pytest.mark.parametrize(
    "answers",
    [
        [_answers(0, 1.0), _answers(1, 1.0)],
        [_answers(0, 1.0), _answers(1, 1.0), _answers(1, 1.0, seed=1)],
        [_answers(0, 1.0), _answers(1, 1.0), _answers(2, 1.0, epochs=7)],
        [_answers(0, 1.0), _answers(1, 1.0), _answers(2, 1.0, name="invariant-gnn, 2 together")],
    ],
    ids=["two folds", "a fold twice", "another recipe", "another model"],
)
def test_what_is_not_three_folds_of_one_kind_has_none(answers: list[Predicted]) -> None:
    assert across_folds(answers) == []


def _run(folder: Path, *members: Path) -> Run:
    """A run as far as its intervals need it, with its path for the sum of its weights."""
    for place in members or (folder,):
        place.mkdir(exist_ok=True, parents=True)
    weights = tuple(str(place) for place in members or (folder,))
    return cast(Run, SimpleNamespace(folder=folder, members=members, weights=weights))


def test_intervals_belong_to_the_weights_that_they_were_made_for(tmp_path: Path) -> None:
    own = fit_intervals(_answers(0, 1.0).predictions)
    run = _run(tmp_path / "run")
    save_intervals(run, own)
    assert load_intervals(run) == own
    run.weights = ("trained further",)  # type: ignore[misc]
    with pytest.raises(InputError, match="belongs to other weights"):
        load_intervals(run)
    a, b, c = (tmp_path / name / "s0" for name in "abc")
    save_intervals(_run(a, a, b), own)
    assert load_intervals(_run(b, b, a)) == own  # in any order
    later = replace(own, pokes=77)
    save_intervals(_run(b, b, a), later)
    assert load_intervals(_run(a, a, b)) == later  # no second file, which would be stale
    with pytest.raises(InputError, match="other members"):
        load_intervals(_run(a, a, c))  # of the same name
    (b / "intervals-together.json").write_text("{", encoding="utf-8")
    assert load_intervals(_run(b, b, a)) == later


def test_intervals_that_are_lost_to_fewer_pokes_are_told_of(tmp_path: Path) -> None:
    run = _run(tmp_path)
    own = fit_intervals(_answers(0, 1.0).predictions)
    assert replaced_text(run, own) is None
    save_intervals(run, replace(own, pokes=420))
    assert "calibrated on 420 pokes, are replaced by intervals from 12" in str(replaced_text(run, own))
    save_intervals(run, own)
    assert replaced_text(run, own) is None
    (tmp_path / "intervals.json").write_text("{", encoding="utf-8")
    assert replaced_text(run, own) is None


def test_intervals_that_do_not_know_the_gap_are_refused(tmp_path: Path) -> None:
    """Files of before 2026-11-28 are too narrow where the indenter comes near what is rigid."""
    run = _run(tmp_path)
    own = replace(
        fit_intervals(_answers(0, 1.0).predictions), growth=(0.1, 0.2, 0.3), force_growth=(0.3, 0.4, 0.5)
    )
    path = save_intervals(run, own)
    assert load_intervals(run) == own
    content = json.loads(path.read_text())
    slopes, force_slopes = content.pop("growth"), content.pop("force_growth")
    path.write_text(json.dumps({**content, "size_gap": slopes[:2], "force_size_gap": force_slopes[:2]}))
    assert load_intervals(run) == replace(own, growth=(0.1, 0.2, 0.0), force_growth=(0.3, 0.4, 0.0))
    old = {"interior": slopes[:1], "force_interior": force_slopes[:1]}
    path.write_text(json.dumps({**content, **old}))
    with pytest.raises(
        InputError, match=r"intervals\.json: not readable .*do not know the gap.*writes it again"
    ):
        load_intervals(run)
