"""Reconstruction of the axis from perspective silhouettes, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import tisim
from calibration.photo import Camera, View
from calibration.photo._silhouette import unproject


def make_view(eye: np.ndarray) -> View:
    """A camera at `eye` (x, y, z) [m] that looks along y."""
    camera = Camera(focal=4000.0, focal_sd=0.0, centre=(1000.0, 700.0), k1=-0.2, k2=0.05, noise=0.1, views=1)
    centre = np.array([eye[0], -eye[2], eye[1]])  # OpenCV's board frame: x, down, away
    return View(camera=camera, rotation=np.eye(3), shift=-centre)


@pytest.mark.parametrize("height", [0.0, 0.08, -0.15])
@pytest.mark.parametrize("side", [1, -1])
def test_straight_cylinder(height: float, side: int) -> None:
    """A tangent from the camera to a circle meets the centre plane at s: D^2 s^2 = R^2 ((s - a)^2 + D^2)."""
    radius, distance, plane = 0.010, 0.4, -0.012
    a, d2 = height, distance**2
    root = radius * distance * np.sqrt(a**2 + d2 - radius**2)
    s = (-a * radius**2 + side * root) / (d2 - radius**2)
    x = np.linspace(0.0, 0.09, 400)
    view = make_view(np.array([0.05, plane - distance, height]))
    pixels = view.project(np.column_stack([x, np.full(400, plane), np.full(400, s)]))
    edge = unproject(view, pixels, tisim.Circle(radius=radius), plane=plane, side=side, window=0.004)
    assert edge.axis[:, 1] == pytest.approx(np.zeros(400), abs=1e-8)
    assert edge.outline[:, 1] == pytest.approx(np.full(400, side * radius), abs=1e-8)
    assert abs(s) > radius * 1.0003  # the error without correction


def test_ring() -> None:
    """A curved axis: the points where rays touch a torus, from a closed form over its angles."""
    ring, radius, plane = 0.060, 0.010, -0.010
    view = make_view(np.array([0.10, plane - 0.35, 0.15]))
    phi = np.linspace(0.4, 1.6, 1200)
    eye = view.eye
    out = np.column_stack([np.cos(phi), np.zeros_like(phi), np.sin(phi)])
    y = np.array([0.0, 1.0, 0.0])
    axis = ring * out + plane * y
    # N = cos(t) out + sin(t) y with N . (axis - eye) + R = 0; the branch away from the ring's centre
    p, q = ((axis - eye) * out).sum(axis=1), (axis - eye) @ y
    size, lead = np.hypot(p, q), np.arctan2(q, p)
    for sign in (1, -1):
        t = lead + sign * np.arccos(-radius / size)
        if np.cos(t).mean() > 0:
            break
    touch = axis + radius * (np.cos(t)[:, None] * out + np.sin(t)[:, None] * y)
    pixels = view.project(touch[::-1])
    edge = unproject(view, pixels, tisim.Circle(radius=radius), plane=plane, side=1, window=0.003)
    inner = slice(60, -60)
    assert np.hypot(*edge.axis[inner].T) == pytest.approx(ring, abs=2e-6)
    assert np.hypot(*edge.outline[inner].T) == pytest.approx(ring + radius, abs=2e-6)


@pytest.mark.parametrize("height", [0.0, 0.06, -0.1])
@pytest.mark.parametrize("side", [1, -1])
def test_rectangle_shows_the_edge_that_sticks_out(height: float, side: int) -> None:
    section, plane = tisim.Rectangle(width=0.03, height=0.02), -0.015
    view = make_view(np.array([0.05, plane - 0.4, height]))
    x = np.linspace(0.0, 0.09, 300)
    corners = []
    for y in (-0.015, 0.015):
        corners.append(view.project(np.column_stack([x, np.full(300, plane + y), np.full(300, side * 0.01)])))
    seen = min(corners, key=lambda c: side * c[:, 1].mean())  # rows count downwards
    edge = unproject(view, seen, section, plane=plane, side=side, window=0.004)
    assert edge.outline[:, 1] == pytest.approx(np.full(300, side * 0.01), abs=1e-8)
