"""Intervals of a run from the other folds' answers to shapes that they had not seen.

The shapes that a run was validated on are two, and do not say how a third will do. The test parts of the
other folds are each answered by a model that had not seen their shapes, so that they are more draws of what
is asked for: errors on an unseen shape (cross-conformal prediction: Vovk, Ann. Math. Artif. Intell. 74, 2015;
Barber et al., Ann. Statist. 49, 2021). The run's own test part takes no part in its intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from learn.evaluation.intervals import Intervals, fit_intervals
from learn.metrics import Cases, join_cases
from learn.training import Run

LEAST_FOLDS = 3


class Answered(NamedTuple):
    """A run, its name in tables, and its answers to its test part."""

    run: Run
    name: str
    cases: Cases


def across_folds(answers: Sequence[Answered]) -> list[tuple[Answered, Intervals]]:
    """Each run that has two or more others like it but for the fold, with intervals from those alone."""
    groups: dict[str, list[Answered]] = {}
    for one in answers:
        alike = one.run.recipe.model_copy(update={"fold": 0})
        groups.setdefault(f"{one.name} {alike!r}", []).append(one)
    found = []
    for group in groups.values():
        folds = {one.run.recipe.fold for one in group}
        if len(folds) != len(group) or len(folds) < LEAST_FOLDS:
            continue
        for one in group:
            others = [other.cases for other in group if other is not one]
            found.append((one, fit_intervals(join_cases(others))))
    return found
