"""Traced photographs of beams, and where their points lie against a simulated beam."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import BeamTrial, TracedOutline
from calibration.outlines import Feet, away_from_clamps, contour_root, edges, feet, smooth_basis
from tisim import Circle, Result

Array = NDArray[np.float64]
Image = Callable[[Array], Array]


# Points nearer to a clamp than this part of the half height are left out. Up to some halves of it a squeezed
# section shows, and the corner's singularity: what dies away over these lengths, in half heights, is kept
# beside the polynomials, which could not follow it.
CORNER = 0.08
DECAYS = (0.5, 0.2)


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """One traced photograph of a trial (by index), `time` [s] after its release.

    basis (k, m): orthonormal, of what is smooth along each edge, and of what dies away from each clamp.
    corners (m, c): the latter, of height 1 at the clamp, in coefficients. covariance (m, m): of the contour's
    error in these coefficients [m^2]. rows: where its coefficients stand among those of all photographs.
    """

    trial: int
    time: float
    outline: TracedOutline
    basis: Array
    corners: Array
    covariance: Array
    rows: slice


def pictures_of(trials: Sequence[BeamTrial]) -> list[Picture]:
    """All traced photographs. InputError where an outline has too few points away from the clamps."""
    found: list[Picture] = []
    first = 0
    for i, t in enumerate(trials):
        for c in t.captures:
            if c.outline is None:
                continue
            traced = away_from_clamps(c.outline, t, zone=CORNER)
            corners = _corners(traced, t)
            basis = np.linalg.qr(np.column_stack([smooth_basis(traced), corners]))[0]
            half = basis.T @ contour_root(traced)
            rows = slice(first, first + basis.shape[1])
            found.append(
                Picture(
                    trial=i,
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


def feet_of(picture: Picture, result: Result, images: Sequence[Image] = ()) -> list[Feet]:
    """Feet of its points on the upper and on the lower edge of a simulated beam, as the camera shows them."""
    upper, lower = edges(result)
    for image in images:
        upper, lower = image(upper), image(lower)
    return [feet(picture.outline.upper, upper), feet(picture.outline.lower, lower)]


def distances(both: Sequence[Feet]) -> Array:
    """Signed distances [m] of upper and lower points."""
    return np.concatenate([f.distance for f in both])


def coefficients(picture: Picture, result: Result, images: Sequence[Image] = ()) -> Array:
    """Smooth part of its distances from a simulated beam, by the basis [m], (m,)."""
    return np.asarray(picture.basis.T @ distances(feet_of(picture, result, images)))
