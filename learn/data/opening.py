"""Opening a finished dataset: its attributes, arrays and manifest are checked, its small tables are read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from learn.data._files import Source, group_here, reading
from learn.data._format import (
    ARRAYS,
    BLOCKS,
    FORMAT,
    GRID,
    LEVELS,
    SIMILAR,
    TIMED,
    check_arrays,
    check_attributes,
    check_rows,
)
from learn.data.moduli import moduli
from learn.data.setup import Setup, grid_normals
from learn.data.store import Clock, Store
from learn.errors import InputError

Ints = NDArray[np.int64]


def open_store(location: str | Path, *, verify: bool = True) -> Store:
    """Open a finished store in a folder, in a zip or at an fsspec URL.

    `verify` compares the files with the store's manifest (see `Source.check_manifest`); without it only those
    of the small tables, which are quick to check: a lost part of a profile would be read as homogeneous
    tissue. InputError, one sentence, for anything that is not a complete store of this format in SI units.
    """
    source = Source(str(location))
    group = group_here(source.location, fresh=True)
    attributes = dict(group.attrs)
    if attributes.get("format") != FORMAT:
        raise InputError(
            f"{location}: expected a dataset of format {FORMAT}, its attribute format is "
            f"{attributes.get('format')}"
        )
    check_attributes(source.location, attributes)
    arrays = ARRAYS | (TIMED if "time" in group else {}) | (SIMILAR if "solved_as" in group else {})
    arrays |= BLOCKS if getattr(group.get("grid_rest"), "ndim", 0) == 4 else {}
    stored = check_arrays(source.location, group, attributes, arrays)
    source.check_manifest([name for name, needed in arrays.items() if verify or not needed.big])
    table: dict[str, NDArray[Any]] = {}
    for name, needed in arrays.items():
        if needed.big:
            continue
        with reading(f"{location}: {name}"):
            table[name] = np.asarray(stored[name][...])
        if needed.kinds == "f" and not np.isfinite(table[name]).all():
            raise InputError(f"{location}: {name} has a value that is not finite")
    check_rows(source.location, table, attributes)
    done = table["done"].astype(bool)
    setups, setup_index = _setups(table, _rod(source.location, attributes))
    return Store(
        location=source.location,
        attributes=attributes,
        setups=setups,
        setup_index=setup_index,
        profile=table["profile"].reshape(-1, GRID * GRID, LEVELS),
        done=done,
        shape=table["poke_shape"].astype(np.int64),
        softness=table["poke_softness"].astype(np.int64),
        geometry=table["poke_geometry"].astype(np.int64),
        modulus=moduli(
            source.location, attributes, table["parameter"], table["poke_softness"].astype(np.int64), done
        ),
        direction=table["direction"].astype(np.float64),
        path_start=table["path_start"].astype(np.float64),
        frame_start=table["frame_start"].astype(np.int64),
        frame_count=table["frame_count"].astype(np.int64),
        frame_poke=table["frame_poke"].astype(np.int64),
        depth=table["depth"].astype(np.float64),
        rod_force=table["rod_force"].astype(np.float64),
        solved_as=table.get("solved_as", np.arange(len(done))).astype(np.int64),
        clock=_clock(source.location, group, table),
    )


def _setups(table: dict[str, NDArray[Any]], rod: tuple[float, float]) -> tuple[tuple[Setup, ...], Ints]:
    """The different setups of a store, and that of each geometry."""
    grids = table["grid_rest"].reshape(-1, GRID, GRID, 3).astype(np.float64)
    levels = table["level_depth"].reshape(len(grids), LEVELS).astype(np.float64)
    rows = np.concatenate([grids.reshape(len(grids), -1), levels], axis=1) + 0.0  # no -0
    # a row as one value of its bytes: np.unique over rows is many times slower
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize)))[:, 0]
    _, first, index = np.unique(keys, return_index=True, return_inverse=True)
    order = np.argsort(first)  # as stored
    setups = tuple(
        Setup(
            points=grids[k].reshape(-1, 3),
            normals=grid_normals(grids[k]),
            level_depth=levels[k],
            rod_radius=rod[0],
            rod_edge=rod[1],
        )
        for k in first[order]
    )
    place = np.argsort(order)[index.reshape(-1)]
    return setups, np.broadcast_to(place, len(table["profile"])).astype(np.int64)


def _clock(location: str, group: zarr.Group, table: dict[str, NDArray[Any]]) -> Clock | None:
    """The clock of a store; None if it has no time."""
    if "time" not in table:
        return None
    names = np.array(str(group["phase"].attrs.get("flag_meanings", "")).split())
    if len(table["phase"]) and table["phase"].max() >= len(names):
        raise InputError(f"{location}: phase has a code without a name in flag_meanings")
    begin = table["course_time"][:, 0]
    speed = np.divide(table["course_depth"][:, 0], begin, out=np.full(len(begin), np.nan), where=begin > 0)
    return Clock(
        time=table["time"].astype(np.float64),
        phase=names[table["phase"]] if len(names) else np.empty(0, dtype=np.str_),
        rod_speed=table["rod_speed"].astype(np.float64),
        approach_speed=speed,
        dissipated_energy=table["dissipated_energy"].astype(np.float64),
    )


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
    if not (math.isfinite(radius) and radius > 0):
        raise InputError(f"{location}: attribute identity.recipe.rod.radius_mm: expected a positive number")
    if not 0 <= edge <= radius:
        raise InputError(f"{location}: attribute identity.recipe.rod.{key}: expected 0 to the rod's radius")
    return radius * 1e-3, edge * 1e-3
