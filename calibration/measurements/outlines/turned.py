"""Interactive 3D view of photographed beams: measured outline and simulated body, a frame per photograph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.outlines._photographs import SeenPhotograph, shown
from tisim import surface_triangles
from tisim.mesh import boundary_facets, unfold
from tisim.view import Field, Surface, View, outlines

Array = NDArray[np.float64]

MOST = 36  # largest number of photographs on a page
MEASURED = (0.835, 0.369, 0.0, 1.0)  # vermilion of the other figures
THICK = 0.004  # radius of the drawn outline over the beam's length
AROUND = 6
POINTS = 60  # points of an edge


def turned(seen: Sequence[SeenPhotograph], *, title: str) -> View:
    """View of the simulated bodies in the image, with the traced outlines in their mid plane.

    Nuisances are removed from the outlines. Of more than MOST photographs an even selection is shown.
    """
    chosen = np.unique(np.round(np.linspace(0, len(seen) - 1, min(len(seen), MOST))).astype(int))
    surfaces, labels = [], []
    for frame, k in enumerate(chosen):
        s = seen[k]
        surfaces += [_body(s, frame), _measured(s, frame)]
        rms = 1e3 * float(np.sqrt(np.mean(s.left**2)))
        labels.append(f"{s.photograph.name} · outline from body: {rms:.2g} mm rms, registered")
    notes = ["The outline is drawn where it lies with registration and other nuisances removed."]
    if len(chosen) < len(seen):
        notes.append(f"{len(chosen)} of {len(seen)} photographs.")
    return View(
        title=title,
        labels=tuple(labels),
        surfaces=tuple(surfaces),
        towards=(0.3, -1.0, 0.3),
        notes=tuple(notes),
    )


def _body(s: SeenPhotograph, frame: int) -> Surface:
    mesh, x = unfold(s.result.mesh, s.result.positions[-1])
    moved = 1e3 * np.linalg.norm(x - mesh.nodes, axis=1)
    x = x.copy()
    x[:, [0, 2]] = shown(x[:, [0, 2]], s.images)
    triangles = surface_triangles(mesh)
    facets = mesh.facet_sets.get("surface")
    lines = outlines(boundary_facets(mesh.kind, mesh.elements) if facets is None else facets)
    used, place = np.unique(triangles, return_inverse=True)
    number = np.zeros(mesh.n_nodes, dtype=np.int32)
    number[used] = np.arange(len(used))
    return Surface(
        positions=x[None, used],
        triangles=np.asarray(place, dtype=np.int32).reshape(-1, 3),
        edges=number[lines],
        fields=(Field(name="displacement", unit="mm", values=moved[None, used]),),
        frame=frame,
    )


def _measured(s: SeenPhotograph, frame: int) -> Surface:
    """Both traced edges as thin tubes."""
    radius = THICK * s.photograph.trial.free_length
    start = 0
    points: list[Array] = []
    triangles: list[NDArray[np.int32]] = []
    for projection in s.projections:
        left = s.left[start : start + len(projection.nearest)]
        start += len(projection.nearest)
        line = projection.nearest + left[:, None] * projection.normal
        some = np.unique(np.round(np.linspace(0, len(line) - 1, min(len(line), POINTS))).astype(int))
        vertices, faces = _tube(line[some], radius)
        triangles.append(faces + sum(map(len, points)))
        points.append(vertices)
    return Surface(
        positions=np.concatenate(points)[None],
        triangles=np.concatenate(triangles).astype(np.int32),
        colour=MEASURED,
        name="measured outline",
        frame=frame,
    )


def _tube(line: Array, radius: float) -> tuple[Array, NDArray[np.int32]]:
    """Vertices (v, 3) and triangles (t, 3) of a thin tube along a line (k, 2) in the plane y = 0."""
    along = np.gradient(line, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    k = len(line)
    across = np.column_stack([-along[:, 1], np.zeros(k), along[:, 0]])
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    ring = np.cos(turn)[:, None] * across[:, None] + np.sin(turn)[:, None] * np.array([0.0, 1.0, 0.0])
    centres = np.column_stack([line[:, 0], np.zeros(k), line[:, 1]])
    vertices = (centres[:, None] + radius * ring).reshape(-1, 3)
    a = (AROUND * np.arange(k - 1)[:, None] + np.arange(AROUND)).ravel()
    b = (AROUND * np.arange(k - 1)[:, None] + np.roll(np.arange(AROUND), -1)).ravel()
    quads = [np.column_stack([a, b, b + AROUND]), np.column_stack([a, b + AROUND, a + AROUND])]
    return vertices, np.concatenate(quads).astype(np.int32)
