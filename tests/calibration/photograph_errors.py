"""Errors of photographed outlines: of the contour, and a shift, a roll and a scale of each photograph."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SD, LENGTH = 0.1, 5.0  # standard deviation and correlation length of the contour's error [mm]


def photographed(
    edges: Sequence[Array],
    rng: np.random.Generator,
    noise: float,
    contour: Callable[[Array, float, np.random.Generator], Array],
) -> tuple[Array, Array]:
    """Upper and lower edge [mm] as a photograph shows them, (k, 2) each.

    Parameters
    ----------
    edges : upper and lower edge [mm], (k, 2) each.
    rng : generator of the errors.
    noise : factor on all errors.
    contour : function that draws the error across an edge [mm], shape (k,), from the correlations of its
        points (k, k), their standard deviation [mm] and `rng`.
    """
    shift = SD * noise * rng.standard_normal(2)
    roll = np.radians(0.15) * noise * rng.standard_normal()
    scale = 1.0 + 0.003 * noise * rng.standard_normal()
    turn = np.array([[np.cos(roll), -np.sin(roll)], [np.sin(roll), np.cos(roll)]])
    found = []
    for edge in edges:
        step = np.gradient(edge, axis=0)
        along = step / np.linalg.norm(step, axis=1)[:, None]
        s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
        correlations = np.exp(-((s[:, None] - s[None]) ** 2) / (2.0 * LENGTH**2))
        error = contour(correlations, SD * noise, rng)
        traced = edge + error[:, None] * np.column_stack([-along[:, 1], along[:, 0]])
        found.append(scale * traced @ turn.T + shift)
    return found[0], found[1]
