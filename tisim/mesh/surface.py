"""Closed surfaces to make bodies from: read, put into metres, and checked."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._crossing import crossing_faces
from tisim.mesh._errors import MeshError

Units = Literal["m", "mm"]

_SCALE = {"m": 1.0, "mm": 1e-3}
_LARGEST, _SMALLEST = 2.0, 0.5e-3  # extents of a specimen [m] that can be meant


def checked_surface(surface: Any, *, units: Units = "m", allow_cavities: bool = False) -> Any:
    """The surface as a trimesh.Trimesh in metres; a MeshError of one sentence where it bounds no body.

    surface: path of a file that trimesh reads, or a trimesh.Trimesh.
    allow_cavities: whether it may be of several pieces, the inner ones turned inwards.
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
    """Volume of each connected piece [m3], negative where it is turned inwards."""
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
