"""Reading the dataset: the store, its folds, frames in memory or streamed, statistics."""

from learn.data.folds import FOLDS, Split, contact_points, interiors, split_of, split_of_run, split_pokes
from learn.data.loaders import Batch, MemoryDataset, StreamDataset, make_batch
from learn.data.opening import open_store
from learn.data.setup import Setup
from learn.data.statistics import Statistics, statistics
from learn.data.store import Store
from learn.data.tables import load_tables

__all__ = [
    "FOLDS",
    "Batch",
    "MemoryDataset",
    "Setup",
    "Split",
    "Statistics",
    "Store",
    "StreamDataset",
    "contact_points",
    "interiors",
    "load_tables",
    "make_batch",
    "open_store",
    "split_of",
    "split_of_run",
    "split_pokes",
    "statistics",
]
