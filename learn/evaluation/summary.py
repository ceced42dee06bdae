"""Metrics of cases as mean and standard deviation, as rows of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from learn.metrics import METRICS, Cases, Metric


@dataclass(frozen=True)
class Value:
    """mean and sd over frames (or pokes); NaN where there were none."""

    mean: float
    sd: float

    def text(self, metric: Metric, *, sd: bool = True) -> str:
        scale = 100 if metric.percent else 1
        if not np.isfinite(self.mean):
            return "-"
        first = f"{round(self.mean * scale, metric.digits) + 0.0:.{metric.digits}f}"
        return f"{first} ± {self.sd * scale:.{metric.digits}f}" if sd else first


def summarise(cases: Cases) -> dict[str, Value]:
    """Every metric of `METRICS`."""
    return {name: _value(metric, cases) for name, metric in METRICS.items()}


def by_softness(cases: Cases) -> dict[str, dict[str, Value]]:
    """The same for each softness level, in the order of their names, and for all."""
    names = sorted({str(s) for s in cases.softness})
    rows = {name: summarise(cases.where(cases.softness == name)) for name in names}
    return {**rows, "all": summarise(cases)}


def over_folds(folds: list[dict[str, Value]]) -> dict[str, Value]:
    """Mean of the folds' means, and their standard deviation; of one fold, that fold's own."""
    if len(folds) == 1:
        return folds[0]
    return {name: _joined([fold[name].mean for fold in folds]) for name in folds[0]}


def _joined(means: list[float]) -> Value:
    known = np.array([v for v in means if np.isfinite(v)])
    if not len(known):
        return Value(float("nan"), float("nan"))
    return Value(float(known.mean()), float(known.std(ddof=1)) if len(known) > 1 else float("nan"))


def _value(metric: Metric, cases: Cases) -> Value:
    values = metric.values(cases)
    values = values[np.isfinite(values)]
    if not len(values):
        return Value(float("nan"), float("nan"))
    return Value(float(values.mean()), float(values.std()))
