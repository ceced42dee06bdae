"""The dataset of a run: where it is, the small tables of it in the run's folder, the domain derived from it.

`dataset.npz` in the folder holds what a prediction needs of the dataset (`learn.data.tables`).
"""

from __future__ import annotations

from pathlib import Path

from learn.data.folds import split_of_run
from learn.data.opening import open_store
from learn.data.store import Store
from learn.data.tables import TABLES, load_tables, tables_bytes
from learn.errors import InputError
from learn.training.run_folder import Pretrained, Run, write_whole
from learn.validity import Domain, domain_of


def check_dataset(uuid: str, where: Path, store: Store, *, hint: str = "") -> None:
    """Raise InputError if the checkpoint or run at `where` was trained on another dataset."""
    if uuid != store.uuid:
        raise InputError(f"{where}: trained on dataset {uuid}, but {store.location} is {store.uuid}{hint}")


def open_dataset(run: Run | Pretrained, dataset: Path | str | None = None, *, verify: bool = True) -> Store:
    """Open the dataset of a run, where it was at training or at `dataset`; InputError if it cannot be."""
    try:
        return open_store(run.location if dataset is None else dataset, verify=verify)
    except InputError as error:
        if dataset is not None or "://" in run.location or Path(run.location).exists():
            raise
        raise InputError(
            f"{error}: {run.folder} was trained on it; if it has moved, --dataset states where it is now"
        ) from None


def save_tables(folder: Path, store: Store) -> None:
    """Write the tables of its dataset to a run's folder. OSError if it cannot be."""
    write_whole(folder / TABLES, tables_bytes(store))


def open_tables(run: Run, dataset: Path | str | None = None) -> Store:
    """The dataset of a run, where it is at hand, or its tables alone, which the run's folder has.

    InputError if `dataset` is stated and cannot be opened, or neither is there.
    """
    tables = run.folder / TABLES
    if dataset is not None or not tables.is_file():
        return open_dataset(run, dataset, verify=False)
    try:
        store = open_dataset(run, verify=False)
    except InputError:
        return load_tables(tables)
    return store if store.uuid == run.uuid else load_tables(tables)


def known_domain(run: Run, store: Store) -> Domain | None:
    """The domain recorded with a run, or derived from its dataset; None if the store is another."""
    if run.domain is not None or run.uuid != store.uuid:
        return run.domain
    return domain_of(store, split_of_run(store, run).train)
