"""Bodies from files: CAD meshes, their units said by who reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import trimesh

from calibration.errors import InputError
from tisim.mesh import MeshError
from tisim.mesh.surface import checked_surface

Units = Literal["mm", "m"]

_ENDINGS = (".stl", ".ply")


def read_mesh(path: str | Path, *, units: Units) -> trimesh.Trimesh:
    """A closed body from an STL or PLY file, in metres, its faces turned outwards.

    units: of the file's coordinates; neither format says.
    Raises InputError (one sentence) for another ending, a file that cannot be read, a surface that is open,
    crosses itself or is in several pieces, or a size that belies the units.
    """
    path = Path(path)
    if units not in ("mm", "m"):
        raise InputError(f"{path}: units: expected 'mm' or 'm', got {units!r}")
    if path.suffix.lower() not in _ENDINGS:
        raise InputError(f"{path}: expected a name that ends in .stl or .ply")
    try:
        return checked_surface(path, units=units)
    except MeshError as error:
        raise InputError(f"{error}") from error
