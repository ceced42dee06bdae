"""Frequency, damping ratio and creep of a ring-down (free vibration), without a simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class RingDown:
    """Fit of one decaying oscillation.

    Attributes
    ----------
    frequency : frequency of the damped oscillation [Hz].
    damping_ratio : fraction of critical damping.
    centre : mean position 1 s after the release, in the signal's unit.
    creep : motion of the centre per decade of time, in the signal's unit.
    left : root mean square of the residuals, in the signal's unit.
    """

    frequency: float
    damping_ratio: float
    centre: float
    creep: float
    left: float


def ringdown(time: ArrayLike, signal: ArrayLike, *, first: float = 0.15, last: float = 2.0) -> RingDown:
    """Least squares of centre + creep log10(t) + exp(-c t)(a cos w t + b sin w t) on first <= t <= last.

    Parameters
    ----------
    time : time since the release [s], shape (t,).
    signal : shape (t,).
    first, last : range of time [s].

    Raises
    ------
    ValueError
        If fewer than ten samples are in the range, or the signal does not oscillate.
    """
    t, y = np.asarray(time, dtype=float), np.asarray(signal, dtype=float)
    inside = (t >= first) & (t <= last)
    t, y = t[inside], y[inside]
    if len(t) < 10:
        raise ValueError(f"ring-down: expected ten samples between {first:g} and {last:g} s, got {len(t)}")

    def basis(c: float, w: float) -> Array:
        envelope = np.exp(-c * (t - t[0]))
        return np.column_stack(
            [np.ones_like(t), np.log10(t), envelope * np.cos(w * t), envelope * np.sin(w * t)]
        )

    def left(p: Array) -> Array:
        B = basis(float(p[0]), float(p[1]))
        return np.asarray(y - B @ np.linalg.lstsq(B, y, rcond=None)[0])

    # scan over frequencies, fine enough for the search to start at the right peak
    tries = np.linspace(2.0 * np.pi / (t[-1] - t[0]), np.pi / float(np.diff(t).max()), 400)
    costs = [float(np.square(left(np.array([1.0 / (t[-1] - t[0]), w]))).sum()) for w in tries]
    start = np.array([2.0 / (t[-1] - t[0]), tries[int(np.argmin(costs))]])
    found = least_squares(left, start, x_scale=np.abs(start), xtol=1e-12, ftol=1e-12)
    c, w = (float(v) for v in found.x)
    amount = np.linalg.lstsq(basis(c, w), y, rcond=None)[0]
    if not np.hypot(amount[2], amount[3]) > 0.0:
        raise ValueError("ring-down: expected a signal that swings")
    return RingDown(
        frequency=w / (2.0 * np.pi),
        damping_ratio=c / float(np.hypot(c, w)),
        centre=float(amount[0]),
        creep=float(amount[1]),
        left=float(np.sqrt(np.mean(np.square(found.fun)))),
    )
