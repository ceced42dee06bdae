"""Error of the force at held-out pokes by phase of their course: a surrogate with time against one without.

    python -m studies.learning.by_phase DATASET WITH WITHOUT [--picture FILE]

WITH and WITHOUT are folders of runs on the same dataset and parts; `studies/learning/README.md` has the
commands that make them. Errors of the force's magnitude: mean absolute error and root mean square over the
mean force of the phase, and the mean with its sign.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from learn.data import MemoryDataset, Store, open_store
from learn.data.folds import split_of
from learn.evaluation.predictions import predict_part
from learn.models import Scenes
from learn.training import load_run
from studies.learning import without_time  # noqa: F401 - registers the model of the run without time

Floats = NDArray[np.float64]

PHASES = {"load": "ramp", "hold": "hold", "retract": "retraction"}


def forces(store: Store, run: Path) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Rows of the store in a run's test part, true and predicted forces there [N]; shape (f,)."""
    trained = load_run(run)
    if trained.uuid != store.uuid:
        raise SystemExit(f"{run}: trained on another dataset than {store.location}")
    rows = split_of(store, trained.recipe).test
    found = predict_part(trained.model, Scenes.of(store), MemoryDataset(store, rows))
    return rows, found.force, found.force_predicted


def line(truth: Floats, predicted: Floats) -> str:
    """Errors over the mean force, in per cent."""
    off, mean = predicted - truth, float(truth.mean())
    sizes = (np.abs(off).mean(), np.sqrt((off**2).mean()), off.mean())
    return " | ".join(f"{100 * float(x) / mean:.1f}" for x in sizes)


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dataset", type=Path)
    parser.add_argument("runs", type=Path, nargs=2, metavar="RUN")
    parser.add_argument("--picture", type=Path)
    given = parser.parse_args(argv)
    store = open_store(given.dataset)
    if store.clock is None:
        raise SystemExit(f"{given.dataset}: expected a dataset with time")
    (rows, truth, told), (others, _, untold) = (forces(store, run) for run in given.runs)
    if not np.array_equal(rows, others):
        raise SystemExit("the runs were tested on different pokes")
    phase = store.clock.phase[rows]
    print("phase | frames | mean force [N] | with: mean, rms, signed [%] | without: the same")
    for name, label in {**PHASES, "": "all"}.items():
        mine = phase == name if name else np.ones(rows.size, dtype=bool)
        if mine.any():
            own = f"{label} | {mine.sum()} | {truth[mine].mean():.3f}"
            print(f"{own} | {line(truth[mine], told[mine])} | {line(truth[mine], untold[mine])}")
    pokes = np.unique(store.frame_poke[rows])
    print(f"{pokes.size} pokes in the test part")
    if given.picture is not None:
        draw(store, rows, (truth, told, untold), given.picture)


def draw(store: Store, rows: NDArray[np.int64], curves: tuple[Floats, Floats, Floats], file: Path) -> None:
    """Force against time of each held-out poke."""
    from matplotlib.figure import Figure

    assert store.clock is not None
    pokes = np.unique(store.frame_poke[rows])
    figure = Figure(figsize=(2.6 * pokes.size, 2.4), layout="constrained")
    axes = figure.subplots(1, pokes.size, sharey=True, squeeze=False)[0]
    for axis, poke in zip(axes, pokes, strict=True):
        mine = store.frame_poke[rows] == poke
        time = store.clock.time[rows][mine]
        for values, style, label in zip(curves, ("k.-", "C0o", "C1x"), LABELS, strict=True):
            axis.plot(time, values[mine], style, label=label, markersize=5, fillstyle="none")
        axis.set(xscale="log", xlabel="time since contact [s]")
    axes[0].set_ylabel("force [N]")
    axes[0].legend(fontsize="small")
    figure.savefig(file, dpi=110)


LABELS = ("simulated", "surrogate with time", "without")

if __name__ == "__main__":
    main()
