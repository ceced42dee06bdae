"""One photograph's way as a strip of four pictures: board, rectified, contour, swept body over it."""

from __future__ import annotations

import cv2
import numpy as np
import trimesh
from numpy.typing import NDArray

from calibration.photo._image import BLUE, GREEN, ORANGE, RED, Grey, coloured, draw_line, draw_points
from calibration.photo._trace import Trace

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

_HEIGHT = 420  # pixels of one panel
_MARGIN = 0.012  # about specimen and board in the rectified panel [m]


def strip(image: Grey, trace: Trace, body: trimesh.Trimesh | None = None) -> Picture:
    """Four panels side by side (BGR); body: the swept mesh in the specimen's frame [m]."""
    board = draw_points(coloured(image), trace.board.corners.reshape(-1, 2), ORANGE)
    contour = coloured(image)
    for line, colour in ((trace.contour.upper, ORANGE), (trace.contour.lower, BLUE)):
        draw_line(contour, line, colour)
    if len(trace.contour.end):
        draw_line(contour, trace.contour.end, GREEN)
    if trace.face is not None:
        draw_points(contour, trace.face.pixels[::12], RED)
    overlay = _overlay(image, trace, body) if body is not None else contour
    titles = (
        f"board: corners to {trace.corner_noise:.2f} px",
        f"rectified: tilt {np.degrees(trace.tilt):.1f} deg",
        f"contour: sd {trace.outline.sd * 1e3:.3f} mm at {trace.metres_per_pixel * 1e3:.3f} mm/px",
        "swept body over the photograph",
    )
    panels = (board, _rectified(image, trace), contour, overlay)
    return np.hstack([_panel(p, t) for p, t in zip(panels, titles, strict=True)])


def _panel(picture: Picture, title: str) -> Picture:
    height, width = picture.shape[:2]
    size = (round(width * _HEIGHT / height), _HEIGHT)
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    head = np.full((34, size[0], 3), 255, np.uint8)
    scale = min(0.5, 0.5 * size[0] / (9.2 * len(title) + 10))
    cv2.putText(head, title, (6, 22), cv2.FONT_HERSHEY_SIMPLEX, scale, (40, 40, 40), 1, cv2.LINE_AA)
    panel = np.vstack([head, small]).astype(np.uint8)
    return np.asarray(np.pad(panel, ((0, 0), (0, 6), (0, 0)), constant_values=255))


def _rectified(image: Grey, trace: Trace) -> Picture:
    """The specimen's plane seen square on, with the specimen's axes and a 10 mm grid."""
    origin, board = np.array(trace.origin), trace.board
    outline = np.concatenate([trace.outline.upper, trace.outline.lower]) + origin
    corners = np.array([[0.0, 0.0], [n * board.square for n in board.squares]])
    points = np.concatenate([outline, corners])
    low, high = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    step = float(high[1] - low[1]) / (2 * _HEIGHT)
    x, z = np.arange(low[0], high[0], step), np.arange(high[1], low[1], -step)
    gx, gz = np.meshgrid(x, z)
    pixels = trace.view.project(np.column_stack([gx.ravel(), np.full(gx.size, trace.plane), gz.ravel()]))
    maps = pixels.astype(np.float32).reshape(*gx.shape, 2)
    flat = cv2.remap(image, maps[..., 0], maps[..., 1], cv2.INTER_LINEAR, borderValue=255)
    picture = coloured(np.asarray(flat, dtype=np.uint8))
    for value in np.arange(-0.2, 0.4, 0.01):
        bold = 2 if abs(value) < 1e-9 else 1
        colour = RED if bold == 2 else (190, 190, 150)
        column, row = round((value + origin[0] - low[0]) / step), round((high[1] - value - origin[1]) / step)
        cv2.line(picture, (column, 0), (column, len(z)), colour, bold, cv2.LINE_AA)
        cv2.line(picture, (0, row), (len(x), row), colour, bold, cv2.LINE_AA)
    return picture


def _overlay(image: Grey, trace: Trace, body: trimesh.Trimesh) -> Picture:
    """The mesh's edges as the camera saw them, those that face it."""
    origin = np.array([trace.origin[0], trace.plane, trace.origin[1]])
    vertices = np.asarray(body.vertices) + origin
    centres = vertices[np.asarray(body.faces)].mean(axis=1)
    facing = ((trace.view.eye - centres) * np.asarray(body.face_normals)).sum(axis=1) > 0
    pixels = trace.view.project(vertices)
    picture = coloured(image)
    shade = picture.copy()
    fixed = np.rint(pixels[np.asarray(body.faces)[facing]] * 16).astype(np.int32)
    light = np.abs(np.asarray(body.face_normals)[facing][:, 1])
    for triangle, bright in zip(fixed, light, strict=True):
        colour = tuple(float(c) * (0.55 + 0.45 * float(bright)) for c in (235, 175, 90))
        cv2.fillConvexPoly(shade, triangle, colour, cv2.LINE_AA, 4)
    mixed = cv2.addWeighted(picture, 0.35, shade, 0.65, 0.0)
    return np.asarray(mixed, dtype=np.uint8)
