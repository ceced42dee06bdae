"""Frequency, damping ratio and creep of a ring-down (free vibration), without a simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]

FINE = 6.0  # tried frequencies per 1 / duration
SURE = 10.0  # least F ratio of the oscillation over centre and creep alone


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
        If fewer than ten samples are in the range, or the signal does not oscillate at a frequency that the
        median interval between samples resolves.
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

    # scan over frequencies, fine enough for the search to start at the right peak; a film may go over into
    # single photographs, so that the longest interval says nothing
    long, low, high = (
        float(t[-1] - t[0]),
        2.0 * np.pi / float(t[-1] - t[0]),
        np.pi / float(np.median(np.diff(t))),
    )
    tries = np.linspace(low, high, max(400, int(FINE * long * (high - low) / (2.0 * np.pi))))
    starts = (1.0 / long, 10.0 / long)  # a fast decay hides its frequency from a slow one's scan
    _, c, w = min(
        (float(np.square(left(np.array([c, w]))).sum()), c, float(w)) for c in starts for w in tries
    )
    start = np.array([max(c, 2.0 / long), w])
    bounds = ([0.0, 0.5 * low], [np.inf, high])
    found = least_squares(left, start, x_scale=np.abs(start), xtol=1e-12, ftol=1e-12, bounds=bounds)
    c, w = (float(v) for v in found.x)
    amount = np.linalg.lstsq(basis(c, w), y, rcond=None)[0]
    smooth = np.column_stack([np.ones_like(t), np.log10(t)])
    without = float(np.square(y - smooth @ np.linalg.lstsq(smooth, y, rcond=None)[0]).sum())
    rest = float(np.square(found.fun).sum())
    at_an_end = min(w / (0.5 * low), high / w) < 1.01
    if at_an_end or (without - rest) * (len(t) - 6) <= SURE * 4.0 * rest:
        raise ValueError(
            f"ring-down: expected a signal that oscillates at {low / np.pi / 2:.2g} to"
            f" {high / np.pi / 2:.3g} Hz"
        )
    return RingDown(
        frequency=w / (2.0 * np.pi),
        damping_ratio=c / float(np.hypot(c, w)),
        centre=float(amount[0]),
        creep=float(amount[1]),
        left=float(np.sqrt(np.mean(np.square(found.fun)))),
    )
