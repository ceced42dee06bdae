"""Depths and forces reached: in the columns of the paper's table, and by shape and material level."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory.inspection import paper_table
from factory.inspection.summary import PokeSummary
from factory.reader import Dataset
from factory.simulation.record import STATUSES

MEASURES = ("deepest", "largest_force", "frame_depth", "frame_force")  # the columns of the paper's table
UNITS = ("mm", "N", "mm", "N")
# labels besides the statuses: pokes without a result, and those that a partial store lacks
FAILED, NOT_YET = "failed", "not simulated yet"
Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Mean, standard deviation, least and largest of some values."""

    mean: float
    sd: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Features:
    """Features of the pokes of one shape at one material level.

    Attributes
    ----------
    shape, level : str
    pokes, solves, frames : int
        Planned pokes, those done with a solve of their own, and frames.
    deepest, force : Spread or None
        Deepest frame [mm] and largest force [N] per poke that has frames; None if none has.
    reached : float or None
        Mean ratio of the deepest frame to the requested depth.
    ended : dict of str to int
        Number of pokes by reason of their end: a status, "failed" or "not simulated yet".
    """

    shape: str
    level: str
    pokes: int
    solves: int
    frames: int
    deepest: Spread | None
    force: Spread | None
    reached: float | None
    ended: dict[str, int]


def measures(pokes: Sequence[PokeSummary]) -> tuple[Pair, ...] | None:
    """Mean and standard deviation of `MEASURES` [mm, N]; None if no poke has frames."""
    kept = [poke for poke in pokes if len(poke.depth)]
    if not kept:
        return None
    columns = (
        np.array([poke.depth.max() for poke in kept]) * 1e3,
        np.array([poke.force.max() for poke in kept]),
        np.concatenate([poke.depth for poke in kept]) * 1e3,
        np.concatenate([poke.force for poke in kept]),
    )
    return tuple((float(values.mean()), float(values.std())) for values in columns)


def features(data: Dataset, pokes: Sequence[PokeSummary]) -> list[Features]:
    """Features by shape and material level, in the order of the store.

    Parameters
    ----------
    data : Dataset
    pokes : sequence of PokeSummary
        All pokes of the dataset that are done.
    """
    asked = data.table["depth_asked"]
    own = own_solves(data)
    found = []
    for shape_number, shape in enumerate(data.shapes):
        for level_number, level in enumerate(data.levels):
            here = (data.table["poke_shape"] == shape_number) & (data.table["poke_softness"] == level_number)
            those = [poke for poke in pokes if here[poke.index]]
            kept = [poke for poke in those if len(poke.depth)]
            deepest = np.array([poke.depth.max() for poke in kept])
            wanted = np.array([asked[poke.index] for poke in kept])
            ended = Counter(poke.status for poke in those)
            lacking = int(here[list(data.waiting)].sum())
            ended[NOT_YET] += lacking
            ended[FAILED] += int(here.sum()) - len(those) - lacking
            found.append(
                Features(
                    shape=shape,
                    level=level,
                    pokes=int(here.sum()),
                    solves=int((here & own & data.table["done"]).sum()),
                    frames=sum(len(poke.depth) for poke in those),
                    deepest=_spread(deepest * 1e3),
                    force=_spread(np.array([poke.force.max() for poke in kept])),
                    reached=float((deepest / wanted).mean()) if kept else None,
                    ended={name: count for name, count in ended.items() if count},
                )
            )
    return found


def own_solves(data: Dataset) -> NDArray[np.bool_]:
    """True for each poke with a solve of its own, shape (pokes,)."""
    number = np.arange(data.n_pokes)
    return np.asarray(data.table.get("solved_as", number) == number)


def write_features(rows: Sequence[Features], path: Path) -> None:
    """Write features.csv: one line per shape and material level."""
    ends = [*(str(s) for s in STATUSES), FAILED, NOT_YET]
    parts = ("mean", "sd", "min", "max")
    head = ["shape", "softness", "pokes", "solves", "frames"]
    head += [f"deepest_{part}_mm" for part in parts] + [f"largest_force_{part}_N" for part in parts]
    head += ["reached_fraction", *(f"ended_{name.replace('-', '_').replace(' ', '_')}" for name in ends)]
    lines: list[list[Any]] = []
    for row in rows:
        line: list[Any] = [row.shape, row.level, row.pokes, row.solves, row.frames]
        for spread in (row.deepest, row.force):
            line += (
                [_digits(v) for v in (spread.mean, spread.sd, spread.low, spread.high)]
                if spread
                else [""] * 4
            )
        line.append("" if row.reached is None else _digits(row.reached))
        lines.append([*line, *(row.ended.get(name, 0) for name in ends)])
    _write(path, [head, *lines])


def write_softness(law: str, pokes: Sequence[PokeSummary], levels: Sequence[str], path: Path) -> None:
    """Write softness.csv: the columns of the paper's table for this dataset and the paper, or empty."""
    heads = [
        f"{name}_{part}_{unit}" for name, unit in zip(MEASURES, UNITS, strict=True) for part in ("mean", "sd")
    ]
    head = ["softness", "pokes", "frames", *heads, "paper_pokes", *(f"paper_{name}" for name in heads)]
    lines: list[list[Any]] = []
    for level in levels:
        those = [poke for poke in pokes if poke.level == level]
        paper = paper_table.PAPER.get(law, {}).get(level)
        lines.append(
            [
                level,
                len(those),
                sum(len(poke.depth) for poke in those),
                *_flat(measures(those), _digits),
                paper_table.pokes_a_level() if paper else "",
                *_flat(paper, lambda value: f"{value:.2f}"),
            ]
        )
    _write(path, [head, *lines])


def _spread(values: NDArray[np.float64]) -> Spread | None:
    if not len(values):
        return None
    mean, sd, low, high = (float(v) for v in (values.mean(), values.std(), values.min(), values.max()))
    return Spread(mean=mean, sd=sd, low=low, high=high)


def _flat(pairs: Sequence[Pair] | None, text: Callable[[float], str]) -> list[str]:
    return [text(v) for pair in pairs for v in pair] if pairs else [""] * (2 * len(MEASURES))


def _digits(value: float) -> str:
    return f"{value:.6g}"


def _write(path: Path, lines: Sequence[Sequence[Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(lines)
