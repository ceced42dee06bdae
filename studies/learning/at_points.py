"""Errors at scattered points: as clouds of their own, and each in the place of the grid point of its cell.

    python -m studies.learning.at_points DATASET RUN...

RUN are folders of runs that `learn.evaluate` has evaluated together: their intervals are read. Each is asked
on some pokes of its own test part.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

import numpy as np

from learn.data import Setup, Store, make_batch, open_store
from learn.data.clouds import SurfaceField, scattered
from learn.data.folds import split_of
from learn.evaluation import Intervals, coverage, predict_on
from learn.evaluation.intervals_file import load_intervals
from learn.evaluation.predictions import Cloud, predict_batches
from learn.metrics import Predictions
from learn.models import Scenes
from learn.training import Run, load_run

POKES, SIZES, SEEDS = 12, (512, 1024, 4096), (0, 1)


def as_a_cloud(
    run: Run,
    store: Store,
    rows: np.ndarray[tuple[int], np.dtype[np.int64]],
    cloud: Cloud,
    field: SurfaceField,
) -> Predictions:
    """Predictions on a cloud of the points alone."""
    batches = (
        make_batch(store, mine, field.displacement(mine, cloud(store.setup_of(poke))))
        for poke in np.unique(store.frame_poke[rows])
        for mine in [rows[store.frame_poke[rows] == poke]]
    )
    return predict_batches(run.model, Scenes.of(store, cloud), store, batches)


def line(parts: list[Predictions], intervals: Intervals | None) -> str:
    """Means over clouds of the error, of the force's and of the coverage; the largest error."""
    mean = np.mean([p.distance_mm.mean() for p in parts])
    most = max(p.distance_mm.max() for p in parts)
    force = np.mean([np.abs(p.force_predicted / p.force - 1).mean() for p in parts])
    held = [] if intervals is None else [coverage(intervals, p).points for p in parts]
    return f"{mean:.4f} {most:.2f} {force:.2%}" + (f" {np.mean(held):.1%}" if held else "")


def grid(setup: Setup) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return setup.points


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("dataset")
    parser.add_argument("runs", nargs="+", type=Path)
    options = parser.parse_args()
    store = open_store(options.dataset)
    print("run, points: mean and largest [mm], force, points in intervals; alone | in the grid")
    for folder in options.runs:
        run = load_run(folder)
        test = split_of(store, run.recipe).test
        pokes = np.unique(store.frame_poke[test])
        pokes = pokes[np.linspace(0, len(pokes) - 1, POKES).astype(int)]
        rows = test[np.isin(store.frame_poke[test], pokes)]
        field, intervals = SurfaceField(store, pokes.tolist()), load_intervals(run)
        asked = predict_on(run.model, store, rows, grid, field)
        print(f"{folder.name}, grid: {line([asked], intervals)}", flush=True)
        for size in SIZES:
            clouds = [partial(scattered, count=size, seed=seed) for seed in SEEDS]
            alone = [as_a_cloud(run, store, rows, cloud, field) for cloud in clouds]
            placed = [predict_on(run.model, store, rows, cloud, field) for cloud in clouds]
            print(f"{folder.name}, {size}: {line(alone, intervals)} | {line(placed, intervals)}", flush=True)


if __name__ == "__main__":
    main()
