"""Traced photographs of beams, and where their points lie against a simulated beam."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, TracedOutline
from calibration.measurements.outlines._edges import Feet, edges, feet
from calibration.measurements.outlines._noise import contour_root, smooth_basis
from tisim import Circle, Result

Array = NDArray[np.float64]
Image = Callable[[Array], Array]


# Points nearer to a clamp than this part of the half height are left out. Up to some halves of it a squeezed
# section shows, and the corner's singularity: what dies away over these lengths, in half heights, is kept
# beside the polynomials, which could not follow it.
CORNER = 0.08
DECAYS = (0.5, 0.2)


@dataclass(frozen=True, eq=False, kw_only=True)
class TracedPhotograph:
    """One traced photograph of a beam.

    Attributes
    ----------
    trial : of the beam; beam : its index among the trials of the model.
    time : after its release [s].
    basis : orthonormal, of what is smooth along each edge, and of what dies away from each clamp, shape (k,
    m).
    corners : the latter, of height 1 at the clamp, in coefficients, shape (m, c).
    covariance : of the contour's error in these coefficients [m2], shape (m, m).
    rows : of its coefficients among those of all photographs.
    """

    trial: BeamTrial
    beam: int
    time: float
    outline: TracedOutline
    basis: Array
    corners: Array
    covariance: Array
    rows: slice

    @property
    def name(self) -> str:
        return f"{self.trial.id} at {self.time:g} s"

    @property
    def material(self) -> str:
        return self.trial.material

    @property
    def specimen(self) -> str:
        return self.trial.specimen or self.trial.material

    @cached_property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.specimen, "trial": self.trial.id}

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        length = 1e3 * self.trial.free_length
        return {"free_length_mm": (length, length), "time_s": (self.time, self.time)}


@dataclass(frozen=True, eq=False, kw_only=True)
class SeenPhotograph:
    """A photograph against its simulated beam.

    Attributes
    ----------
    photograph : the traced one.
    feet : of its points on the upper and on the lower edge, as the camera shows them.
    simulated : upper and lower edge of the beam, as the camera shows them, (m, 2) each [m].
    raw, left : distances of all points [m], (k,), the mesh's error corrected: as traced, and with the most
        likely nuisances removed.
    result : the simulated beam; images : what the camera does to it.
    """

    photograph: TracedPhotograph
    feet: Sequence[Feet]
    simulated: Sequence[Array]
    raw: Array
    left: Array
    result: Result
    images: Sequence[Image]


def away_from_clamps(outline: TracedOutline, trial: BeamTrial, *, zone: float = CORNER) -> TracedOutline:
    """The outline without the points nearer to a clamp than `zone` half heights of the section; InputError
    where fewer than 3 an edge are left."""
    section = trial.section
    half = section.radius if isinstance(section, Circle) else section.height / 2.0
    end = trial.free_length if trial.supports == "clamped-clamped" else np.inf

    def kept(edge: Array) -> Array:
        # where the far end is held, x of the free part at rest and bent agree there
        return edge[(edge[:, 0] > zone * half) & (edge[:, 0] < end - zone * half)]

    upper, lower = kept(outline.upper), kept(outline.lower)
    if min(len(upper), len(lower)) < 3:
        raise InputError(
            f"trial {trial.id}: outline: expected at least 3 points an edge that lie further than"
            f" {zone * half * 1e3:.1f} mm from the clamps"
        )
    return replace(outline, upper=upper, lower=lower)


def photographs_of(trials: Sequence[BeamTrial]) -> list[TracedPhotograph]:
    """All traced photographs. InputError where an outline has too few points away from the clamps."""
    found: list[TracedPhotograph] = []
    first = 0
    for i, t in enumerate(trials):
        for c in t.captures:
            if c.outline is None:
                continue
            traced = away_from_clamps(c.outline, t)
            corners = _corners(traced, t)
            basis = np.linalg.qr(np.column_stack([smooth_basis(traced), corners]))[0]
            half = basis.T @ contour_root(traced)
            rows = slice(first, first + basis.shape[1])
            found.append(
                TracedPhotograph(
                    trial=t,
                    beam=i,
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
    """What dies away from each clamp along each edge, of height 1 there, (k, c)."""
    section = trial.section
    half = section.radius if isinstance(section, Circle) else section.height / 2.0
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
    """Points (k, 2) of the scene as the camera shows them."""
    for image in images:
        line = image(line)
    return line


def feet_of(photograph: TracedPhotograph, result: Result, images: Sequence[Image] = ()) -> list[Feet]:
    """Feet of its points on the upper and on the lower edge of a simulated beam, as the camera shows them."""
    upper, lower = (shown(line, images) for line in edges(result))
    return [feet(photograph.outline.upper, upper), feet(photograph.outline.lower, lower)]


def distances(both: Sequence[Feet]) -> Array:
    """Signed distances [m] of upper and lower points."""
    return np.concatenate([f.distance for f in both])


def coefficients(photograph: TracedPhotograph, result: Result, images: Sequence[Image] = ()) -> Array:
    """Smooth part of its distances from a simulated beam, by the basis [m], (m,)."""
    return np.asarray(photograph.basis.T @ distances(feet_of(photograph, result, images)))
