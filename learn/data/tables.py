"""The small tables of a dataset in one file: all of a `Store` but its displacement fields.

A run's folder has them (`TABLES`), so that a run predicts, and can be given away, without its dataset:
shapes, blocks, materials, contact points and forces take some hundred kilobytes, displacements a gigabyte.
"""

from __future__ import annotations

import dataclasses
import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.data._format import GRID, LEVELS
from learn.data.setup import Setup
from learn.data.store import Clock, Store
from learn.errors import InputError

FORMAT = 1
TABLES = "dataset.npz"
_ABOUT = "about"  # JSON: format, location, attributes, radii of the indenter
_WHOLE = {"location", "attributes", "setups", "clock", "has_fields"}  # fields of `Store` that are no arrays
_NAMES = [field.name for field in dataclasses.fields(Store) if field.name not in _WHOLE]
# of each array: NumPy's letter of its type, and the shape of a row, of pokes, frames or interiors
_POKE = {
    "done": ("b", ()), "shape": ("i", ()), "softness": ("i", ()), "geometry": ("i", ()), "modulus": ("f", ()),
    "direction": ("f", (3,)), "path_start": ("f", (3,)), "frame_start": ("i", ()), "frame_count": ("i", ()),
    "solved_as": ("i", ()),
}  # fmt: skip
_FRAME = {"depth": ("f", ()), "frame_poke": ("i", ()), "rod_force": ("f", (3,))}
_INTERIOR = {"profile": ("u", (GRID * GRID, LEVELS)), "setup_index": ("i", ())}
_OF_SETUP = ("points", "normals", "level_depth")
_OF_CLOCK = [field.name for field in dataclasses.fields(Clock)]


def tables_bytes(store: Store) -> bytes:
    """Content of the file for a store."""
    one = store.setups[0]
    about = {
        "format": FORMAT,
        "location": store.address,
        "attributes": store.attributes,
        "rod_radius": one.rod_radius,
        "rod_edge": one.rod_edge,
    }
    arrays: dict[str, NDArray[Any]] = {name: getattr(store, name) for name in _NAMES}
    arrays |= {f"setup_{name}": np.stack([getattr(s, name) for s in store.setups]) for name in _OF_SETUP}
    if store.clock is not None:
        arrays |= {f"clock_{name}": getattr(store.clock, name) for name in _OF_CLOCK}
    arrays[_ABOUT] = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def load_tables(path: Path | str) -> Store:
    """The store without its displacement fields (`Store.has_fields` is False).

    InputError if the file is missing, damaged or of another format.
    """
    if not Path(path).is_file():
        raise InputError(f"{path}: no such file, expected the tables of a dataset")
    try:
        with np.load(io.BytesIO(Path(path).read_bytes()), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(arrays.pop(_ABOUT).tobytes())
        if about["format"] != FORMAT:
            raise InputError(f"{path}: expected the tables of a dataset in format {FORMAT}")
        clock = {name: arrays[f"clock_{name}"] for name in _OF_CLOCK} if "clock_time" in arrays else None
        _check(arrays)
        setups = [dict(zip(_OF_SETUP, rows, strict=True)) for rows in _rows_of_setups(arrays)]
        return Store(
            location=about["location"],
            attributes=about["attributes"],
            setups=tuple(
                Setup(**one, rod_radius=about["rod_radius"], rod_edge=about["rod_edge"]) for one in setups
            ),
            clock=None if clock is None else Clock(**clock),
            has_fields=False,
            **{name: arrays[name] for name in _NAMES},
        )
    except (OSError, ValueError, KeyError, TypeError, IndexError, zipfile.BadZipFile, EOFError) as error:
        text = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: not readable as the tables of a dataset ({text})") from None


def _check(arrays: dict[str, NDArray[Any]]) -> None:
    """ValueError if types, shapes or indices of the arrays do not agree."""
    for rows in (_POKE, _FRAME, _INTERIOR):
        count = len(arrays[next(iter(rows))])
        for name, (kind, row) in rows.items():
            found = arrays[name]
            if found.dtype.kind != kind or found.shape != (count, *row):
                raise ValueError(f"{name}: {found.dtype} of shape {found.shape}, expected {count} rows {row}")
    for name, of in (("geometry", "profile"), ("frame_poke", "done"), ("setup_index", "setup_points")):
        if arrays[name].size and not 0 <= arrays[name].min() <= arrays[name].max() < len(arrays[of]):
            raise ValueError(f"{name}: points at a row that {of} has not")


def _rows_of_setups(arrays: dict[str, NDArray[Any]]) -> Any:
    return zip(*(arrays[f"setup_{name}"] for name in _OF_SETUP), strict=True)
