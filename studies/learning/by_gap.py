"""Errors and intervals of the force by the gap between the indenter's tip and what is rigid.

    python -m studies.learning.by_gap DATASET RUN...

RUN are folders of runs that `learn.evaluate` has evaluated together: their intervals are read, and each is
asked on its own test part.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

import numpy as np

from learn.data import MemoryDataset, open_store
from learn.data.folds import split_of
from learn.evaluation import coverage
from learn.evaluation.intervals_file import load_intervals
from learn.evaluation.predictions import predict_part
from learn.metrics import Predictions
from learn.models import Scenes
from learn.quantities import NEAR
from learn.training import load_run

EDGES = (0.0, 4.0, 8.0, 1e3 * NEAR, np.inf)  # mm; a gap is NEAR at most


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("dataset")
    parser.add_argument("runs", nargs="+", type=Path)
    options = parser.parse_args()
    store = open_store(options.dataset)
    rows: dict[str, list[tuple[int, float, float, float, float]]] = {}
    for folder in options.runs:
        run = load_run(folder)
        intervals = load_intervals(run)
        if intervals is None:
            raise SystemExit(f"{folder}: has no intervals: run learn.evaluate first")
        found = predict_part(
            run.model, Scenes.of(store), MemoryDataset(store, split_of(store, run.recipe).test)
        )
        gap = found.covariates[:, 1]
        for low, high in itertools.pairwise(EDGES):
            mine = (gap >= low) & (gap < high)
            if mine.any():
                part: Predictions = found.where(mine)
                held = coverage(intervals, part)
                wrong = float((np.abs(part.force_predicted - part.force) / part.force).mean())
                width = float(np.median(np.expm1(intervals.force_log(covariates=part.covariates))))
                name = f"{low:g} to {high:g} mm" if np.isfinite(high) else f"{low:g} mm and more"
                rows.setdefault(name, []).append((int(mine.sum()), wrong, held.force, held.points, width))
    print("gap: frames, error of the force, forces and points in their intervals, half width of the force's")
    for name, parts in rows.items():
        frames = np.array([part[0] for part in parts])
        wrong, force, points, width = (
            np.average([part[k] for part in parts], weights=frames) for k in (1, 2, 3, 4)
        )
        print(f"  {name}: {frames.sum()}, {wrong:.1%}, {force:.1%}, {points:.1%}, {width:.1%}")


if __name__ == "__main__":
    main()
