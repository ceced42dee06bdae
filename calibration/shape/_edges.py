"""Fit of a mid line and a half height to the two edges of a beam."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from calibration._numerics import arc_length, gaussian_correlation
from calibration.errors import InputError

Array = NDArray[np.float64]

# Spline intervals, in section heights: short enough for the bend at a clamp, long enough to average the
# tracing error. On exact edges 0.5 to 1.0 give one line to 0.04 mm, from 5 mm off the clamps on.
_ANGLE_INTERVAL, _HEIGHT_INTERVAL = 0.7, 1.5
_GRID = 200e-6  # [m], on which the line is integrated
_STEP = 1e-6  # of the numerical derivatives, in units of order 1


@dataclass(frozen=True, eq=False)
class EdgeFit:
    """A fitted line; covariance of its parameters from the tracing error."""

    model: _Model
    parameters: Array
    covariance: Array
    length: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", self.model.end(self.parameters))

    def at(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Points (k, 2), angle (k,), half height (k,), sd along the normal (k,) at arc lengths s (k,)."""
        points, angle = self.model.line(self.parameters, s)
        normal = np.column_stack([-np.sin(angle), np.cos(angle)])
        rows = np.empty((len(s), len(self.parameters)))
        for j in range(len(self.parameters)):
            p = self.parameters.copy()
            p[j] += _STEP
            rows[:, j] = ((self.model.line(p, s)[0] - points) * normal).sum(axis=1) / _STEP
        variance = np.einsum("ij,jk,ik->i", rows, self.covariance, rows)
        return points, angle, self.model.half_height(self.parameters, s), np.sqrt(np.maximum(variance, 0.0))


def fit_between(
    upper: Array, lower: Array, *, height: float, far_face: float | None, sd: float, correlation: float
) -> EdgeFit:
    """The mid line of two edges (k, 2) [m]; far_face: x of the second clamp's face [m], if there is one."""
    middle = _rough_middle(upper, lower)
    reach = float(arc_length(middle)[-1])
    if far_face is not None:
        reach += max(far_face - middle[-1, 0], 0.0)
    model = _Model(upper=upper, lower=lower, height=height, reach=reach, far_face=far_face)
    p = _gauss_newton(model, model.first_guess(middle))
    _, jacobian = _derivative(model, p)
    inverse = np.linalg.pinv(jacobian)
    noise = np.zeros((len(jacobian), len(jacobian)))
    k = len(upper)
    noise[:k, :k] = _noise(upper, sd, correlation)
    noise[k:, k:] = _noise(lower, sd, correlation)
    # residuals are in units of the height
    return EdgeFit(model, p, inverse @ (noise / height**2) @ inverse.T)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Model:
    """Parameters: z of the line at x = 0 and half height in units of `height`; angle in rad."""

    upper: Array
    lower: Array
    height: float
    reach: float
    far_face: float | None
    angle_knots: Array = field(init=False)
    height_knots: Array = field(init=False)
    grid: Array = field(init=False)
    _angle_basis: Array = field(init=False)

    def __post_init__(self) -> None:
        grid = np.arange(0.0, self.reach + self.height, _GRID)
        set_ = object.__setattr__
        set_(self, "angle_knots", _knots(self.reach, self.height * _ANGLE_INTERVAL, degree=3, least=4))
        set_(self, "height_knots", _knots(self.reach, self.height * _HEIGHT_INTERVAL, degree=2, least=1))
        set_(self, "grid", grid)
        set_(self, "_angle_basis", _basis(self.angle_knots, grid, degree=3, reach=self.reach))

    @property
    def n_angle(self) -> int:
        return len(self.angle_knots) - 4

    @property
    def n_parameters(self) -> int:
        return 1 + self.n_angle + len(self.height_knots) - 3

    def first_guess(self, middle: Array) -> Array:
        p = np.empty(self.n_parameters)
        s = arc_length(middle)
        slope = np.unwrap(np.arctan2(*np.diff(middle, axis=0).T[::-1]))
        at = np.minimum((s[1:] + s[:-1]) / 2, self.reach)
        basis = _basis(self.angle_knots, at, degree=3, reach=self.reach)
        p[0] = middle[0, 1] / self.height
        p[1 : 1 + self.n_angle] = np.linalg.lstsq(basis, slope, rcond=None)[0]
        p[1 + self.n_angle :] = 0.5
        return p

    def curve(self, p: Array) -> tuple[Array, Array]:
        """Points and angles on the grid: the line starts at x = 0 and has unit speed."""
        angle = self._angle_basis @ p[1 : 1 + self.n_angle]
        tangent = np.column_stack([np.cos(angle), np.sin(angle)])
        step = (tangent[1:] + tangent[:-1]) * (_GRID / 2)
        points = np.concatenate([[[0.0, 0.0]], np.cumsum(step, axis=0)])
        points[:, 1] += p[0] * self.height
        return points, angle

    def line(self, p: Array, s: Array) -> tuple[Array, Array]:
        points, angle = self.curve(p)
        return _at(self.grid, points, s), np.interp(s, self.grid, angle)

    def half_height(self, p: Array, s: Array) -> Array:
        basis = _basis(self.height_knots, s, degree=2, reach=self.reach)
        return np.asarray(self.height * (basis @ p[1 + self.n_angle :]))

    def end(self, p: Array) -> float:
        """Arc length of the far clamp's face, or of the middle of the free end face."""
        points, angle = self.curve(p)
        if self.far_face is None:
            feet = [self._feet(points, angle, edge[-1:])[0][0] for edge in (self.upper, self.lower)]
            return float(np.mean(feet))
        return self._face(points, self.far_face)

    def _face(self, points: Array, x: float) -> float:
        beyond = np.flatnonzero(points[:, 0] >= x)
        if not len(beyond):
            raise InputError("outline: its mid line does not reach the far clamp's face")
        j = max(int(beyond[0]), 1)
        x0, x1 = points[j - 1 : j + 1, 0]
        return float(self.grid[j - 1] + _GRID * (x - x0) / (x1 - x0))

    def _feet(self, points: Array, angle: Array, edge: Array) -> tuple[Array, Array, Array]:
        """Arc length (k,) of the sections that hold the edge's points, their normals' angle, line's angle."""
        end = None if self.far_face is None else self._face(points, self.far_face)
        turn = section_angle(self.grid, angle, height=self.height, start=0.0, end=end)
        rate = np.gradient(turn, _GRID)
        s = self.grid[np.linalg.norm(edge[:, None] - points[None, ::5], axis=2).argmin(axis=1) * 5]
        for _ in range(50):
            phi, theta = np.interp(s, self.grid, turn), np.interp(s, self.grid, angle)
            off = edge - _at(self.grid, points, s)
            along = off[:, 0] * np.cos(phi) + off[:, 1] * np.sin(phi)
            across = -off[:, 0] * np.sin(phi) + off[:, 1] * np.cos(phi)
            move = along / np.maximum(np.cos(theta - phi) - across * np.interp(s, self.grid, rate), 0.2)
            s = np.clip(s + move, -0.02 * self.height, self.grid[-1])
            if np.abs(move).max() < 1e-11:
                break
        return s, phi, theta

    def residual(self, p: Array) -> Array:
        """Distance of each point from the edge of the section it lies in, in units of the height."""
        points, angle = self.curve(p)
        parts = []
        for edge, side in ((self.upper, 1.0), (self.lower, -1.0)):
            s, phi, theta = self._feet(points, angle, edge)
            off = edge - _at(self.grid, points, s)
            across = -off[:, 0] * np.sin(phi) + off[:, 1] * np.cos(phi)
            # the edge runs along the line, not along the section: its normal distance
            parts.append(across * np.cos(theta - phi) - side * self.half_height(p, s))
        return np.concatenate(parts) / self.height


def _gauss_newton(model: _Model, p: Array) -> Array:
    """Least squares; an InputError where it does not settle."""
    residual, jacobian = _derivative(model, p)
    for _ in range(40):
        step = np.linalg.lstsq(jacobian, -residual, rcond=None)[0]
        cost, share = residual @ residual, 1.0
        while True:
            trial = model.residual(p + share * step)
            if trial @ trial <= cost * (1 + 1e-12) or share < 1e-3:
                break
            share /= 2
        p = p + share * step
        if np.abs(share * step).max() < 1e-6:
            return p
        residual, jacobian = _derivative(model, p)
    raise InputError("outline: no smooth mid line between its edges was found; are upper and lower mixed up?")


def _derivative(model: _Model, p: Array) -> tuple[Array, Array]:
    residual = model.residual(p)
    jacobian = np.empty((len(residual), len(p)))
    for j in range(len(p)):
        moved = p.copy()
        moved[j] += _STEP
        jacobian[:, j] = (model.residual(moved) - residual) / _STEP
    return residual, jacobian


def _rough_middle(upper: Array, lower: Array, count: int = 60) -> Array:
    """Middle of points at equal parts of the two edges' lengths, (count, 2)."""
    share = np.linspace(0.0, 1.0, count)
    sides = []
    for edge in (upper, lower):
        s = arc_length(edge)
        sides.append(_at(s / s[-1], edge, share))
    return np.asarray((sides[0] + sides[1]) / 2)


def _at(s: Array, points: Array, where: Array) -> Array:
    """Points on a polyline, straight on before its first point (within a clamp the beam is straight)."""
    before = np.minimum(where - s[0], 0.0)[:, None] * (points[1] - points[0]) / (s[1] - s[0])
    return np.column_stack([np.interp(where, s, c) for c in points.T]) + before


def _knots(reach: float, interval: float, *, degree: int, least: int) -> Array:
    inner = np.linspace(0.0, reach, max(round(reach / interval), least) + 1)
    return np.concatenate([[0.0] * degree, inner, [reach] * degree])


def _basis(knots: Array, s: Array, *, degree: int, reach: float) -> Array:
    """B-splines at s, constant beyond the range they are fitted on."""
    return np.asarray(BSpline.design_matrix(np.clip(s, 0.0, reach), knots, degree).toarray())


def _noise(edge: Array, sd: float, correlation: float) -> Array:
    """Covariance [m2] of the tracing error along one edge: Gaussian correlation over its length."""
    return sd**2 * gaussian_correlation(arc_length(edge), correlation)


def section_angle(s: Array, angle: Array, *, height: float, start: float | None, end: float | None) -> Array:
    """Angle [rad] of the sections' normals along a mid line of tangent `angle` (n,) at arc length s (n,) [m].

    start, end: arc length of the clamp faces, None where there is none. A section in a clamp face keeps that
    face's plane (x = constant, angle 0) and turns to stand across the mid line within one section height:
    the layer in which Saint-Venant's principle lets a clamp be felt.
    """
    share = np.ones_like(s)
    if start is not None:
        share = share * _smooth_step((s - start) / height)
    if end is not None:
        share = share * _smooth_step((end - s) / height)
    return np.asarray(angle * share)


def _smooth_step(x: Array) -> Array:
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))
