"""The frames that a run is tested on: of its own dataset its test part, of another what is new to the run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from learn.data import Split, Store, contact_points, interiors, split_of_run
from learn.errors import InputError
from learn.training import Run, check_dataset, open_dataset


def parts_of(store: Store, run: Run) -> Split:
    """Parts of the run's own dataset; for another dataset, the frames of all that is new to the run.

    That is inclusions in their blocks or, for a run that was split by site, contact points on these: those of
    its training and validation parts are not new. Where its dataset cannot be read any more (`trained_on`),
    shapes are identified by their names. InputError if nothing is new.
    """
    if store.uuid == run.uuid:
        return split_of_run(store, run)
    by_shape, own, pokes = run.recipe.split == "shape", trained_on(run), np.arange(store.pokes)
    names = np.array(store.shapes)[store.shape]
    if own is not None:
        data, rows = own
        key = interiors if by_shape else _points
        new = ~np.isin(key(store, pokes), key(data, np.unique(data.frame_poke[rows])))
    elif by_shape:
        new = ~np.isin(names, run.groups["train"] + run.groups["validation"])
    elif run.seen:
        new = ~np.isin(contact_points(store, pokes), list(run.seen))
    else:
        raise InputError(
            f"{run.folder}: it was split by site, and does not say which contact points it was trained on"
            f" (version of before 2026-11-27), so that none of {store.location} is known to be new: train it"
            " again"
        )
    used = store.done & (store.frame_count > 0)
    test = used & new
    if not test.any():
        shapes = ", ".join(sorted(set(names[used].tolist())))
        raise InputError(
            f"{store.location}: {run.folder} was trained on all its {run.recipe.split}s (shapes {shapes}),"
            " expected one that it has not seen"
        )
    none = np.zeros(0, dtype=np.int64)
    rows = np.flatnonzero(test[store.frame_poke] & store.presses)
    groups = {"train": [], "validation": [], "test": sorted(set(names[test].tolist()))}
    return Split(train=none, validation=none, test=rows, groups=groups)


def trained_on(run: Run) -> tuple[Store, NDArray[np.int64]] | None:
    """The run's own dataset and the frames of its training and validation parts; None if it is not there."""
    try:
        data = open_dataset(run, verify=False)
        check_dataset(run.uuid, run.folder, data)
        split = split_of_run(data, run)
    except InputError:
        return None
    return data, np.concatenate([split.train, split.validation])


def _points(store: Store, pokes: NDArray[np.int64]) -> NDArray[np.str_]:
    """A key of the interior, first contact and direction of each poke (k,)."""
    place = np.column_stack([store.path_start, store.direction])[pokes].round(9) + 0.0
    texts = [" ".join(f"{v:.9f}" for v in row) for row in place]
    return np.array([f"{key} {text}" for key, text in zip(interiors(store, pokes), texts, strict=True)])
