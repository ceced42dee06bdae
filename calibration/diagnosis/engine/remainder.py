"""Unexplained misfit of a fit: its size, its location along the records, and its repeatability.

Misfit that repeats only within a specimen is attributed to that specimen; misfit that repeats in all
specimens to the form of the model or to the rig; misfit that does not repeat is noise (as in gauge
repeatability and reproducibility studies).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]
Repeats = Literal["everywhere", "within a material", "within a specimen", "nowhere", "not known"]

BINS = 12  # parts of a record, in which the remainders of two records are compared
ALIKE = 0.5  # mean cosine from which on a remainder repeats
ZERO = 1e-3  # relative to a range: smaller values are printed as zero
MOST = 0.5  # fraction of the sum of squares in a third of the range, or in few records, that is reported


@dataclass(frozen=True, kw_only=True)
class Remainder:
    """Unexplained misfit in excess of noise.

    Attributes
    ----------
    rms : root mean square in excess of noise [SI]; 0 if there is none.
    of_full_scale : the same relative to each record's largest value; None if records have no full scale.
    repeats : widest level at which the residuals repeat.
    cosines : mean cosine between the residuals of two records, by level; levels without a pair are absent.
    records : names of the records that contain most of it; () if these are not a minority of the records.
    place : quantity and range along the records that contain most of it; "" if not known.
    negligible : True if `of_full_scale` is below `Rules.negligible_fraction`.
    """

    rms: float
    of_full_scale: float | None
    repeats: Repeats
    cosines: dict[str, float]
    records: tuple[str, ...]
    place: str
    negligible: bool = False


def remainder_of(model: MeasurementModel, fit: Fit, *, negligible: float) -> Remainder:
    """Unexplained misfit of a fit.

    Parameters
    ----------
    negligible : fraction of full scale below which the misfit is negligible in practice.

    Raises
    ------
    ValueError : the simulator has no solution at the fitted state.
    """
    left = [np.asarray(x) for x in model.registered(fit.state)]
    rms = beyond(model.distance_rms(fit.state), model.noise_rms())
    scale = model.full_scale()
    cosines = _cosines(model.records, left)
    squares = np.array([float(np.nansum(x**2)) for x in left])
    if scale is not None:
        squares = squares / scale**2
    part = relative_rms(model, fit)
    return Remainder(
        rms=rms,
        of_full_scale=part,
        negligible=part is not None and part < negligible,
        repeats=_repeats(cosines, model),
        cosines=cosines,
        records=_holders(model.records, squares),
        place=_place(model, left),
    )


def about_remainder(left: Remainder) -> str:
    """Recommended next measurement to clarify the unexplained misfit; "" if it is zero or negligible."""
    if left.rms == 0.0 or left.negligible:
        return ""
    return {
        "everywhere": "the remaining misfit repeats in all of them: test in another mode, at another rate"
        " or on"
        " another rig, to separate the form of the model from the rig",
        "within a material": "the remaining misfit repeats within each material: test one of them in"
        " another mode,"
        " since the form of its law may be at fault",
        "within a specimen": "the remaining misfit repeats within a specimen: turn it, or test another"
        " specimen of"
        " the same batch",
        "nowhere": "the remaining misfit differs from test to test: repeat tests, to measure their scatter",
        "not known": "repeat a test, to find out whether the remaining misfit repeats",
    }[left.repeats]


def beyond(rms: float, noise: float) -> float:
    """Root mean square in excess of noise: sqrt(max(rms^2 - noise^2, 0))."""
    return float(np.sqrt(max(rms**2 - noise**2, 0.0)))


def relative_rms(model: MeasurementModel, fit: Fit) -> float | None:
    """Root mean square in excess of noise, each record relative to its largest value.

    None if records have no full scale.
    """
    scale = model.full_scale()
    if scale is None:
        return None
    total = noise = 0.0
    points = 0
    for k, x in enumerate(model.registered(fit.state)):
        here = np.isfinite(x)
        rows = (model.row_record == k) & model.noise.used
        total += float(np.sum(x[here] ** 2)) / scale[k] ** 2
        noise += float(np.sum((model.noise_scale * model.noise.sd[rows]) ** 2)) / scale[k] ** 2
        points += int(np.count_nonzero(here))
    return float(np.sqrt(max(total - noise, 0.0) / points)) if points else 0.0


def _binned(values: Array) -> Array | None:
    """Means of the finite residuals in `BINS` equal parts of a record; None if there are too few of them."""
    own = values[np.isfinite(values)]
    if own.size < BINS:
        return None
    return np.array([float(part.mean()) for part in np.array_split(own, BINS)])


def _cosines(records: Sequence[Any], left: Sequence[Array]) -> dict[str, float]:
    """Mean cosine between the residuals of two records of the same test mode, by level (`_level`)."""
    found: dict[str, list[float]] = {}
    curves = [_binned(x) for x in left]
    for a, b in combinations(range(len(records)), 2):
        one, other = curves[a], curves[b]
        if one is None or other is None or _kind(records[a]) != _kind(records[b]):
            continue
        size = float(np.linalg.norm(one) * np.linalg.norm(other))
        if size > 0.0:
            found.setdefault(_level(records[a], records[b]), []).append(float(one @ other) / size)
    return {level: float(np.mean(values)) for level, values in found.items()}


def _kind(record: Any) -> str:
    return str(getattr(record, "groups", {}).get("mode", ""))


def _level(one: Any, other: Any) -> str:
    if one.material != other.material:
        return "materials"
    return "one specimen" if one.specimen == other.specimen else "specimens"


def _repeats(cosines: dict[str, float], model: MeasurementModel) -> Repeats:
    if not cosines:
        return "not known"
    if cosines.get("materials", -1.0) >= ALIKE:
        return "everywhere"
    if cosines.get("specimens", -1.0) >= ALIKE:
        return "within a material" if len(model.baseline.materials) > 1 else "everywhere"
    if cosines.get("one specimen", -1.0) >= ALIKE:
        return "within a specimen"
    return "nowhere"


def _holders(records: Sequence[Any], squares: Array) -> tuple[str, ...]:
    """Names of the fewest records with `MOST` of the sum of squares; () if they are over half of all."""
    total = float(squares.sum())
    if not total > 0.0 or len(records) < 2:
        return ()
    order = np.argsort(-squares)
    count = int(np.searchsorted(np.cumsum(squares[order]), MOST * total)) + 1
    return tuple(str(records[k].name) for k in order[:count]) if count < 0.5 * len(records) + 0.5 else ()


def _place(model: MeasurementModel, left: Sequence[Array]) -> str:
    """The third of the range of the driven quantity that contains at least `MOST` of the sum of squares."""
    along = [model.along(k) for k in range(len(model.records))]
    pairs = [(a, x) for a, x in zip(along, left, strict=True) if a is not None]
    if not pairs:
        return ""
    name = pairs[0][0][0]
    where = np.concatenate([a[1] for a, _ in pairs])
    value = np.concatenate([np.nan_to_num(x) ** 2 for _, x in pairs])
    known = np.isfinite(where) & (value > 0.0)
    if not known.any():
        return ""
    where, value = where[known], value[known]
    edges = np.linspace(where.min(), where.max(), 4)
    held = [float(value[(where >= a) & (where <= b)].sum()) for a, b in pairwise(edges)]
    best = int(np.argmax(held))
    if held[best] < MOST * float(value.sum()):
        return ""
    low, high = (0.0 if abs(x) < ZERO * abs(edges[-1] - edges[0]) else x for x in edges[best : best + 2])
    return f"{name} {low:.3g} to {high:.3g}"
