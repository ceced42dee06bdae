"""Views of files: VTU, series of them (.pvd), and pokes of a dataset's store."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np

from tisim.bodies import Rod
from tisim.io.export import FIELDS
from tisim.io.picture import across
from tisim.io.read import SOLIDS, is_mask, meshio_file
from tisim.mesh import Mesh, MeshError
from tisim.view._quantities import Quantity, curve, frames_shown, label, thinned
from tisim.view._result import COLOURINGS, body_surfaces, handy, rod, towards
from tisim.view._view import Array, Field, Ints, View

_LEFT_OUT = {"rest_position", "displacement", *FIELDS}


def view_of_files(paths: list[Path], *, poke: int | None = None) -> View:
    """See `tisim.view.view_of_file`."""
    for path in paths:
        if not path.exists():
            raise FileNotFoundError(f"{path}: there is no such file")
    first = paths[0]
    if first.is_dir() or first.suffix.lower() == ".zip":
        from tisim.view._store import view_of_poke

        if len(paths) > 1:
            raise ValueError(f"{paths[1]}: expected one store at a time")
        return view_of_poke(first, poke)
    if poke is not None:
        raise ValueError(f"{first}: --poke goes with the store of a dataset (.zarr)")
    if first.suffix.lower() == ".pvd":
        if len(paths) > 1:
            raise ValueError(f"{paths[1]}: expected one .pvd at a time")
        return _view_of_vtu(first.stem, _of_series(first))
    for path in paths:
        if path.suffix.lower() != ".vtu":
            raise ValueError(f"{path}: expected a .vtu, a .pvd or the store of a dataset (.zarr)")
    return _view_of_vtu(first.stem, paths)


def _of_series(path: Path) -> list[Path]:
    try:
        rows = [row.attrib["file"] for row in ET.parse(path).iter("DataSet")]
    except (ET.ParseError, KeyError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: expected a ParaView series (.pvd): {error}") from None
    if not rows:
        raise ValueError(f"{path}: expected a series of .vtu files, it names none")
    found = [path.parent / row for row in rows]
    for file in found:
        if not file.is_file():
            raise FileNotFoundError(f"{path}: names {file}, which is not there")
    return found


def _view_of_vtu(name: str, paths: list[Path]) -> View:
    kept = frames_shown(len(paths))
    read = [_read(paths[k]) for k in kept]
    kind, elements = _solids(paths[0], read[0])
    for path, m in zip([paths[k] for k in kept], read, strict=True):
        other, same = _solids(path, m)
        if other != kind or not np.array_equal(same, elements):
            raise ValueError(
                f"{path}: expected the elements of {paths[0]}, of which it is to be a later frame"
            )
    rest, positions = _rest_and_moved(read)
    mesh = Mesh(kind=kind, nodes=rest, elements=elements)
    constant = [_constants(m) for m in read]
    tips = np.array([c["rod_tip"] for c in constant if "rod_tip" in c])
    has_rod = len(tips) == len(read) and all("rod_axis" in c and "rod_shape" in c for c in constant)
    axes = np.array([c["rod_axis"] for c in constant]) if has_rod else np.zeros((0, 3))
    sideways = across(tuple(axes[0]) if has_rod else None)
    surfaces = body_surfaces(
        mesh, positions, _fields(read, rest, positions), sideways, tips[0] if has_rod else rest.mean(axis=0)
    )
    if has_rod:
        radius, length, edge = (float(v) for v in constant[0]["rod_shape"])
        surfaces.append(rod(Rod(radius=radius, length=length, edge_radius=edge), tips, axes))
    stated = [_quantities(c, has_rod) for c in constant]
    labels = [
        label(words) if words else path.name
        for words, path in zip(stated, [paths[k] for k in kept], strict=True)
    ]
    whole = all(len(words) > 1 for words in stated)
    return View(
        title=name,
        labels=tuple(labels),
        surfaces=tuple(surfaces),
        curve=curve([words[0] for words in stated], [words[-1] for words in stated]) if whole else None,
        towards=towards(sideways, steep=has_rod),
        opened=has_rod,
        rest=not has_rod and len(read) == 1,
        notes=thinned(len(paths)),
    )


_CONSTANT: dict[str, tuple[int, ...]] = {
    **dict.fromkeys(("load", "time", "nominal_stress"), ()),
    **dict.fromkeys(("support_force", "rod_force", "rod_tip", "rod_axis", "rod_shape"), (3,)),
}


def _read(path: Path) -> Any:
    try:
        return meshio_file(path)
    except MeshError as error:
        raise ValueError(f"{path}: {error}") from None


def _solids(path: Path, m: Any) -> tuple[Any, Ints]:
    """Type and nodes of the solid elements of a file; ValueError unless all have one type."""
    blocks = [(SOLIDS[block.type], block.data) for block in m.cells if block.type in SOLIDS]
    kinds = {kind for kind, _ in blocks}
    if len(kinds) != 1:
        found = ", ".join(sorted({block.type for block in m.cells})) or "none"
        raise ValueError(f"{path}: expected solid elements of one kind ({', '.join(SOLIDS)}), found {found}")
    return kinds.pop(), np.concatenate([np.asarray(data, dtype=np.int32) for _, data in blocks])


def _rest_and_moved(read: list[Any]) -> tuple[Array, Array]:
    """Rest positions (n, 3) and positions (frames, n, 3).

    tisim writes moved points and `rest_position`. Other programs write points at rest with `displacement`, or
    moved points, which then differ between frames.
    """
    points = np.array([np.asarray(m.points, dtype=float) for m in read])
    first = read[0].point_data
    if "rest_position" in first:
        return np.asarray(first["rest_position"], dtype=float), points
    moved = [np.asarray(m.point_data.get("displacement", 0.0), dtype=float) for m in read]
    if any(u.shape != points[0].shape for u in moved):
        return points[0], points
    if all(np.array_equal(x, points[0]) for x in points):
        return points[0], points + np.array(moved)
    return points[0] - moved[0], points


def _constants(m: Any) -> dict[str, Array]:
    """Data of the frame, which tisim writes as constant cell data; those of that form of other programs."""
    found = {}
    for name, shape in _CONSTANT.items():
        values = m.cell_data.get(name)
        if values and len(values[0]) and np.shape(values[0][0]) == shape:
            found[name] = np.asarray(values[0][0], dtype=float)
    return found


def _fields(read: list[Any], rest: Array, positions: Array) -> tuple[Field, ...]:
    """Fields of the displacement, of stress and strain as tisim writes them, and of other nodal scalars."""
    found = [Field(name="displacement", unit="mm", values=1e3 * np.linalg.norm(positions - rest, axis=2))]
    stated = {attribute: name for name, attribute in FIELDS.items()}
    for name, attribute, component, unit in COLOURINGS:
        rows = [m.point_data.get(stated[attribute]) for m in read]
        if all(row is not None for row in rows):
            values = np.array([row if component is None else row[:, component] for row in rows], dtype=float)
            found.append(handy(name, unit, values))
    for name, first in read[0].point_data.items():
        rows = [np.asarray(m.point_data.get(name, 0.0)) for m in read]
        known = name in _LEFT_OUT or is_mask(first)
        if not known and all(row.shape == (len(rest),) and np.isfinite(row).all() for row in rows):
            found.append(Field(name=name, unit="", values=np.array(rows, dtype=float)))
    return tuple(found)


def _quantities(constant: dict[str, Array], has_rod: bool) -> list[Quantity]:
    found: list[Quantity] = []
    if has_rod and "load" in constant:
        found.append(("depth", 1e3 * float(constant["load"]), "mm"))
    elif "load" in constant and "time" not in constant:
        found.append(("load", float(constant["load"]), ""))
    if "time" in constant:
        found.append(("time", float(constant["time"]), "s"))
    if "nominal_stress" in constant:
        return [*found, ("nominal stress", 1e-3 * float(constant["nominal_stress"]), "kPa")]
    for name, words in (("rod_force", "force on the rod"), ("support_force", "force of the supports")):
        if name in constant:
            found.append((words, float(np.linalg.norm(constant[name])), "N"))
            break
    return found
