"""Noise in layers, from repeats: from point to point, from one test to the next, from specimen to specimen.

Repeats are not exchangeable: a specimen that stiffens or recovers from test to test differs by the order of
the tests. That trend is taken out first, and told; what is left is the scatter of repeats.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._basis import legendre

Array = NDArray[np.float64]

REPEATS = 4  # of one test: a trend in their order takes two
GRID = 24  # places along the records, where they are compared
BEND = 4  # highest degree of a record's own deviation
_NORMAL = 1.4826  # standard deviations in a median absolute deviation


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """One record's misfit along what drives it, over its full scale.

    Attributes
    ----------
    name, material, specimen : of the record.
    test : what repeats have in common; None of a record that is no repeat of another.
    x, misfit : shape (k,), in the order of the record.
    scale : full scale [SI].
    """

    name: str
    material: str
    specimen: str
    test: Hashable | None
    x: Array
    misfit: Array
    scale: float


@dataclass(frozen=True, kw_only=True)
class Layers:
    """Standard deviations as parts of full scale; None where there is nothing to see them by.

    Attributes
    ----------
    repeat : of one test from the next of the same specimen, the trend of their order taken out.
    order : what the order of tests makes from the first to the last, rms along the record; with its sign, of
        the misfit's mean.
    specimen : of one specimen's mean from the next of its material.
    repeats : names of the tests that show them.
    dof : degrees of freedom of `repeat`.
    """

    repeat: float | None = None
    order: float | None = None
    specimen: float | None = None
    repeats: tuple[str, ...] = ()
    dof: float = 0.0

    def to_json(self) -> dict[str, float]:
        found = {"repeat": self.repeat, "order": self.order, "specimen": self.specimen}
        return {name: value for name, value in found.items() if value is not None}

    def sentences(self) -> list[str]:
        if self.repeat is None:
            return []
        text = (
            f"{len(self.repeats)} repeats differ by {100.0 * self.repeat:.2g} % of full scale from one to the"
            " next, which counts as noise"
        )
        if self.order is not None:
            text += (
                f"; the order of the tests, taken out first, makes {100.0 * self.order:+.2g} % from the first"
                " to the last"
            )
        if self.specimen is not None:
            text += f"; specimens of a material differ by {100.0 * self.specimen:.2g} %"
        return [text]


def layers_of(curves: Sequence[Curve]) -> Layers:
    """From groups of at least REPEATS records of one test."""
    groups: dict[Hashable, list[Curve]] = {}
    for c in curves:
        if c.test is not None:
            groups.setdefault((c.material, c.specimen, c.test), []).append(c)
    squares, orders, dofs, names = [], [], 0.0, []
    means: dict[Hashable, list[Array]] = {}
    for (material, _, test), group in ((k, g) for k, g in groups.items() if isinstance(k, tuple)):
        values = _together(group)
        if values is None:
            continue
        means.setdefault((material, test), []).append(values.mean(axis=0))
        if len(group) < REPEATS:
            continue
        number = np.arange(len(group)) - 0.5 * (len(group) - 1)
        trend = number @ values / (number @ number)
        left = values - values.mean(axis=0) - number[:, None] * trend
        free = sqrt(len(group) / (len(group) - 2.0))
        squares.append((free * _NORMAL * np.median(np.abs(left))) ** 2)
        whole = trend * (len(group) - 1)
        orders.append(float(np.sign(whole.mean()) * np.sqrt(np.mean(whole**2))))
        dofs += len(group) - 2.0
        names += [c.name for c in group]
    apart = [np.var(np.array(m), axis=0, ddof=1).mean() for m in means.values() if len(m) > 1]
    return Layers(
        repeat=float(np.sqrt(np.mean(squares))) if squares else None,
        order=float(np.mean(orders)) if orders else None,
        specimen=float(np.sqrt(np.mean(apart))) if apart else None,
        repeats=tuple(names),
        dof=dofs,
    )


def _together(group: Sequence[Curve]) -> Array | None:
    """Misfits (records, GRID) over full scale where all were measured; None where they have nothing in
    common."""
    low = max(float(c.x.min()) for c in group)
    high = min(float(c.x.max()) for c in group)
    if not high > low:
        return None
    grid = np.linspace(low, high, GRID)
    found = []
    for c in group:
        order = np.argsort(c.x, kind="stable")
        found.append(np.interp(grid, c.x[order], c.misfit[order]) / c.scale)
    return np.array(found)


def deviations(curves: Sequence[Curve], repeat: float) -> list[list[Array]]:
    """One standard deviation of each bend of each record's own deviation [SI], whose mean square along the
    record is that of `repeat`."""
    part = repeat / sqrt(BEND + 1.0)
    return [
        [c.scale * part * sqrt(2.0 * d + 1.0) * legendre(c.x, d) for d in range(BEND + 1)] for c in curves
    ]
