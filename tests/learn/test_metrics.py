"""Metrics against values computed by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from learn.evaluation import by_softness, over_folds, summarise
from learn.evaluation.summary import by_cover
from learn.metrics import METRICS, Predictions


def _cases() -> Predictions:
    """Two frames of two pokes, three points 1, 7 and 50 mm from the tip; errors of 0, 3, 5 mm, and none."""
    truth = np.zeros((2, 3, 3), dtype=np.float32)
    truth[:, 0, 2] = -4e-3
    truth[:, 1, 0] = 2e-3
    predicted = truth.copy()
    predicted[0, 1, 1] = 3e-3
    predicted[0, 2] = [3e-3, 0, 4e-3]
    return Predictions(
        truth=truth,
        predicted=predicted,
        force=np.array([2.0, 4.0]),
        force_predicted=np.array([3.0, 3.0]),
        away=np.tile([1e-3, 7e-3, 50e-3], (2, 1)),
        depth=np.array([4e-3, 8e-3]),
        poke=np.array([5, 9]),
        softness=np.array(["S0", "S1"]),
    )


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mean", [8 / 3, 0]),
        ("max", [5, 0]),
        ("tip", [0, 0]),
        ("force", [1, 1]),
        ("rel force", [0.5, 0.25]),
        ("0-5 mm", [0, 0]),
        ("5-10 mm", [3, 0]),
        ("10-20 mm", [np.nan, np.nan]),
        ("40+ mm", [5, 0]),
        ("rel L2", [np.sqrt(34 / 20), 0]),
        ("worse than 1 mm", [1, 0]),
        ("skill", [1 - 8 / 6, 1]),
    ],
)
def test_values(name: str, values: list[float]) -> None:
    np.testing.assert_allclose(METRICS[name].values(_cases()), values, atol=1e-6)


def test_frames_are_told_apart_by_the_cover_below_the_contact() -> None:
    cases = dataclasses.replace(_cases(), cover=np.array([4.0, 16.5]))
    rows = by_cover(cases)
    assert list(rows) == ["0 to 4 mm", "above 16 mm"]
    assert [row["rel force"].mean for row in rows.values()] == [0.5, 0.25]
    assert not by_cover(_cases())  # it is not known


def test_tip_error_is_relative_to_the_depth() -> None:
    cases = _cases()
    cases.predicted[1, 0, 0] += 2e-3
    np.testing.assert_allclose(METRICS["tip"].values(cases), [0, 0.25], rtol=1e-6)


def test_worst_counts_pokes_not_frames() -> None:
    cases = _cases()
    cases.poke[:] = 5
    np.testing.assert_array_equal(METRICS["worse than 1 mm"].values(cases), [1])


def test_summaries() -> None:
    rows = by_softness(_cases())
    assert list(rows) == ["S0", "S1", "all"]
    assert rows["all"]["max"].mean == pytest.approx(2.5)
    assert rows["all"]["max"].sd == pytest.approx(2.5)
    assert np.isnan(rows["all"]["10-20 mm"].mean)
    folds = over_folds([rows["S0"], rows["S1"]])
    assert folds["rel force"].mean == pytest.approx(0.375)
    assert folds["rel force"].sd == pytest.approx(np.std([0.5, 0.25], ddof=1))
    assert summarise(_cases())["tip"].text(METRICS["tip"]) == "0.00 ± 0.00"
