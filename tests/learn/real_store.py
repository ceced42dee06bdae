"""Write twelve simulated pokes as a store, from data/pokes.npz (made by data/make_pokes.py)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import zarr

from tests.learn.small_store import write_arrays, write_manifest

PACKED = Path(__file__).parent / "data" / "pokes.npz"


def write_real_store(folder: Path) -> Path:
    """Write 12 pokes, 60 frames: 2 shapes, 3 softness levels, 8 contact points, 10 mm deep."""
    with np.load(PACKED) as file:
        data = {name: file[name] for name in file.files}
    steps, largest = data.pop("displacement"), data.pop("largest")
    data["displacement"] = steps * (largest / 32767)[:, None, None, None]
    data["frame_count"] = np.bincount(data["frame_poke"])
    grid, profile, level_depth = (data.pop(name) for name in ("grid_rest", "profile", "level_depth"))
    about, pokes = json.loads(str(data.pop("about"))), len(data["poke_shape"])
    surface = np.tile(grid.reshape(-1, 3), (pokes, 1))
    write_arrays(folder, data, profile, grid, level_depth, surface, chunk=8, shard=16)
    group = zarr.open_group(folder, mode="r+")
    group.attrs.update(format=1, uuid="twelve-pokes", fingerprint="-", pokes=pokes, **about)
    write_manifest(folder)
    return folder
