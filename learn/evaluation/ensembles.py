"""Ensembles of runs that differ in seed alone, and the names of runs in tables."""

from __future__ import annotations

from dataclasses import replace

from learn.errors import InputError
from learn.models import Ensemble
from learn.training import Recipe, Run


def ensembles(runs: list[Run]) -> list[tuple[Run, str]]:
    """Ensembles of the runs that differ in seed alone (`join_runs`), with names.

    InputError if there are none, or the runs are of several datasets.
    """
    groups: dict[str, list[Run]] = {}
    for run in runs:
        _check_one_dataset(runs[0], run)
        groups.setdefault(repr(_but_for_the_seed(run.recipe)), []).append(run)
    names = dict(zip(runs, names_of(runs), strict=True))
    joined = [
        (join_runs(group), f"{names[group[0]]}, {len(group)} together")
        for group in groups.values()
        if len(group) > 1
    ]
    if not joined:
        raise InputError("an ensemble needs two or more runs that differ in seed alone")
    return joined


def join_runs(runs: list[Run]) -> Run:
    """Join runs to an ensemble, as a run with the folder of the first.

    InputError if they differ in more than the seed and the recipe's name, or two have the same seed.
    """
    first = runs[0]
    for k, run in enumerate(runs[1:], 1):
        _check_one_dataset(first, run)
        wanted = f"{run.folder}: expected runs that differ in seed alone, this one"
        before, now = (_but_for_the_seed(one.recipe).model_dump() for one in (first, run))
        for key, value in now.items():
            if value != before[key]:
                raise InputError(f"{wanted} has {key} {value}, {first.folder} {before[key]}")
        if (run.groups, run.statistics.frames) != (first.groups, first.statistics.frames):
            raise InputError(f"{wanted} was trained on other pokes than {first.folder}")
        for other in runs[:k]:
            if other.recipe.seed == run.recipe.seed:
                raise InputError(f"{wanted} has seed {run.recipe.seed}, as {other.folder}")
    return replace(
        runs[0],
        model=Ensemble([run.model for run in runs]).eval(),
        weights=tuple(digest for run in runs for digest in run.weights),
        members=tuple(run.folder for run in runs),
    )


def names_of(runs: list[Run]) -> list[str]:
    """Model of each run, with the recipe's name and number where recipes of one model differ."""
    alike: dict[str, list[str]] = {}
    texts = [repr(_but_for_the_seed(run.recipe).model_copy(update={"fold": 0})) for run in runs]
    for run, text in zip(runs, texts, strict=True):
        known = alike.setdefault(run.recipe.model, [])
        known += [text] if text not in known else []
    names = []
    for run, text in zip(runs, texts, strict=True):
        known, name = alike[run.recipe.model], run.recipe.model
        number = f" {known.index(text) + 1}" if len(known) > 1 else ""
        names.append(f"{name} ({run.recipe.name}{number})" if number else name)
    return names


def _check_one_dataset(first: Run, run: Run) -> None:
    """Raise InputError unless both runs are of one dataset: a member may have seen another's test part."""
    if run.uuid != first.uuid:
        raise InputError(f"{run.folder}: trained on dataset {run.uuid}, {first.folder} on {first.uuid}")


def _but_for_the_seed(recipe: Recipe) -> Recipe:
    """The recipe without what the members of an ensemble may differ in."""
    return recipe.model_copy(update={"seed": 0, "name": "-"})
