"""Labels of frames and the curve below a view: load parameter, time and force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tisim.view._view import Curve

Quantity = tuple[str, float, str]
"""Name, value and unit of a quantity."""

MOST_FRAMES = 120


def frames_shown(count: int) -> NDArray[np.intp]:
    """Indices of the frames of a view: all, or MOST_FRAMES evenly spaced ones with the first and the last."""
    return np.unique(np.round(np.linspace(0, count - 1, min(count, MOST_FRAMES))).astype(np.intp))


def thinned(count: int) -> tuple[str, ...]:
    """A note if not all frames are shown, else empty."""
    return (f"{MOST_FRAMES} of {count} frames are shown.",) if count > MOST_FRAMES else ()


def label(quantities: Sequence[Quantity]) -> str:
    """One line with the names, values and units of quantities."""
    return " · ".join(f"{name} {value:.4g} {unit}".rstrip() for name, value, unit in quantities)


def curve(along: Sequence[Quantity], forces: Sequence[Quantity]) -> Curve:
    """Curve of the force over the load parameter, with one of each per frame."""
    return Curve(
        x=np.array([value for _, value, _ in along]),
        x_name=along[0][0],
        x_unit=along[0][2],
        y=np.array([value for _, value, _ in forces]),
        y_name=forces[0][0],
        y_unit=forces[0][2],
    )
