"""The mid line of a beam: what the paper's CAD program draws between the two traced edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import arc_length
from calibration.errors import InputError
from calibration.experiment.model import Supports, TracedOutline
from calibration.shape._edges import fit_between

Array = NDArray[np.float64]

# The edges must cover the beam: what they leave out at its ends is only extrapolated.
_LEAST, _MOST = 0.8, 1.25
_MAX_GAP = 0.5  # of the section's height: from a clamp face to where the tracing starts


@dataclass(frozen=True, eq=False, kw_only=True)
class Centreline:
    """A mid line in the image plane, from the clamp face x = 0 to the end face or the far clamp's face.

    Attributes
    ----------
    s : array, shape (k,)
        Arc length from 0, increasing [m].
    points : array, shape (k, 2)
        x and z [m].
    angle : array, shape (k,)
        Slope angle of the tangent against x, positive upwards [rad].
    sd : array, shape (k,), optional
        Standard deviation along the line's normal [m], from the tracing error alone (the photograph's
        registration moves the line as a whole and is not in it).
    half_height : array, shape (k,), optional
        Half of the distance between the edges [m].
    supports : str
        As of the beam; its clamped faces are planes x = constant.
    """

    s: Array
    points: Array
    angle: Array
    sd: Array | None = None
    half_height: Array | None = None
    supports: Supports = "clamped-free"

    def __post_init__(self) -> None:
        k = len(self.s)
        shapes = {"s": (k,), "points": (k, 2), "angle": (k,), "sd": (k,), "half_height": (k,)}
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value is None and name in ("sd", "half_height"):
                continue
            value = np.ascontiguousarray(value, dtype=np.float64)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(
                    f"centreline {name}: expected finite numbers of shape {shape}, got {value.shape}"
                )
            object.__setattr__(self, name, value)
        if k < 2 or self.s[0] != 0.0 or (np.diff(self.s) <= 0).any():
            raise ValueError("centreline s: expected arc lengths that increase from 0")

    @property
    def length(self) -> float:
        """Arc length of the whole line [m]."""
        return float(self.s[-1])

    def at(self, s: Array) -> tuple[Array, Array]:
        """Points (n, 2) [m] and angles (n,) [rad] at arc lengths s (n,) [m] (cubic Hermite)."""
        from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

        tangent = np.column_stack([np.cos(self.angle), np.sin(self.angle)])
        line = CubicHermiteSpline(self.s, self.points, tangent)
        return np.asarray(line(s)), np.asarray(PchipInterpolator(self.s, self.angle)(s))


def centreline(
    outline: TracedOutline, *, supports: Supports, free_length: float, spacing: float = 0.5e-3
) -> Centreline:
    """The smooth line that lies half-way between the traced edges, from clamp face to end.

    outline: upper and lower edge, traced from near the clamp face at x = 0.
    supports, free_length [m]: as of the beam. The line is extrapolated over the untraced millimetres to x = 0
        and, where the far end is clamped, to x = free_length; a free end is cut where the edges end (the
        middle of the end face).
    spacing: of the points that come back [m].

    The line's angle is a cubic spline of arc length and the half height a quadratic one; both are fitted to
    all points of both edges at once by least squares, each point along the section it lies in (sections stand
    across the line, but turn into the clamp's face within one section height of it). `sd` propagates the
    outline's sd and correlation through that fit.
    Raises InputError where an edge is too short, has too few points, or covers the wrong length.
    """
    upper, lower = _checked(outline.upper, "upper"), _checked(outline.lower, "lower")
    if not free_length > 0:
        raise InputError(f"free length: expected a positive length, got {free_length:g} m")
    both = supports == "clamped-clamped"
    height = _height(upper, lower)
    _check_cover(upper, lower, height=height, free_length=free_length, both=both)
    fit = fit_between(
        upper,
        lower,
        height=height,
        far_face=free_length if both else None,
        sd=outline.sd,
        correlation=outline.correlation,
    )
    count = max(int(np.ceil(fit.length / spacing)), 2) + 1
    s = np.linspace(0.0, fit.length, count)
    points, angle, half, sd = fit.at(s)
    if (half <= 0).any():
        raise InputError("outline: its upper edge lies below its lower one somewhere; are they mixed up?")
    return Centreline(s=s, points=points, angle=angle, sd=sd, half_height=half, supports=supports)


def _checked(edge: Array, name: str) -> Array:
    edge = np.ascontiguousarray(edge, dtype=np.float64)
    if edge.ndim != 2 or edge.shape[1] != 2 or not np.isfinite(edge).all():
        raise InputError(
            f"outline, {name} edge: expected finite points x, z, got an array of shape {edge.shape}"
        )
    if len(edge) < 8:
        raise InputError(f"outline, {name} edge: expected at least 8 points, got {len(edge)}")
    if (np.linalg.norm(np.diff(edge, axis=0), axis=1) == 0).any():
        raise InputError(f"outline, {name} edge: expected points that move on, two in a row are the same")
    return edge


def _height(upper: Array, lower: Array) -> float:
    """Distance of the edges [m]: median over the upper one's points of the way to the nearest lower one."""
    gap = np.linalg.norm(upper[:, None] - lower[None], axis=2).min(axis=1)
    return float(np.median(gap))


def _check_cover(upper: Array, lower: Array, *, height: float, free_length: float, both: bool) -> None:
    for name, edge in (("upper", upper), ("lower", lower)):
        if abs(edge[0, 0]) > _MAX_GAP * height:
            raise InputError(
                f"outline, {name} edge: expected to start within {_MAX_GAP * height * 1e3:.1f} mm of the "
                f"clamp face at x = 0, starts at x = {edge[0, 0] * 1e3:.1f} mm"
            )
        if both and abs(edge[-1, 0] - free_length) > _MAX_GAP * height:
            raise InputError(
                f"outline, {name} edge: expected to end within {_MAX_GAP * height * 1e3:.1f} mm of the far "
                f"clamp face at x = {free_length * 1e3:.1f} mm, ends at x = {edge[-1, 0] * 1e3:.1f} mm"
            )
    length = sum(float(arc_length(e)[-1]) for e in (upper, lower)) / 2
    if not _LEAST * free_length < length < _MOST * free_length:
        raise InputError(
            f"outline: expected edges about as long as the free length of {free_length * 1e3:.1f} mm, "
            f"they are {length * 1e3:.1f} mm long"
        )
