"""Required attributes and arrays of a dataset, and checks of their consistency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import zarr
from numpy.typing import NDArray

from learn.data._files import reading
from learn.errors import InputError

FORMAT = 1  # of the store; its root attribute `format`
GRID = 32
LEVELS = 128
RIGID = 255  # profile value of the rigid inclusion; silicones are lower

Rows = Literal["fixed", "poke", "frame", "node", "triangle", "value", "geometry"]


@dataclass(frozen=True, kw_only=True)
class Needed:
    """A required array.

    `count`: number of rows (None: that of the others of its kind); `row`: shape of one row (None: not
    checked); `kinds`: NumPy's letters of its type.
    """

    rows: Rows
    count: int | None = None
    kinds: str = "f"
    row: tuple[int, ...] | None = ()
    units: str | None = None
    big: bool = False


ATTRIBUTES = ("uuid", "fingerprint", "model", "pokes", "shapes", "softness", "parameter_names", "identity")

# fmt: off
ARRAYS: dict[str, Needed] = {
    "grid_rest": Needed(rows="fixed", count=GRID, row=(GRID, 3), units="m"),
    "level_depth": Needed(rows="fixed", count=LEVELS, units="m"),
    "profile": Needed(rows="geometry", kinds="u", row=(GRID, GRID, LEVELS), units="1"),
    "done": Needed(rows="poke", kinds="b"),
    "status": Needed(rows="poke", kinds="u"),
    "poke_shape": Needed(rows="poke", kinds="i"),
    "poke_softness": Needed(rows="poke", kinds="i"),
    "poke_geometry": Needed(rows="poke", kinds="i"),
    "law": Needed(rows="poke", kinds="u"),
    "parameter": Needed(rows="poke", row=None),
    "direction": Needed(rows="poke", row=(3,), units="1"),
    "path_start": Needed(rows="poke", row=(3,), units="m"),
    "frame_start": Needed(rows="poke", kinds="i"),
    "frame_count": Needed(rows="poke", kinds="i"),
    "frame_poke": Needed(rows="frame", kinds="i"),
    "depth": Needed(rows="frame", units="m"),
    "rod_force": Needed(rows="frame", row=(3,), units="N"),
    "grid_displacement": Needed(rows="frame", row=(GRID, GRID, 3), units="m", big=True),
    # only for errors off the grid
    "node_start": Needed(rows="poke", kinds="i"),
    "node_count": Needed(rows="poke", kinds="i"),
    "triangle_start": Needed(rows="poke", kinds="i"),
    "triangle_count": Needed(rows="poke", kinds="i"),
    "value_start": Needed(rows="poke", kinds="i"),
    "surface_rest": Needed(rows="node", row=(3,), units="m", big=True),
    "surface_triangle": Needed(rows="triangle", kinds="i", row=(3,), big=True),
    "surface_displacement": Needed(rows="value", row=(3,), units="m", big=True),
}
# in place of those of one block, in datasets whose shapes stand in blocks of different sizes
BLOCKS: dict[str, Needed] = {
    "grid_rest": Needed(rows="geometry", row=(GRID, GRID, 3), units="m"),
    "level_depth": Needed(rows="geometry", row=(LEVELS,), units="m"),
}
# only in datasets whose recipe gives the rod a course over time
TIMED: dict[str, Needed] = {
    "time": Needed(rows="frame", units="s"),
    "phase": Needed(rows="frame", kinds="u"),
    "rod_speed": Needed(rows="frame", units="m s-1"),
    "dissipated_energy": Needed(rows="frame", units="J"),
    "course_time": Needed(rows="poke", row=None, units="s"),
    "course_depth": Needed(rows="poke", row=None, units="m"),
}
# only in datasets in which pokes that differ by a factor of the moduli share one solve: the solved poke
SIMILAR: dict[str, Needed] = {"solved_as": Needed(rows="poke", kinds="i")}
# fmt: on


def check_attributes(location: str, attributes: dict[str, Any]) -> None:
    """Raise InputError unless the root has the attributes, each of its type."""
    for name in ATTRIBUTES:
        if name not in attributes:
            raise InputError(f"{location}: attribute {name} is missing")
    for name in ("uuid", "model"):
        if not isinstance(attributes[name], str) or not attributes[name]:
            raise InputError(f"{location}: attribute {name}: expected a name, got {attributes[name]!r}"[:300])
    for name in ("shapes", "softness", "parameter_names"):
        value = attributes[name]
        if not isinstance(value, list) or not value or not all(isinstance(item, str) for item in value):
            raise InputError(f"{location}: attribute {name}: expected a list of names, got {value!r}"[:300])
    if type(attributes.get("scales_with_modulus", False)) is not bool:
        raise InputError(
            f"{location}: attribute scales_with_modulus: expected true or false, got "
            f"{attributes['scales_with_modulus']!r}"[:300]
        )
    if type(attributes["pokes"]) is not int:
        raise InputError(
            f"{location}: attribute pokes: expected a whole number, got {attributes['pokes']!r}"[:300]
        )


def check_arrays(
    location: str, group: zarr.Group, attributes: dict[str, Any], arrays: Mapping[str, Needed]
) -> dict[str, zarr.Array]:
    """The arrays; InputError unless all exist, with their types, rows and units. No data are read."""
    found: dict[str, zarr.Array] = {}
    rows: dict[str, tuple[str, int]] = {}
    for name, needed in arrays.items():
        with reading(f"{location}: {name}"):
            array: Any = group.get(name)  # each look-up reads the array's metadata
            if array is None:
                raise InputError(f"{location}: array {name} is missing")
        if not isinstance(array, zarr.Array) or array.ndim == 0:
            raise InputError(f"{location}: {name}: expected an array with rows")
        _check_array(f"{location}: {name}", array, needed)
        found[name] = array
        if needed.rows == "fixed":
            continue
        first, count = rows.setdefault(needed.rows, (name, array.shape[0]))
        if array.shape[0] != count:
            raise InputError(f"{location}: {name} has {array.shape[0]} rows, {first} has {count}")
    if rows["poke"][1] != attributes["pokes"]:
        raise InputError(
            f"{location}: {rows['poke'][1]} rows of pokes, attribute pokes is {attributes['pokes']}"
        )
    return found


def _check_array(where: str, array: Any, needed: Needed) -> None:
    if array.dtype.kind not in needed.kinds:
        raise InputError(f"{where}: its type {array.dtype} is not as expected")
    if needed.row is not None and tuple(array.shape[1:]) != needed.row:
        raise InputError(f"{where}: rows of shape {tuple(array.shape[1:])}, expected {needed.row}")
    if needed.count is not None and array.shape[0] != needed.count:
        raise InputError(f"{where}: {array.shape[0]} rows, expected {needed.count}")
    if needed.units is not None and array.attrs.get("units") != needed.units:
        raise InputError(f"{where}: units {array.attrs.get('units')}, expected {needed.units}")


def check_rows(location: str, table: dict[str, NDArray[Any]], attributes: dict[str, Any]) -> None:
    """Raise InputError unless the small tables, all read, are consistent."""
    for name in ("frame_count", "node_count", "triangle_count"):
        if len(table[name]) and not table[name].min() >= 0:
            raise InputError(f"{location}: {name} has a value below 0")
    count = table["frame_count"]
    if not np.array_equal(table["frame_start"], np.cumsum(count) - count):
        raise InputError(f"{location}: frame_start does not add up frame_count")
    if not np.array_equal(table["frame_poke"], np.repeat(np.arange(len(count)), count)):
        raise InputError(f"{location}: frame_poke does not match frame_count")
    if len(table["profile"]) and not 0 <= table["poke_geometry"].min() <= table["poke_geometry"].max() < len(
        table["profile"]
    ):
        raise InputError(f"{location}: poke_geometry points outside profile")
    for name, names in (("poke_shape", "shapes"), ("poke_softness", "softness")):
        rows = table[name]
        if len(rows) and not 0 <= rows.min() <= rows.max() < len(attributes[names]):
            raise InputError(f"{location}: {name} points outside attribute {names}")
    if "time" in table:
        _check_clock(location, table)
    elif len(table["depth"]) and not table["depth"].min() > 0:
        raise InputError(f"{location}: depth has a value that is not positive")
    size = np.linalg.norm(table["direction"][table["done"].astype(bool)], axis=1)
    if not np.allclose(size, 1, atol=1e-6):
        raise InputError(f"{location}: direction is not of unit length")


def _check_clock(location: str, table: dict[str, NDArray[Any]]) -> None:
    if len(table["depth"]) and not table["depth"].min() >= 0:
        raise InputError(f"{location}: depth has a value below 0")
    poke, time = table["frame_poke"], table["time"]
    first = np.diff(poke, prepend=-1) != 0
    if not (np.where(first, time, np.diff(time, prepend=0.0)) > 0).all():
        raise InputError(f"{location}: time does not rise from 0 in each poke")
    corners, depths = table["course_time"], table["course_depth"]
    if corners.ndim != 2 or corners.shape != depths.shape or not corners.shape[1]:
        raise InputError(f"{location}: course_time and course_depth are not of one shape")
    done = table["done"].astype(bool)
    if not (corners[done, 0] > 0).all() or not (depths[done, 0] > 0).all():
        raise InputError(f"{location}: course_time, course_depth: a course does not begin with a way down")
