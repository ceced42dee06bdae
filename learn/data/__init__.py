"""Reading the dataset: the store, its folds, frames in memory or streamed, statistics."""

from learn.data.batch import Batch, make_batch
from learn.data.folds import FOLDS, Split, split_pokes
from learn.data.memory import MemoryDataset
from learn.data.statistics import Statistics, statistics
from learn.data.store import Store, open_store
from learn.data.stream import StreamDataset

__all__ = [
    "FOLDS",
    "Batch",
    "MemoryDataset",
    "Split",
    "Statistics",
    "Store",
    "StreamDataset",
    "make_batch",
    "open_store",
    "split_pokes",
    "statistics",
]
