"""Traced photographs of beams, and distances of their points from a simulated beam."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, TracedOutline
from calibration.measurements._records import OfBeam
from calibration.measurements.outlines._edges import Projection, edges, project
from calibration.measurements.outlines._noise import contour_root, smooth_basis
from tisim import Result

Array = NDArray[np.float64]
Image = Callable[[Array], Array]


# Points nearer to a clamp than CORNER half heights are left out. Near the clamp a squeezed section and the
# singularity of the corner are visible: functions that decay over DECAYS half heights are added to the
# polynomials, which could not represent them.
CORNER = 0.08
DECAYS = (0.5, 0.2)


@dataclass(frozen=True, eq=False, kw_only=True)
class TracedPhotograph(OfBeam):
    """One traced photograph of a beam.

    Attributes
    ----------
    trial : trial of the beam.
    beam : index of the trial among those of the model.
    name : unique (`names_of`).
    time : time since its release [s].
    outline : traced outline of k points, without those next to clamps.
    basis : orthonormal basis of polynomials along each edge and of decays from each clamp, shape (k, m).
    corners : coefficients of the decays, of height 1 at the clamp, shape (m, c).
    covariance : covariance of the coefficients by the contour's error [m2], shape (m, m).
    rows : slice of its coefficients among those of all photographs.
    """

    trial: BeamTrial
    beam: int
    name: str
    time: float
    outline: TracedOutline
    basis: Array
    corners: Array
    covariance: Array
    rows: slice

    @cached_property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.specimen, "trial": self.trial.id}

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        return self._ranges([self.time])


@dataclass(frozen=True, eq=False, kw_only=True)
class SeenPhotograph:
    """A photograph with its simulated beam.

    Attributes
    ----------
    photograph : the traced photograph.
    projections : projections of its points onto the upper and the lower edge, in the image.
    simulated : upper and lower edge of the beam in the image [m], shape (m, 2) each.
    raw : distances of all points, corrected for the mesh error [m], shape (k,).
    left : `raw` without the most likely nuisances [m], shape (k,).
    result : the simulated beam.
    images : maps from the scene to the image.
    """

    photograph: TracedPhotograph
    projections: Sequence[Projection]
    simulated: Sequence[Array]
    raw: Array
    left: Array
    result: Result
    images: Sequence[Image]


def away_from_clamps(outline: TracedOutline, trial: BeamTrial, *, zone: float = CORNER) -> TracedOutline:
    """Outline without the points nearer to a clamp than `zone` half heights of the section.

    InputError if fewer than 3 points of an edge remain.
    """
    half = trial.section.half_height
    end = trial.free_length if trial.supports == "clamped-clamped" else np.inf

    def kept(edge: Array) -> Array:
        # a clamped far end has the same x at rest and in the deformed state
        return edge[(edge[:, 0] > zone * half) & (edge[:, 0] < end - zone * half)]

    upper, lower = kept(outline.upper), kept(outline.lower)
    if min(len(upper), len(lower)) < 3:
        raise InputError(
            f"trial {trial.id}: outline: expected at least 3 points an edge that lie further than"
            f" {zone * half * 1e3:.1f} mm from the clamps"
        )
    return replace(outline, upper=upper, lower=lower)


def names_of(trial: BeamTrial) -> list[str]:
    """Unique name of each traced photograph of a trial: several of one instant have a number.

    Under one name the nuisances of one would hide those of another.
    """
    names = [f"{trial.id} at {c.time:g} s" for c in trial.captures if c.outline is not None]
    return [n if names.count(n) == 1 else f"{n} ({names[: k + 1].count(n)})" for k, n in enumerate(names)]


def photographs_of(trials: Sequence[BeamTrial]) -> list[TracedPhotograph]:
    """All traced photographs. InputError if an outline has too few points away from the clamps."""
    found: list[TracedPhotograph] = []
    first = 0
    for i, t in enumerate(trials):
        traced_captures = [c for c in t.captures if c.outline is not None]
        for c, name in zip(traced_captures, names_of(t), strict=True):
            assert c.outline is not None
            traced = away_from_clamps(c.outline, t)
            corners = _corners(traced, t)
            basis = np.linalg.qr(np.column_stack([smooth_basis(traced), corners]))[0]
            half = basis.T @ contour_root(traced)
            rows = slice(first, first + basis.shape[1])
            found.append(
                TracedPhotograph(
                    trial=t,
                    beam=i,
                    name=name,
                    time=c.time,
                    outline=traced,
                    basis=basis,
                    corners=basis.T @ corners,
                    covariance=half @ half.T,
                    rows=rows,
                )
            )
            first = rows.stop
    return found


def _corners(outline: TracedOutline, trial: BeamTrial) -> Array:
    """Exponential decays from each clamp along each edge, of height 1 at the clamp, shape (k, c)."""
    half = trial.section.half_height
    ends = (0.0, trial.free_length) if trial.supports == "clamped-clamped" else (0.0,)
    n = len(outline.upper)
    x = np.concatenate([outline.upper[:, 0], outline.lower[:, 0]])
    columns = []
    for edge in (np.arange(len(x)) < n, np.arange(len(x)) >= n):
        for end in ends:
            for decay in DECAYS:
                columns.append(np.where(edge, np.exp(-np.abs(x - end) / (decay * half)), 0.0))
    return np.column_stack(columns)


def shown(line: Array, images: Sequence[Image]) -> Array:
    """Map points (k, 2) of the scene to the image."""
    for image in images:
        line = image(line)
    return line


def projections_of(
    photograph: TracedPhotograph, result: Result, images: Sequence[Image] = ()
) -> list[Projection]:
    """Projections of a photograph's points onto the upper and the lower edge of a beam, in the image."""
    upper, lower = (shown(line, images) for line in edges(result))
    return [project(photograph.outline.upper, upper), project(photograph.outline.lower, lower)]


def distances(both: Sequence[Projection]) -> Array:
    """Signed distances [m] of the upper, then the lower points, shape (k,)."""
    return np.concatenate([f.distance for f in both])


def coefficients(photograph: TracedPhotograph, result: Result, images: Sequence[Image] = ()) -> Array:
    """Coefficients of a photograph's distances from a simulated beam in its basis [m], shape (m,)."""
    return np.asarray(photograph.basis.T @ distances(projections_of(photograph, result, images)))
