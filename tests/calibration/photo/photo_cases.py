"""Beams of known shape: planar axes in mm and their exact outlines."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.spatial import cKDTree

from calibration.experiment import TracedOutline

Array = NDArray[np.float64]
RADIUS = 10.0
SMOOTH = 9  # polynomial degree along an edge for the comparison of fits
# ranges for true errors relative to the stated ones: mean chi-square per mode, and largest mode [sd]; 44
# photographs of 1600 pixels gave 0.01 to 0.35 and 0.2 to 1.5
BAND, LARGEST = (0.003, 1.0), (0.1, 2.5)


def hanging(length: float = 100.0, turn_deg: float = 28.0) -> Array:
    """Axis (k, 2) [mm] of a cantilever whose tangent turns down by `turn_deg`."""
    s = np.linspace(0.0, length, 4001)
    angle = -np.radians(turn_deg) * (1.0 - (1.0 - s / length) ** 3)
    return _integrate(s, angle)


def bridge(length: float = 100.0, sag: float = 5.0) -> Array:
    """Axis (k, 2) [mm] of a beam clamped at both ends with `sag` at mid-span."""
    x = np.linspace(0.0, length, 4001)
    return np.column_stack([x, -sag * (16.0 * (x / length) ** 2 * (1.0 - x / length) ** 2)])


def edge(axis: Array, side: int, radius: float = RADIUS) -> Array:
    """Exact outline (k, 2); `side` is +1 for the upper and -1 for the lower edge."""
    tangent = np.gradient(axis, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return axis + side * radius * np.column_stack([-tangent[:, 1], tangent[:, 0]])


def normal_error(points: Array, truth: Array) -> Array:
    """Signed normal distance of each point from a densely sampled curve."""
    _, nearest = cKDTree(truth).query(points)
    nearest = np.clip(nearest, 1, len(truth) - 2)
    tangent = truth[nearest + 1] - truth[nearest - 1]
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    offset = points - truth[nearest]
    return tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]


def chi_squares(outline: TracedOutline, error: np.ndarray, degree: int) -> tuple[float, float]:
    """Mean chi-square per mode of an error, and its largest mode in standard deviations.

    Modes are polynomials along the edges up to `degree`; variances follow from the stated error and
    registration.
    """
    covariance, basis, normals, points = [], [], [], []
    for line in (outline.upper, outline.lower):
        s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        kernel = np.exp(-0.5 * ((s[:, None] - s) / outline.correlation) ** 2)
        covariance.append(outline.sd**2 * kernel)
        basis.append(np.linalg.qr(np.polynomial.legendre.legvander(2 * s / s[-1] - 1, degree))[0])
        tangent = np.gradient(line, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        normals.append(np.column_stack([-tangent[:, 1], tangent[:, 0]]))
        points.append(line)
    n, q, stated = np.concatenate(normals), np.concatenate(points), outline.registration.plus(outline.shared)
    columns = np.column_stack(
        [
            stated.shift * n,
            stated.roll * (n[:, 1] * q[:, 0] - n[:, 0] * q[:, 1]),
            stated.scale * (n * q).sum(axis=1),
        ]
    )
    modes = block_diag(*basis)
    whole = modes.T @ (block_diag(*covariance) + columns @ columns.T) @ modes
    value, direction = np.linalg.eigh(whole)
    z = (direction.T @ (modes.T @ error)) / np.sqrt(value)
    return float(np.mean(z**2)), float(np.abs(z).max())


def true_error(outline: TracedOutline, axis: np.ndarray) -> np.ndarray:
    """Signed distance of the traced points from the true outline [m], upper edge first."""
    sides = ((1, outline.upper), (-1, outline.lower))
    return 1e-3 * np.concatenate([normal_error(line * 1e3, edge(axis, side)) for side, line in sides])


def _integrate(s: Array, angle: Array) -> Array:
    step = np.diff(s)[:, None]
    middle = 0.5 * (angle[1:] + angle[:-1])
    move = step * np.column_stack([np.cos(middle), np.sin(middle)])
    return np.vstack([[0.0, 0.0], np.cumsum(move, axis=0)])


def true_body(axis: Array, radius: float = RADIUS, sides: int = 64, stations: int = 100) -> trimesh.Trimesh:
    """Tube about an axis as a closed mesh [m]; its polygonal section has the area of the circle."""
    points = axis[:: max(1, len(axis) // stations)] if (len(axis) - 1) % stations == 0 else axis
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    turn = 2 * np.pi * np.arange(sides) / sides
    full = radius * np.sqrt(2 * np.pi / (sides * np.sin(2 * np.pi / sides)))
    up, out = full * np.cos(turn), full * np.sin(turn)
    x = points[:, :1] - tangent[:, 1:] * up
    z = points[:, 1:] + tangent[:, :1] * up
    y = np.broadcast_to(out, x.shape)
    vertices = np.concatenate(
        [np.stack([x, y, z], -1).reshape(-1, 3), np.insert(points[[0, -1]], 1, 0.0, axis=1)]
    )
    faces = []
    k, n = len(points), sides
    for i in range(k - 1):
        a = i * n + np.arange(n)
        b = i * n + (np.arange(n) + 1) % n
        faces += [np.stack([a, a + n, b], -1), np.stack([b, a + n, b + n], -1)]
    around, on = np.arange(n), (np.arange(n) + 1) % n
    faces.append(np.stack([np.full(n, k * n), around, on], -1))
    faces.append(np.stack([np.full(n, k * n + 1), (k - 1) * n + on, (k - 1) * n + around], -1))
    body = trimesh.Trimesh(vertices * 1e-3, np.concatenate(faces), process=False)
    if body.volume < 0:
        body.invert()
    return body
