"""Metrics of predictions against the simulated truth.

`METRICS` holds every metric by name, in the order of the tables. To add one, write a function of
`Predictions` that returns one number per frame (or per poke) and register it:

>>> from learn.metrics import Predictions, register_metric
>>> @register_metric("median", units="mm", text="median over all points of |predicted - true|")
... def median_distance(predictions: Predictions):
...     return np.median(predictions.distance_mm, axis=1)

Every table of `learn.evaluate` then has its column; `--plugin FILE` imports the file that registers it.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from learn.quantities import COVARIATES

Floats = NDArray[np.float64]
RING_EDGES_MM = (0.0, 5.0, 10.0, 20.0, 40.0, np.inf)  # distance of undeformed points from first contact
BAD_MM = 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Predictions:
    """Predictions of f frames at n points, with the simulated truth. SI units.

    Attributes
    ----------
    truth, predicted : displacement [m], shape (f, n, 3).
    force, force_predicted : magnitude of the force on the indenter [N], shape (f,).
    away : distance of each point's rest position from the indenter's tip at first contact [m], shape (f, n).
    depth : indentation depth [m], shape (f,).
    poke : index of the poke that each frame belongs to, shape (f,).
    softness : name of the softness level, shape (f,).
    shape : name of the inclusion's shape, shape (f,); "" if it is not known.
    cover : cover over the inclusion where the indenter's axis meets the surface [mm], shape (f,); 0 if it is
        not known.
    covariates : what the errors depend on besides each point (`learn.quantities.covariates`), shape
        (f, len(COVARIATES)); 0 if they are not known.
    spread : standard deviation of an ensemble's members [m], shape (f, n); 0 for one model.
    force_spread : standard deviation of the members' ln(force), shape (f,); 0 for one model.
    clock : time since contact and the indenter's speeds of each frame, as in `learn.models.Pokes`, shape
        (f, 3); (f, 0) without time.
    """

    truth: NDArray[np.float32]
    predicted: NDArray[np.float32]
    force: Floats
    force_predicted: Floats
    away: Floats
    depth: Floats
    poke: NDArray[np.int64]
    softness: NDArray[np.str_]
    shape: NDArray[np.str_] = field(default_factory=lambda: np.zeros(0, dtype=np.str_))
    cover: Floats = field(default_factory=lambda: np.zeros(0))
    covariates: Floats = field(default_factory=lambda: np.zeros(0))
    spread: Floats = field(default_factory=lambda: np.zeros(0))
    force_spread: Floats = field(default_factory=lambda: np.zeros(0))
    clock: Floats = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not self.spread.size:
            object.__setattr__(self, "spread", np.zeros(self.away.shape))
        if not self.shape.size:
            object.__setattr__(self, "shape", np.full(self.depth.shape, ""))
        if not self.cover.size:
            object.__setattr__(self, "cover", np.zeros(self.depth.shape))
        if not self.covariates.size:
            object.__setattr__(self, "covariates", np.zeros((*self.depth.shape, len(COVARIATES))))
        if not self.force_spread.size:
            object.__setattr__(self, "force_spread", np.zeros(self.depth.shape))
        if not self.clock.size:
            object.__setattr__(self, "clock", np.zeros((*self.depth.shape, 0)))

    @property
    def distance_mm(self) -> Floats:
        """Euclidean distance of predicted and true positions [mm], shape (f, n)."""
        wrong = self.predicted.astype(np.float64) - self.truth
        return np.asarray(np.sqrt((wrong**2).sum(axis=2)) * 1e3)

    @property
    def pokes(self) -> int:
        """Number of distinct pokes."""
        return len(np.unique(self.poke))

    def where(self, keep: NDArray[np.bool_]) -> Predictions:
        """The frames for which `keep`, shape (f,), is true."""
        return Predictions(**{name: getattr(self, name)[keep] for name in self.__dataclass_fields__})


def join_predictions(parts: Sequence[Predictions]) -> Predictions:
    """Concatenate the frames of all parts."""
    names = Predictions.__dataclass_fields__
    return Predictions(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One column of the tables.

    Attributes
    ----------
    name, units : heading of the column.
    text : definition, one line, for the report.
    values : function of `Predictions` that returns one number per frame (or poke); NaN if undefined.
    percent : True to print a percentage.
    digits : number of digits after the decimal point.
    """

    name: str
    units: str
    text: str
    values: Callable[[Predictions], Floats]
    percent: bool = False
    digits: int = 3

    @property
    def heading(self) -> str:
        """Name with unit."""
        return f"{self.name} [{self.units}]" if self.units else self.name


METRICS: dict[str, Metric] = {}


def register_metric(
    name: str, *, units: str, text: str, percent: bool = False, digits: int = 3
) -> Callable[[Callable[[Predictions], Floats]], Callable[[Predictions], Floats]]:
    """Decorator that adds a function of `Predictions` to `METRICS`.

    Parameters
    ----------
    name, units, text, percent, digits : see `Metric`. An existing name is replaced.
    """

    def register(function: Callable[[Predictions], Floats]) -> Callable[[Predictions], Floats]:
        METRICS[name] = Metric(
            name=name, units=units, text=text, values=function, percent=percent, digits=digits
        )
        return function

    return register


@register_metric("mean", units="mm", text="mean over all points of |predicted - true|", digits=4)
def mean_distance(predictions: Predictions) -> Floats:
    """Mean Euclidean distance of a frame, as in the paper [mm]."""
    return predictions.distance_mm.mean(axis=1)


@register_metric("max", units="mm", text="largest |predicted - true| of a frame")
def max_distance(predictions: Predictions) -> Floats:
    """Largest Euclidean distance of a frame, as in the paper [mm]."""
    return predictions.distance_mm.max(axis=1)


@register_metric(
    "tip",
    units="%",
    percent=True,
    digits=2,
    text="|predicted - true| at the point that rests nearest to first contact, relative to the depth",
)
def tip_error(predictions: Predictions) -> Floats:
    """Tip error as a fraction of the depth. The paper does not define its own; this is our choice."""
    nearest = predictions.away.argmin(axis=1)
    wrong = predictions.distance_mm[np.arange(len(nearest)), nearest]
    return np.asarray(wrong / (predictions.depth * 1e3))


@register_metric(
    "force", units="N", text="|predicted - true| of the magnitude of the indenter's force, as in the paper"
)
def force_error(predictions: Predictions) -> Floats:
    """Absolute force error [N]."""
    return np.abs(predictions.force_predicted - predictions.force)


@register_metric("rel force", units="%", percent=True, digits=1, text="the same relative to the true force")
def relative_force_error(predictions: Predictions) -> Floats:
    """Force error as a fraction of the true force."""
    return np.asarray(np.abs(predictions.force_predicted - predictions.force) / predictions.force)


def ring_distance(predictions: Predictions, low: float, high: float) -> Floats:
    """Mean distance [mm] of points that rest low to high [mm] from first contact; NaN without any."""
    inside = (predictions.away * 1e3 >= low) & (predictions.away * 1e3 < high)
    count = inside.sum(axis=1)
    total = np.where(inside, predictions.distance_mm, 0).sum(axis=1)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))


for _low, _high in itertools.pairwise(RING_EDGES_MM):
    _name = f"{_low:g}+" if np.isinf(_high) else f"{_low:g}-{_high:g}"
    register_metric(f"{_name} mm", units="mm", text=f"mean distance of points {_name} mm from first contact")(
        functools.partial(ring_distance, low=_low, high=_high)
    )


@register_metric("rel L2", units="", text="sqrt(sum |predicted - true|^2 / sum |true|^2) of a frame")
def relative_l2(predictions: Predictions) -> Floats:
    """Relative L2 error of a frame's displacement field."""
    size = np.sqrt((predictions.truth.astype(np.float64) ** 2).sum(axis=(1, 2))) * 1e3
    return np.asarray(np.sqrt((predictions.distance_mm**2).sum(axis=1)) / size)


@register_metric(
    "worse than 1 mm",
    units="%",
    percent=True,
    digits=0,
    text="fraction of pokes with any point of any frame more than 1 mm off",
)
def bad_pokes(predictions: Predictions) -> Floats:
    """One value per poke: 1 if the error of any of its points exceeds `BAD_MM`, else 0."""
    worst = predictions.distance_mm.max(axis=1)
    pokes = np.unique(predictions.poke)
    return np.array([float(worst[predictions.poke == p].max() > BAD_MM) for p in pokes])


@register_metric(
    "skill",
    units="",
    digits=2,
    text="1 - mean distance / mean true displacement of a frame: 0 for no motion predicted, 1 for no error",
)
def skill(predictions: Predictions) -> Floats:
    """Skill against a prediction of zero displacement."""
    still = np.sqrt((predictions.truth.astype(np.float64) ** 2).sum(axis=2)).mean(axis=1) * 1e3
    return np.asarray(1 - predictions.distance_mm.mean(axis=1) / still)
