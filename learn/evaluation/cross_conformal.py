"""Cross-conformal intervals: those of each run are calibrated on the unseen shapes of the other folds.

A run is validated on two shapes, too few to predict the error on a third. The test parts of the other folds
are each predicted by a model that was not trained on their shapes, so that they are further draws of the
error on a new shape (cross-conformal prediction: Vovk, Ann. Math. Artif. Intell. 74, 2015; Barber et al.,
Ann. Statist. 49, 2021), as are their validation parts, but for pokes of the run's own test part, which is
not used for its intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from learn.evaluation.intervals import LEAST_POKES, Intervals, fit_intervals, force_fault
from learn.metrics import Predictions, join_predictions
from learn.training import Run

Floats = NDArray[np.float64]
LEAST_FOLDS = 3


def inside_alone(predictions: Predictions, distance: Floats) -> Predictions:
    """Frames for calibration: those inside the trained ranges if they are of two or more pokes, else all.

    `distance` (f,) is `learn.validity.Domain.distance`, by which intervals are widened outside.
    """
    inside = predictions.where(distance == 0.0)
    return inside if inside.pokes >= LEAST_POKES else predictions


class Predicted(NamedTuple):
    """A run, its name in tables, predictions of its test part, and their distance from its trained ranges.

    `validation` has those of its validation part that calibrate (`inside_alone`); None if there are none.
    """

    run: Run
    name: str
    predictions: Predictions
    distance: Floats
    validation: Predictions | None = None


def across_folds(
    predicted: Sequence[Predicted], *, copies: NDArray[np.bool_] | None = None
) -> list[tuple[Predicted, Intervals]]:
    """Intervals of each run from the unseen shapes of the other runs, two or more, that differ only in fold.

    Their test parts calibrate, and their validation parts, of which a training takes no more than the epoch.

    Pokes of the run's own test part do not calibrate (parts of few groups overlap), nor do `copies`, pokes of
    the dataset (p,) that repeat the solve of another (`learn.data.Store.copies`): they are no further draws.
    """
    groups: dict[str, list[Predicted]] = {}
    for one in predicted:
        alike = one.run.recipe.model_copy(update={"fold": 0})
        groups.setdefault(f"{one.name} {alike!r}", []).append(one)
    found = []
    for group in groups.values():
        folds = {one.run.recipe.fold for one in group}
        if len(folds) != len(group) or any(force_fault(one.predictions) for one in group):
            continue
        for one in group:
            others = [_calibrating(other, one, copies) for other in group if other is not one]
            others = [part for part in others if part.pokes]
            if len(others) + 1 >= LEAST_FOLDS:
                found.append((one, fit_intervals(join_predictions(others))))
    return found


def _calibrating(other: Predicted, one: Predicted, copies: NDArray[np.bool_] | None) -> Predictions:
    """Frames of another run's test and validation parts that calibrate the intervals of `one`."""

    def kept(predictions: Predictions) -> NDArray[np.bool_]:
        keep = ~np.isin(predictions.poke, one.predictions.poke)
        return keep if copies is None else keep & ~copies[predictions.poke]

    keep = kept(other.predictions)
    test = inside_alone(other.predictions.where(keep), other.distance[keep])
    if other.validation is None:
        return test
    return join_predictions([test, other.validation.where(kept(other.validation))])
