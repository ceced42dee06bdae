"""What some pokes of a body of one's own give a surrogate: errors and intervals at contact points left out.

    python -m studies.learning.own_body RUN DATASET... [--epochs N]

Of each DATASET, of one body, six contact points test; RUN is adapted to four and to all of the others.
Prints the table of own-body.md, and writes own-body.png.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from matplotlib.figure import Figure
from numpy.typing import NDArray

from learn.adaptation import Adaptation, adapt, adapt_recipe
from learn.data import MemoryDataset, Store, contact_points, open_store
from learn.data.folds import frames_once
from learn.evaluation import Intervals, coverage, load_intervals, predict_part, summarise
from learn.metrics import Predictions
from learn.models import Model, Scenes
from learn.training import Run, load_run
from learn.validity import Domain, frame_distances

TESTED = 6  # contact points
GIVEN = (4, 10)  # two of the numbers of contact points to adapt to
SEED = 28


class Line(NamedTuple):
    """Errors and coverages [%] on the tested contact points; cross-validated errors of an adaptation."""

    name: str
    given: int
    mean: float
    largest: float
    tip: float
    force: float
    inside: float
    inside_points: float
    inside_force: float
    radius: float
    validated: tuple[float, float]
    seconds: float
    epochs: str


def _predicted(model: Model, store: Store, rows: NDArray[np.int64]) -> Predictions:
    return predict_part(model, Scenes.of(store), MemoryDataset(store, rows))


def _line(
    name: str,
    given: int,
    predictions: Predictions,
    *,
    store: Store,
    domain: Domain,
    intervals: Intervals,
    validated: tuple[float, float] = (np.nan, np.nan),
    seconds: float = np.nan,
    epochs: str = "",
) -> Line:
    distance = frame_distances(domain, store, predictions.poke, predictions.depth)
    row, found = summarise(predictions), coverage(intervals, predictions, distance=distance)
    return Line(
        name,
        given,
        row["mean"].mean,
        row["max"].mean,
        100 * row["tip"].mean,
        100 * row["rel force"].mean,
        100 * float((distance == 0.0).mean()),
        100 * found.points,
        100 * found.force,
        float(intervals.radius_mm(predictions, distance=distance).mean()),
        validated,
        seconds,
        epochs,
    )


def lines_of(run: Run, store: Store, *, epochs: int | None = None) -> list[Line]:
    """One line for the run as it is, and one for each number of contact points given.

    epochs : the largest number of epochs to choose among; None for that of `learn.adapt`.
    """
    recipe = adapt_recipe(run, {} if epochs is None else {"epochs": epochs})
    name = Path(store.location).stem
    rows = frames_once(store)
    keys = contact_points(store, store.frame_poke[rows])
    order = np.random.default_rng(SEED).permutation(np.unique(keys))
    test, pool = rows[np.isin(keys, order[:TESTED])], order[TESTED:]
    own = load_intervals(run)
    assert own is not None, f"{run.folder}: learn.evaluate first"
    assert run.domain is not None
    lines = [
        _line(name, 0, _predicted(run.model, store, test), store=store, domain=run.domain, intervals=own)
    ]
    for given in GIVEN:
        mine = rows[np.isin(keys, pool[:given])]
        began = time.perf_counter()
        found: Adaptation = adapt(run, store, rows=mine, recipe=recipe)
        seconds = time.perf_counter() - began
        assert found.intervals is not None
        after = summarise(found.after)
        line = _line(
            name,
            given,
            _predicted(found.kept.model, store, test),
            store=store,
            domain=found.domain,
            intervals=found.intervals,
            validated=(after["mean"].mean, 100 * after["rel force"].mean),
            seconds=seconds,
            epochs="none" if found.epochs is None else str(found.epochs),
        )
        lines.append(line)
        print(text_of(line), flush=True)
    return lines


HEADS = (
    "| body | contact points | mean mm (cross-validated) | max mm | tip % | force % (cross-validated) |"
    " frames inside the ranges % | points, forces in intervals % | mean radius mm | epochs | seconds |"
)


def text_of(line: Line) -> str:
    """A row of the table."""
    mean, force = f"{line.mean:.4f}", f"{line.force:.1f}"
    if line.given:
        mean, force = f"{mean} ({line.validated[0]:.4f})", f"{force} ({line.validated[1]:.1f})"
    seconds = f"{line.seconds:.0f}" if line.given else ""
    cells = (
        line.name,
        str(line.given or "as trained"),
        mean,
        f"{line.largest:.3f}",
        f"{line.tip:.2f}",
        force,
        f"{line.inside:.0f}",
        f"{line.inside_points:.0f}, {line.inside_force:.0f}",
        f"{line.radius:.3f}",
        line.epochs,
        seconds,
    )
    return f"| {' | '.join(cells)} |"


def draw(bodies: list[list[Line]]) -> Figure:
    """Mean and force error against the number of contact points given, one line for each body."""
    figure = Figure(figsize=(10, 3.6), layout="constrained")
    axes = figure.subplots(1, 2)
    for lines in bodies:
        given = [line.given for line in lines]
        axes[0].plot(given, [line.mean for line in lines], "o-", label=lines[0].name)
        axes[1].plot(given, [line.force for line in lines], "o-", label=lines[0].name)
    axes[0].set(ylabel="mean error [mm]")
    axes[1].set(ylabel="error of the force [%]")
    for axis in axes:
        axis.set(xlabel="contact points that the run was adapted to (0: as trained)")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("datasets", nargs="+")
    parser.add_argument("--epochs", type=int, help="largest number of epochs (learn.adapt's default: 16)")
    parser.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    run = load_run(arguments.run)
    bodies = [lines_of(run, open_store(path), epochs=arguments.epochs) for path in arguments.datasets]
    print(HEADS, "| --- " * 11 + "|", sep="\n")
    for lines in bodies:
        for line in lines:
            print(text_of(line))
    draw(bodies).savefig("own-body.png", dpi=120)


if __name__ == "__main__":
    main()
