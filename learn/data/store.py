"""A finished dataset: its small tables in memory, its displacement field block by block.

>>> store = open_store("datasets/quick-ogden.zarr")
>>> store.frames, store.points.shape
>>> store.displacement(slice(0, 64))               # [m], (64, 1024, 3) float32
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from learn.data._format import ARRAYS, ATTRIBUTES, FORMAT, GRID, LEVELS, RIGID, Needed
from learn.data._source import Source, displacement_reader, group_here, reading
from learn.data.material import shear_modulus
from learn.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Store:
    """p pokes, f frames, n = 1024 grid points, g geometries (shape x softness). SI units.

    points: rest positions (n, 3); normals: outward unit normals (n, 3). profile: stiffness under each
    point as stored, (g, n, levels) uint8, top level first; level_depth (levels,). rod_radius; rod_edge:
    radius of the tip's rounded edge, that of the rod for a hemisphere [m].
    By poke: done, shape, softness, geometry (indices), modulus (small-strain shear modulus, Pa), direction
    (unit), path_start (rod tip at first touch), frame_start, frame_count.
    By frame: poke, depth [m], rod_force (f, 3) [N].
    """

    location: str
    attributes: dict[str, Any]
    points: Floats
    normals: Floats
    profile: NDArray[np.uint8]
    level_depth: Floats
    rod_radius: float
    rod_edge: float
    done: NDArray[np.bool_]
    shape: Ints
    softness: Ints
    geometry: Ints
    modulus: Floats
    direction: Floats
    path_start: Floats
    frame_start: Ints
    frame_count: Ints
    frame_poke: Ints
    depth: Floats
    rod_force: Floats

    @property
    def uuid(self) -> str:
        return str(self.attributes["uuid"])

    @property
    def law(self) -> str:
        return str(self.attributes["model"])

    @property
    def shapes(self) -> list[str]:
        return [str(name) for name in self.attributes["shapes"]]

    @property
    def softness_names(self) -> list[str]:
        return [str(name) for name in self.attributes["softness"]]

    @property
    def pokes(self) -> int:
        return len(self.done)

    @property
    def frames(self) -> int:
        return len(self.depth)

    @property
    def block(self) -> int:
        """Frames that are cheapest read together: those of one file (a shard) of the displacement."""
        array: Any = group_here(self.location)["grid_displacement"]
        return int((array.shards or array.chunks)[0])

    @property
    def chunk(self) -> int:
        """Frames that are decompressed together."""
        array: Any = group_here(self.location)["grid_displacement"]
        return int(array.chunks[0])

    def displacement(self, rows: slice, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """Displacement [m] of the grid points in these frames, (frames, n, 3); out: room for it, optional.

        InputError where the store cannot be read or holds a value that is not finite.
        """
        start, stop, _ = rows.indices(self.frames)
        if out is None:
            out = np.empty((max(stop - start, 0), len(self.points), 3), dtype=np.float32)
        with reading(f"{self.location}: grid_displacement"):
            reader = displacement_reader(self.location)
            if reader is not None:
                reader.read(start, stop, out.reshape(-1, GRID, GRID, 3))
            else:
                array: Any = group_here(self.location)["grid_displacement"]
                out[...] = np.asarray(array[start:stop]).reshape(out.shape)
        flat = out.reshape(-1)
        if not np.isfinite(np.dot(flat, flat)):  # once over the values, nothing stored
            bad = int(np.flatnonzero(~np.isfinite(out).all(axis=(1, 2)))[0]) + start
            raise InputError(
                f"{self.location}: grid_displacement: frame {bad} has a value that is not finite"
            )
        return out

    def surface(self, poke: int) -> tuple[Floats, NDArray[np.int64], NDArray[np.float32]]:
        """One poke's own surface mesh: rest nodes (m, 3), triangles (t, 3), displacement (frames, m, 3)."""
        table = {
            name: int(self._array(name)[poke])
            for name in ("node_start", "node_count", "triangle_start", "triangle_count", "value_start")
        }
        nodes = slice(table["node_start"], table["node_start"] + table["node_count"])
        faces = slice(table["triangle_start"], table["triangle_start"] + table["triangle_count"])
        frames, count = int(self.frame_count[poke]), table["node_count"]
        values = slice(table["value_start"], table["value_start"] + frames * count)
        moved = np.asarray(self._array("surface_displacement", values)).reshape(frames, count, 3)
        rest = np.asarray(self._array("surface_rest", nodes), dtype=np.float64)
        triangles = np.asarray(self._array("surface_triangle", faces), dtype=np.int64)
        if triangles.size and not (triangles.min() >= 0 and triangles.max() < count):
            raise InputError(f"{self.location}: surface_triangle: poke {poke} points at a node it has not")
        if not (np.isfinite(moved).all() and np.isfinite(rest).all()):
            raise InputError(f"{self.location}: surface of poke {poke} has a value that is not finite")
        return rest, triangles, moved

    def _array(self, name: str, rows: slice | None = None) -> NDArray[Any]:
        array: Any = group_here(self.location)[name]
        with reading(f"{self.location}: {name}"):
            return np.asarray(array[rows if rows is not None else slice(None)])


def open_store(location: str | Path, *, verify: bool = True) -> Store:
    """A finished store in a folder or at an fsspec URL.

    verify: compare the files with the store's manifest (see `Source.check_manifest`).
    InputError, one sentence, for anything that is not a whole store of this format in SI units.
    """
    source = Source(str(location))
    group = group_here(source.location, fresh=True)
    attributes = dict(group.attrs)
    if attributes.get("format") != FORMAT:
        raise InputError(
            f"{location}: expected a dataset of format {FORMAT}, its attribute format is "
            f"{attributes.get('format')}"
        )
    for name in ATTRIBUTES:
        if name not in attributes:
            raise InputError(f"{location}: attribute {name} is missing")
    _check_arrays(source.location, group, attributes)
    if verify:
        source.check_manifest(list(ARRAYS))
    table: dict[str, NDArray[Any]] = {}
    for name, needed in ARRAYS.items():
        if needed.big:
            continue
        array: Any = group[name]
        with reading(f"{location}: {name}"):
            table[name] = np.asarray(array[...])
        if needed.kinds == "f" and not np.isfinite(table[name]).all():
            raise InputError(f"{location}: {name} has a value that is not finite")
    _check_rows(source.location, table)
    done = table["done"].astype(bool)
    radius, edge = _rod(source.location, attributes)
    points = table["grid_rest"].reshape(-1, 3).astype(np.float64)
    return Store(
        location=source.location,
        attributes=attributes,
        points=points,
        normals=grid_normals(table["grid_rest"].astype(np.float64)),
        profile=table["profile"].reshape(-1, GRID * GRID, LEVELS),
        level_depth=table["level_depth"].astype(np.float64),
        rod_radius=radius,
        rod_edge=edge,
        done=done,
        shape=table["poke_shape"].astype(np.int64),
        softness=table["poke_softness"].astype(np.int64),
        geometry=table["poke_geometry"].astype(np.int64),
        modulus=_moduli(attributes, table["parameter"], done),
        direction=table["direction"].astype(np.float64),
        path_start=table["path_start"].astype(np.float64),
        frame_start=table["frame_start"].astype(np.int64),
        frame_count=table["frame_count"].astype(np.int64),
        frame_poke=table["frame_poke"].astype(np.int64),
        depth=table["depth"].astype(np.float64),
        rod_force=table["rod_force"].astype(np.float64),
    )


def grid_normals(grid: Floats) -> Floats:
    """Unit normals of a grid of points (rows, columns, 3), columns to the right of rows: (n, 3)."""
    along, up = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    normal = np.cross(along, up).reshape(-1, 3)
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def rigid_masks(profile: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], Ints]:
    """Which levels are rigid, once a distinct inclusion: (k, n, levels); and the k of each geometry (g,)."""
    masks, index = np.unique(profile == RIGID, axis=0, return_inverse=True)
    return masks, np.asarray(index, dtype=np.int64).reshape(-1)


def _check_arrays(location: str, group: zarr.Group, attributes: dict[str, Any]) -> None:
    rows: dict[str, tuple[str, int]] = {}
    for name, needed in ARRAYS.items():
        if name not in group:
            raise InputError(f"{location}: array {name} is missing")
        array: Any = group[name]
        _check_array(f"{location}: {name}", array, needed)
        if needed.rows == "fixed":
            continue
        first, count = rows.setdefault(needed.rows, (name, array.shape[0]))
        if array.shape[0] != count:
            raise InputError(f"{location}: {name} has {array.shape[0]} rows, {first} has {count}")
    if rows["poke"][1] != attributes["pokes"]:
        raise InputError(
            f"{location}: {rows['poke'][1]} rows of pokes, attribute pokes is {attributes['pokes']}"
        )


def _check_array(where: str, array: Any, needed: Needed) -> None:
    if array.dtype.kind not in needed.kinds:
        raise InputError(f"{where}: its type {array.dtype} is not as expected")
    if needed.row is not None and tuple(array.shape[1:]) != needed.row:
        raise InputError(f"{where}: rows of shape {tuple(array.shape[1:])}, expected {needed.row}")
    if needed.units is not None and array.attrs.get("units") != needed.units:
        raise InputError(f"{where}: units {array.attrs.get('units')}, expected {needed.units}")


def _check_rows(location: str, table: dict[str, NDArray[Any]]) -> None:
    count = table["frame_count"]
    if not np.array_equal(table["frame_start"], np.cumsum(count) - count):
        raise InputError(f"{location}: frame_start does not add up frame_count")
    if not np.array_equal(table["frame_poke"], np.repeat(np.arange(len(count)), count)):
        raise InputError(f"{location}: frame_poke does not match frame_count")
    if len(table["profile"]) and not 0 <= table["poke_geometry"].min() <= table["poke_geometry"].max() < len(
        table["profile"]
    ):
        raise InputError(f"{location}: poke_geometry points outside profile")
    if len(table["depth"]) and not table["depth"].min() > 0:
        raise InputError(f"{location}: depth has a value that is not positive")
    size = np.linalg.norm(table["direction"][table["done"].astype(bool)], axis=1)
    if not np.allclose(size, 1, atol=1e-6):
        raise InputError(f"{location}: direction is not of unit length")


def _rod(location: str, attributes: dict[str, Any]) -> tuple[float, float]:
    """Radius of the rod and of its tip's edge [m]."""
    key = "radius_mm"
    try:
        rod = attributes["identity"]["recipe"]["rod"]
        radius = float(rod[key])
        key = "tip"
        flat = rod[key] == "flat"
        key = "edge_radius_mm"
        edge = float(rod[key]) if flat else radius
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{location}: attribute identity.recipe.rod.{key} is missing") from None
    if not 0 <= edge <= radius:
        raise InputError(f"{location}: attribute identity.recipe.rod.{key}: expected 0 to the rod's radius")
    return radius * 1e-3, edge * 1e-3


def _moduli(attributes: dict[str, Any], parameter: NDArray[Any], done: NDArray[np.bool_]) -> Floats:
    law, names = str(attributes["model"]), [str(name) for name in attributes["parameter_names"]]
    rows = parameter.reshape(len(done), -1)
    found = np.full(len(done), np.nan)  # of a poke that was not simulated
    for poke in np.flatnonzero(done):
        found[poke] = shear_modulus(law, dict(zip(names, rows[poke], strict=True)))
    return found
