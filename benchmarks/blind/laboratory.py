"""Interface of the controls to a kind of measurement: its cases, their files, and the data without noise.

The true share of causes in a synthetic case is defined by the data without noise. Fitting moduli alone (per
specimen, or per material, as the lab would) leaves the explainable misfit; fitting moduli and the amplitudes
of these causes, in their true form, leaves less. The share is the fraction of squares removed. For one of
several causes it is the Shapley value: the mean of its contribution over all orders, so that shares add up.
Squares are in units of the stated noise; moduli and amplitudes are linearised around the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import factorial
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.records import Put

Array = NDArray[np.float64]
C = TypeVar("C")

SMOOTH = (0.003, 0.01)  # rms of an unstated error over full scale
WAVES = 4


@dataclass(frozen=True, kw_only=True)
class Laboratory(Generic[C]):
    """A kind of measurement.

    Attributes
    ----------
    clean : case without a hidden cause, by its seed.
    one : case with one cause of the library, by seed and size in standard deviations.
    half : case with one cause of the library and, second, one outside it, each of that size; None if its
        protocol cannot show both so large.
    two : case with two causes of the library, each of that size or more.
    write : writes the experiment's folder, without the truth.
    hidden : causes of a case.
    whitened : data without noise with these causes, over the standard deviation of the noise, shape (k,).
    free : columns of the moduli, shape (k, moduli).
    diagnose : verdict on a folder, with effects removed from the catalogue.
    smooth_error : adds an unstated smooth error to the measured data, by folder and seed.
    same : for effects of the catalogue, the hidden causes of which they are an equivalent description.
    """

    clean: Callable[[int], C]
    one: Callable[[int, float], C]
    half: Callable[[int, float], C | None]
    two: Callable[[int, float], C]
    write: Callable[[C, Path], None]
    hidden: Callable[[C], Sequence[Put]]
    whitened: Callable[[C, Sequence[Any]], Array]
    free: Callable[[C], Array]
    diagnose: Callable[..., dict[str, Any]]
    smooth_error: Callable[[Path, int], None]
    same: Mapping[str, frozenset[str]] = field(default_factory=dict)

    def true_shares(self, case: C, names: Iterable[str]) -> dict[str, float]:
        """True share of each cause of these names; they add up to the share of all of them."""
        base = self.whitened(case, ())
        every = list(self.hidden(case))
        departure = self.whitened(case, every) - base
        columns = {h.name: self.whitened(case, (h,)) - base for h in every}
        return shapley(departure, self.free(case), {n: columns[n] for n in sorted(set(names))})


def smooth_error_of_records(*, measured: int, stated: str) -> Callable[[Path, int], None]:
    """Function that adds a smooth error to each record of a folder, and removes the stated noise.

    Parameters
    ----------
    measured : column of the records with the measured quantity.
    stated : key of a trial by which the lab states its noise.
    """

    def put(folder: Path, seed: int) -> None:
        rng = np.random.default_rng([seed, 7])
        size = log_uniform(rng, SMOOTH)
        path = folder / "experiment.yaml"
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        for trial in content["trials"]:
            trial.pop(stated, None)
            record = folder / trial["record"]
            head, *rows = record.read_text(encoding="utf-8").splitlines()
            table = np.array([[float(x) for x in row.split(",")] for row in rows])
            own = table[:, measured]
            own += size * np.abs(own).max() * waves(rng, np.linspace(0.0, 1.0, len(table)))
            lines = [head, *(",".join(f"{v:.9g}" for v in row) for row in table)]
            record.write_text("\n".join(lines) + "\n", encoding="utf-8")
        path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")

    return put


def log_uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    return float(np.exp(rng.uniform(*np.log(limits))))


def waves(rng: np.random.Generator, at: Array) -> Array:
    """Smooth random error of rms 1 at positions `at`, fractions of a record's or an edge's length."""
    found = sum(rng.standard_normal() * np.cos(np.pi * (k * at + rng.random())) for k in range(1, WAVES + 1))
    return np.asarray(found / np.sqrt(np.mean(np.square(found))))


def shapley(departure: Array, free: Array, columns: dict[str, Array]) -> dict[str, float]:
    """Shapley shares of the columns in the part of `departure` (k,) that the columns `free` (k, n) leave."""
    names = list(columns)
    whole = left(free, departure)
    taken = {
        some: 1.0 - left(np.column_stack([free, *(columns[n] for n in some)]), departure) / whole
        for size in range(len(names) + 1)
        for some in combinations(names, size)
    }
    shares = {}
    for name in names:
        others = [n for n in names if n != name]
        shares[name] = sum(
            factorial(size)
            * factorial(len(others) - size)
            / factorial(len(names))
            * (taken[tuple(n for n in names if n in (*some, name))] - taken[some])
            for size in range(len(names))
            for some in combinations(others, size)
        )
    return shares


def left(columns: Array, z: Array) -> float:
    """Sum of squares of z that a least-squares fit of the columns leaves."""
    q, _ = np.linalg.qr(columns / np.linalg.norm(columns, axis=0))
    return float(z @ z - (q.T @ z) @ (q.T @ z))
