"""Closed surfaces from which bodies are made: read, converted to metres, and checked."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import MeshError

Units = Literal["m", "mm"]

_SCALE = {"m": 1.0, "mm": 1e-3}
_LARGEST, _SMALLEST = 2.0, 0.5e-3  # plausible extents of a specimen [m]


def checked_surface(surface: Any, *, units: Units = "m", allow_cavities: bool = False) -> Any:
    """The surface as a trimesh.Trimesh in metres.

    Parameters
    ----------
    surface : path or trimesh.Trimesh
        A file that trimesh reads, or a surface.
    units : "m" or "mm"
        Unit of the surface's coordinates.
    allow_cavities : bool
        Allow several pieces, of which one is outward and the others bound cavities.

    Raises
    ------
    MeshError
        If the surface does not bound a body; the message is one sentence.
    """
    if units not in _SCALE:
        raise MeshError(f"units must be 'm' or 'mm', got {units!r}")
    shell, name = _load(surface)
    if not len(shell.faces) or not len(shell.vertices):
        raise MeshError(f"{name} is empty: it has no triangles")
    if not np.isfinite(shell.vertices).all():
        raise MeshError(f"{name} has coordinates that are not finite numbers")
    shell.apply_scale(_SCALE[units])
    _check_size(shell, name, units)
    shell.merge_vertices()
    shell.update_faces(shell.nondegenerate_faces())
    shell.remove_unreferenced_vertices()
    _check_closed(shell, name)
    volumes = _piece_volumes(shell)
    pieces, outward = len(volumes), int((volumes > 0).sum())
    if pieces > 1 and not (allow_cavities and outward == 1):
        what = "bodies" if allow_cavities and outward else "pieces"
        count = outward if what == "bodies" else pieces
        raise MeshError(f"{name} consists of {count} separate {what}: keep one, or join them")
    crossing = crossing_faces(shell)
    if len(crossing):
        where = shell.triangles_center[crossing[0, 0]] / _SCALE[units]
        at = ", ".join(f"{c:.4g}" for c in where)
        raise MeshError(
            f"{name} cuts through itself in {len(crossing)} pairs of triangles, first near ({at}) {units}"
        )
    volume = volumes.sum()
    if abs(volume) < 1e-9 * shell.extents.max() ** 3:
        raise MeshError(f"{name} is flat: it holds no volume")
    if volume < 0:
        raise MeshError(f"{name} is inside-out, its volume is negative: turn the normals (Trimesh.invert)")
    return shell


def _piece_volumes(shell: Any) -> NDArray[np.float64]:
    """Volume of each connected piece [m3], negative for inward normals."""
    import trimesh

    label = trimesh.graph.connected_component_labels(shell.face_adjacency, len(shell.faces))
    corner = np.asarray(shell.triangles) - np.asarray(shell.vertices).mean(axis=0)
    volumes: NDArray[np.float64] = np.zeros(label.max() + 1)
    np.add.at(volumes, label, np.linalg.det(corner) / 6)
    return volumes


def _load(surface: Any) -> tuple[Any, str]:
    import trimesh  # takes longer to import than tisim itself

    if isinstance(surface, trimesh.Trimesh):
        return surface.copy(), "the surface"
    path = Path(surface)
    if not path.is_file():
        raise MeshError(f"there is no surface file {path}")
    try:
        loaded = trimesh.load_mesh(path)
    except Exception as error:  # a reader may raise anything on a broken file
        first = (str(error).strip() or type(error).__name__).splitlines()[0]
        raise MeshError(f"{path} cannot be read as a surface: {first}") from error
    if isinstance(loaded, trimesh.Scene):
        loaded = loaded.to_mesh() if loaded.geometry else trimesh.Trimesh()
    if not isinstance(loaded, trimesh.Trimesh):
        return trimesh.Trimesh(), str(path)
    return loaded.copy(), str(path)


def _check_size(shell: Any, name: str, units: Units) -> None:
    largest = float(np.ptp(shell.vertices, axis=0).max())
    if largest > _LARGEST:
        hint = "its coordinates look like millimetres: say units='mm'" if units == "m" else "check its units"
        raise MeshError(f"{name} is {largest:.3g} m large; {hint}")
    if largest < _SMALLEST:
        hint = "its coordinates look like metres: say units='m'" if units == "mm" else "check its units"
        raise MeshError(f"{name} is only {largest * 1e3:.3g} mm large; {hint}")


def _check_closed(shell: Any, name: str) -> None:
    if not len(shell.faces):
        raise MeshError(f"{name} is empty: all of its triangles have collapsed to lines")
    _, count = np.unique(shell.edges_sorted, axis=0, return_counts=True)
    free, shared = int((count == 1).sum()), int((count > 2).sum())
    if free:
        raise MeshError(f"{name} is open: {free} boundary edges belong to one triangle only; fill its holes")
    if shared:
        raise MeshError(f"{name} is no simple surface: {shared} edges belong to more than two triangles")
    if not shell.is_winding_consistent:
        raise MeshError(f"{name} has triangles turned against their neighbours: make the normals consistent")


def crossing_faces(shell: Any) -> NDArray[np.int64]:
    """Pairs (k, 2) of faces of a trimesh.Trimesh in which an edge of one passes through the other.

    Pairs that share an edge are excluded, and coplanar faces that overlap are not found.
    """
    pairs = _near_pairs(np.asarray(shell.triangles))
    faces = np.asarray(shell.faces)
    shared = (faces[pairs[:, 0], :, None] == faces[pairs[:, 1], None, :]).sum(axis=(1, 2))
    pairs = pairs[shared < 2]
    hit = _edges_pass(shell, pairs[:, 0], pairs[:, 1]) | _edges_pass(shell, pairs[:, 1], pairs[:, 0])
    return pairs[hit]


def _near_pairs(triangles: NDArray[np.float64]) -> NDArray[np.int64]:
    """Pairs of triangles whose bounding boxes overlap, first < second, by a sweep along the longest axis."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    axis = int(np.argmax(high.max(axis=0) - low.min(axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order, boxes i + 1 ... stop[i] - 1 start before box i ends
    stop = np.searchsorted(low[order, axis], high[order, axis], side="right")
    found = []
    for start in range(0, len(order), 256):
        rows = np.arange(start, min(start + 256, len(order)))
        columns = np.arange(start, stop[rows].max())
        i, j = order[rows][:, None], order[columns][None]
        overlap = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=2) & (columns[None] > rows[:, None])
        a, b = np.nonzero(overlap)
        found.append(np.sort(np.stack([order[rows[a]], order[columns[b]]], axis=1), axis=1))
    return np.concatenate(found)


def _edges_pass(shell: Any, first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.bool_]:
    """True if an edge of face first[k] passes through the interior of face second[k], shape (k,)."""
    faces, vertices = np.asarray(shell.faces), np.asarray(shell.vertices)
    corner = vertices[faces[second]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(area > 0, area, 1.0)[:, None]
    # points nearer than this to a plane or an edge touch it and do not cross it
    slack = 1e-9 * np.linalg.norm(np.ptp(vertices, axis=0))
    hit = np.zeros(len(first), dtype=bool)
    for m in range(3):
        ends = faces[first][:, [m, (m + 1) % 3]]
        p, q = vertices[ends[:, 0]], vertices[ends[:, 1]]
        above = ((p - corner[:, 0]) * unit).sum(axis=1)
        below = ((q - corner[:, 0]) * unit).sum(axis=1)
        crosses = (np.minimum(above, below) < -slack) & (np.maximum(above, below) > slack)
        gap = np.where(crosses, above - below, 1.0)
        point = p + (above / gap)[:, None] * (q - p)
        inside = np.ones(len(first), dtype=bool)
        for k in range(3):
            a, b = corner[:, k], corner[:, (k + 1) % 3]
            side = (np.cross(b - a, point - a) * unit).sum(axis=1)
            inside &= side > slack * np.linalg.norm(b - a, axis=1)
        hit |= crosses & inside
    return hit
