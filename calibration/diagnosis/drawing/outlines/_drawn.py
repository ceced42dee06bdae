"""Data of beams for drawing: traced points on the baseline's edges, residuals before and after extension."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import arc_length
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.experiment.model import BeamTrial
from calibration.measurements.outlines._edges import edges
from calibration.measurements.outlines._photographs import SeenPhotograph, projections_of
from calibration.measurements.outlines.model import OutlineModel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnEdge:
    """One edge of a photograph with k points; lengths in m.

    Attributes
    ----------
    nearest, normal : projections onto the baseline's edge, and unit normals there, shape (k, 2).
    before, after : distances without nuisances by the baseline and by the extension (None without one), (k,).
    smooth_before, smooth_after : their smooth parts, which fits compare, shape (k,).
    smooth_sd : standard deviation of the smooth part by the contour error, shape (k,).
    along : distance from the clamp along the traced edge, shape (k,).
    """

    nearest: Array
    normal: Array
    before: Array
    after: Array | None
    smooth_before: Array
    smooth_after: Array | None
    smooth_sd: Array
    along: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnPhotograph:
    """One traced photograph, `time` [s] after the release."""

    time: float
    upper: DrawnEdge
    lower: DrawnEdge

    @property
    def edges(self) -> tuple[DrawnEdge, DrawnEdge]:
        return self.upper, self.lower

    def rms(self, when: Literal["before", "after"]) -> tuple[float, int]:
        """Mean square of the smooth distances [m^2], and number of points."""
        parts = [e.smooth_before if when == "before" else e.smooth_after for e in self.edges]
        whole = np.concatenate([p for p in parts if p is not None])
        return float(np.mean(whole**2)), len(whole)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnTrial:
    """A beam with its photographs in the order of time; body : edges of the baseline, (m, 2) each [m]."""

    trial: BeamTrial
    photographs: tuple[DrawnPhotograph, ...]
    body: tuple[Array, Array]

    @property
    def kind(self) -> str:
        name = "bridge" if self.trial.supports == "clamped-clamped" else "cantilever"
        return f"{name} {1e3 * self.trial.free_length:.4g} mm"

    def rms(self, when: Literal["before", "after"]) -> float:
        """rms of the smooth distances [m]."""
        return rms_of(self.photographs, when)

    @property
    def extended(self) -> bool:
        return self.photographs[0].upper.after is not None

    @property
    def largest(self) -> float:
        """Largest 98 % quantile of |distance| from the baseline over all edges [m]."""
        return max(float(np.quantile(np.abs(e.before), 0.98)) for p in self.photographs for e in p.edges)


def in_time(model: OutlineModel, diagnosis: Diagnosis) -> bool:
    """True if photographs of a beam are drawn separately, since the misfit depends on time.

    This is so if a named effect depends on time, or the misfit is unexplained and largest in "drifts".
    """
    chosen = diagnosis.chosen
    if chosen is not None:
        return any(model.effects[name].timed for name in chosen.names)
    return diagnosis.finding.verdict == "unexplained" and diagnosis.finding.lack_of_fit.worst == "drifts"


def rms_of(photographs: Sequence[DrawnPhotograph], when: Literal["before", "after"]) -> float:
    """rms of the smooth distances of all points [m], as in `OutlineModel.distance_rms`."""
    squares = np.array([p.rms(when) for p in photographs])
    return float(np.sqrt(np.average(squares[:, 0], weights=squares[:, 1])))


def explained_photographs(model: OutlineModel, diagnosis: Diagnosis) -> list[SeenPhotograph]:
    """Photographs with the beams of the chosen explanation, or of the baseline if there is none.

    ValueError if a beam has no equilibrium.
    """
    chosen = diagnosis.chosen
    return model.seen(diagnosis.finding.baseline.state if chosen is None else chosen.fit.state)


def drawn(model: OutlineModel, diagnosis: Diagnosis, seen: Sequence[SeenPhotograph]) -> list[DrawnTrial]:
    """All trials that have photographs, `seen` by `explained_photographs`.

    ValueError if a beam has no equilibrium.
    """
    finding = diagnosis.finding
    base = finding.baseline.state
    results = model.results(base)
    best = model.left_of(seen)
    before = best if diagnosis.chosen is None else model.registered(base)
    after = [None] * len(before) if diagnosis.chosen is None else best
    by_trial: dict[int, list[DrawnPhotograph]] = {}
    bodies: dict[int, tuple[Array, Array]] = {}
    for p, result, left, later in zip(model.records, results, before, after, strict=True):
        n = len(p.outline.upper)
        parts = (slice(n), slice(n, None))
        smooth, smooth_later = (None if d is None else p.basis @ (p.basis.T @ d) for d in (left, later))
        sd = np.sqrt(np.einsum("ij,jk,ik->i", p.basis, p.covariance, p.basis))
        assert smooth is not None
        found = [
            DrawnEdge(
                nearest=f.nearest,
                normal=f.normal,
                before=left[part],
                after=None if later is None else later[part],
                smooth_before=smooth[part],
                smooth_after=None if smooth_later is None else smooth_later[part],
                smooth_sd=sd[part],
                along=traced[0, 0] + arc_length(traced),
            )
            for f, part, traced in zip(
                projections_of(p, result), parts, (p.outline.upper, p.outline.lower), strict=True
            )
        ]
        by_trial.setdefault(p.beam, []).append(DrawnPhotograph(time=p.time, upper=found[0], lower=found[1]))
        bodies[p.beam] = edges(result)
    return [
        DrawnTrial(
            trial=model.trials[i],
            photographs=tuple(sorted(photographs, key=lambda p: p.time)),
            body=bodies[i],
        )
        for i, photographs in by_trial.items()
    ]
