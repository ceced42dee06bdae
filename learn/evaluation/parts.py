"""The parts of a store for a run: those it was trained by, or of another dataset what it has not seen."""

from __future__ import annotations

import numpy as np

from learn.data import Split, Store, split_pokes
from learn.errors import InputError
from learn.training import Recipe, Run


def split_of(store: Store, recipe: Recipe) -> Split:
    """The parts that a recipe trains and tests on."""
    depth = recipe.train_depth_mm * 1e-3 if recipe.train_depth_mm else None
    return split_pokes(
        store, fold=recipe.fold, by=recipe.split, train_softness=recipe.train_softness, train_depth=depth
    )


def parts_of(store: Store, run: Run) -> Split:
    """The run's own parts of its own dataset; of another, all frames of shapes that it has not seen.

    Shapes are known by their names. A run that was split by site has seen all its shapes at some sites: all
    frames of the other dataset are tested then. InputError where every shape was seen.
    """
    if store.uuid == run.uuid:
        return split_of(store, run.recipe)
    used = store.done & (store.frame_count > 0)
    names = np.array(store.shapes)[store.shape]
    seen = run.groups["train"] + run.groups["validation"] if run.recipe.split == "shape" else []
    test = used & ~np.isin(names, seen)
    if not test.any():
        known = ", ".join(sorted(set(names[used].tolist())))
        raise InputError(
            f"{store.location}: {run.folder} was trained on all its shapes ({known}), expected one that it "
            "has not seen"
        )
    none = np.zeros(0, dtype=np.int64)
    rows = np.flatnonzero(test[store.frame_poke])
    groups = {"train": [], "validation": [], "test": sorted(set(names[test].tolist()))}
    return Split(train=none, validation=none, test=rows, groups=groups)
