"""The frames that a run is tested on: of its own dataset its test part, of another what is new to the run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from learn.data import Split, Store, contact_points, interiors, split_of_run
from learn.errors import InputError
from learn.training import Run, check_dataset, open_dataset
from learn.training.run_folder import Pretrained


def parts_of(store: Store, run: Run) -> Split:
    """Parts of the run's own dataset; for another dataset, the frames of all that is new to the run.

    That is inclusions in their blocks or, for a run that was split by site, contact points on these: those of
    its training and validation parts are not new. Where its dataset cannot be read any more (`trained_on`),
    shapes are identified by their names. InputError if nothing is new.
    """
    if store.uuid == run.uuid:
        if not run.groups["test"]:
            raise InputError(
                f"{run.folder}: was adapted to all of {store.location}, so that nothing is left to test; its"
                " errors at contact points left out are in adaptation.json"
            )
        return split_of_run(store, run)
    new = _new_to(store, run)
    if run.pretrained is not None:
        new &= _new_to(store, run.pretrained)
    names = np.array(store.shapes)[store.shape]
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


def _new_to(store: Store, run: Run | Pretrained) -> NDArray[np.bool_]:
    """True for the pokes (p,) that a training has not seen, of its own or of another dataset."""
    pokes = np.arange(store.pokes)
    if store.uuid == run.uuid:
        return np.isin(pokes, store.frame_poke[split_of_run(store, run).test])
    by_shape, own = run.recipe.split == "shape", trained_on(run)
    names = np.array(store.shapes)[store.shape]
    if own is not None:
        data, rows = own
        key = interiors if by_shape else _points
        return ~np.isin(key(store, pokes), key(data, np.unique(data.frame_poke[rows])))
    if by_shape:
        return ~np.isin(names, run.groups["train"] + run.groups["validation"])
    if run.seen:
        return np.asarray(~np.isin(contact_points(store, pokes), list(run.seen)))
    raise InputError(
        f"{run.folder}: it was split by site, and does not say which contact points it was trained on"
        f" (version of before 2026-11-27), so that none of {store.location} is known to be new: train it"
        " again"
    )


def trained_on(run: Run | Pretrained) -> tuple[Store, NDArray[np.int64]] | None:
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
