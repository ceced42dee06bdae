"""A closed body from a mid line and a section: the reference geometry that the paper made in CAD."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray

import tisim
from calibration.errors import InputError
from calibration.shape._sections import section_angle
from calibration.shape.centreline import Centreline

Array = NDArray[np.float64]


def sweep(
    centreline: Centreline,
    section: tisim.Circle | tisim.Rectangle,
    *,
    grip_length: float = 0.0,
    segments: int = 64,
    spacing: float = 1e-3,
    true_area: bool = True,
) -> trimesh.Trimesh:
    """Watertight body of the undeformed section swept along a mid line [m], y = 0 its plane, with end caps.

    Sections stand across the line and turn into the plane of a clamp's face within one section height of it,
    so that a clamped end is cut at x = constant; each is centred on the line, so the volume is area times
    length (Pappus).
    grip_length: straight pieces along x added behind each clamp face [m]; 0 for none, as in tisim's beams.
    segments: straight sides of a circle (rectangles take as many points, corners among them).
    spacing: longest step between sections along the line [m].
    true_area: the polygon of a circle has the circle's area (its corners lie outside the circle by 0.08 %
        of the radius at 64 sides); False inscribes it, as CAD export does, and loses 0.73 % of the area at
        30 sides.
    Raises InputError where the line bends so sharply that neighbouring sections would meet.
    """
    if segments < 3:
        raise ValueError(f"segments: expected at least 3, got {segments}")
    if not spacing > 0 or grip_length < 0:
        raise ValueError("sweep: expected a positive spacing and no negative grip length")
    ring = _section_ring(section, segments, true_area)
    both = centreline.supports == "clamped-clamped"
    height = float(np.ptp(ring[:, 1]))
    s = np.linspace(0.0, centreline.length, max(int(np.ceil(centreline.length / spacing)), 2) + 1)
    points, angle = centreline.at(s)
    turn = section_angle(s, angle, height=height, start=0.0, end=s[-1] if both else None)
    # the section that lies aslant to the line is longer, as a cylinder cut aslant is
    stretch = 1.0 / np.cos(angle - turn)
    _check_bend(s, points, turn, stretch, height)
    if grip_length > 0:
        points, turn, stretch = _with_grip(points, turn, stretch, step=-grip_length)
        if both:
            points, turn, stretch = (a[::-1] for a in (points, turn, stretch))
            points, turn, stretch = _with_grip(points, turn, stretch, step=grip_length)
            points, turn, stretch = (a[::-1] for a in (points, turn, stretch))
    return _skin(ring, points, turn, stretch)


def _section_ring(section: tisim.Circle | tisim.Rectangle, segments: int, true_area: bool) -> Array:
    """Polygon of the section, (n, 2) as y, z [m], counter-clockwise seen against +x."""
    if isinstance(section, tisim.Circle):
        radius = section.radius
        if true_area:
            radius *= np.sqrt(2 * np.pi / (segments * np.sin(2 * np.pi / segments)))
        phase = 2 * np.pi * np.arange(segments) / segments
        return np.asarray(radius * np.column_stack([np.cos(phase), np.sin(phase)]))
    y, z = section.width / 2, section.height / 2
    corners = np.array([[y, -z], [y, z], [-y, z], [-y, -z]])
    side = np.linspace(0.0, 1.0, max(segments // 4, 1), endpoint=False)[:, None]
    return np.concatenate([(1 - side) * corners[i] + side * corners[(i + 1) % 4] for i in range(4)])


def _check_bend(s: Array, points: Array, turn: Array, stretch: Array, height: float) -> None:
    """Neighbouring sections must not meet: their top and bottom ends move on along the line."""
    across = np.column_stack([-np.sin(turn), np.cos(turn)]) * (stretch * height / 2)[:, None]
    forward = np.column_stack([np.cos(turn), np.sin(turn)])
    for side in (1.0, -1.0):
        moved = (np.diff(points + side * across, axis=0) * (forward[1:] + forward[:-1])).sum(axis=1)
        if (moved <= 0).any():
            where = s[int(np.argmax(moved <= 0))]
            raise InputError(
                f"mid line: it bends too sharply at {where * 1e3:.1f} mm for a section "
                f"{height * 1e3:.1f} mm high"
            )


def _with_grip(points: Array, turn: Array, stretch: Array, *, step: float) -> tuple[Array, Array, Array]:
    """A straight piece before the first section: the undeformed section between x + step and the face."""
    first = points[0]
    extra = [first + np.array([step, 0.0])]
    if abs(stretch[0] - 1.0) > 1e-6:  # the free part's section in the clamp face is the larger one
        extra.append(first)
    n = len(extra)
    return (
        np.concatenate([extra, points]),
        np.concatenate([np.zeros(n), turn]),
        np.concatenate([np.ones(n), stretch]),
    )


def _skin(ring: Array, points: Array, turn: Array, stretch: Array) -> trimesh.Trimesh:
    k, n = len(points), len(ring)
    across = np.column_stack([-np.sin(turn), np.zeros(k), np.cos(turn)]) * stretch[:, None]
    centres = np.column_stack([points[:, 0], np.zeros(k), points[:, 1]])
    rings = centres[:, None] + ring[None, :, 1:] * across[:, None]
    rings[:, :, 1] += ring[:, 0]
    a = (np.arange(k - 1)[:, None] * n + np.arange(n)).ravel()
    b = (np.arange(k - 1)[:, None] * n + np.roll(np.arange(n), -1)).ravel()
    sides = np.concatenate([np.column_stack([a, b, b + n]), np.column_stack([a, b + n, a + n])])
    around = np.arange(n)
    caps = np.concatenate(
        [
            np.column_stack([np.full(n, k * n), np.roll(around, -1), around]),
            np.column_stack([np.full(n, k * n + 1), (k - 1) * n + around, (k - 1) * n + np.roll(around, -1)]),
        ]
    )
    vertices = np.concatenate([rings.reshape(-1, 3), centres[[0, -1]]])
    body = trimesh.Trimesh(vertices, np.concatenate([sides, caps]), process=False)
    if not body.is_watertight or body.volume <= 0:
        raise InputError("mid line: the swept body does not close or is inside-out")
    return body
