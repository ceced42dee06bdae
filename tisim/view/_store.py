"""View of a poke of a dataset's store: any Zarr 3 store of the format in docs/reference/dataset-format.md."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from tisim.bodies import Rod
from tisim.io.picture import across
from tisim.view._quantities import Quantity, curve, frames_shown, label, thinned
from tisim.view._result import rod, towards
from tisim.view._view import REST, Field, Surface, View

_MANIFEST = "provenance/manifest.json"
_NEEDED = (
    *("done", "frame_start", "frame_count", "node_start", "triangle_start", "value_start"),
    *("rod_tip", "surface_displacement"),
)


def view_of_poke(path: Path, index: int | None) -> View:
    """View of one poke of the store at a path, by default of the first that was simulated."""
    import zarr
    import zarr.storage

    try:
        zipped = path.suffix.lower() == ".zip"
        store: Any = zarr.open_group(zarr.storage.ZipStore(path, mode="r") if zipped else path, mode="r")
        missing = [name for name in _NEEDED if name not in store]
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        said = " ".join(str(error).split())[:120]
        raise ValueError(f"{path}: expected the store of a dataset (Zarr 3) ({said})") from None
    if missing:
        raise ValueError(f"{path}: expected the store of a dataset, it has no {', '.join(missing)}")
    lost = _lost(path)
    if lost:  # Zarr would read it as zeros: a body that does not move
        raise ValueError(f"{path}: {lost[0]} is missing, which its manifest lists")
    done = np.flatnonzero(store["done"][:] & (store["frame_count"][:] > 0))
    if index is None and len(done):
        index = int(done[0])
    if index is None or index not in done:
        asked = "" if index is None else f", {index} is none"
        raise ValueError(
            f"{path}: --poke: expected one that was simulated, of {store['done'].shape[0]}{asked}"
        )
    try:
        return _view(path, store, index)
    except Exception as error:  # of any layer below: codec, zip, shapes, attributes
        said = " ".join(str(error).split())[:120]
        raise ValueError(f"{path}: poke {index} cannot be read ({type(error).__name__}: {said})") from None


def _lost(path: Path) -> list[str]:
    """Files of a store's manifest that it lacks; none without one, as other programs may write it."""
    try:
        root: Any = path if path.is_dir() else zipfile.Path(path)
        if not (root / _MANIFEST).is_file():
            return []
        listed = json.loads((root / _MANIFEST).read_text(encoding="utf-8"))["sha256"]
        there = None if path.is_dir() else set(root.root.namelist())
        return [n for n in listed if not ((path / n).is_file() if there is None else n in there)]
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        said = " ".join(str(error).split())[:120]
        raise ValueError(f"{path}: {_MANIFEST} cannot be read ({type(error).__name__}: {said})") from None


def _view(path: Path, store: Any, index: int) -> View:
    def rows(count: str) -> slice:
        start = int(store[f"{count}_start"][index])
        return slice(start, start + int(store[f"{count}_count"][index]))

    frames = rows("frame")
    total = frames.stop - frames.start
    kept = frames_shown(total)
    rest = np.asarray(store["surface_rest"][rows("node")], dtype=float)
    moved = np.asarray(store["surface_displacement"][rows("value")], dtype=float).reshape(total, -1, 3)[kept]
    triangles = np.asarray(store["surface_triangle"][rows("triangle")], dtype=np.int32)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    size = 1e3 * np.linalg.norm(moved, axis=2)
    body = Surface(
        positions=rest + moved,
        triangles=triangles,
        edges=np.unique(edges, axis=0),
        fields=(
            Field(name="displacement", unit="mm", values=size),
            Field(name="displacement upwards", unit="mm", values=1e3 * moved[:, :, 2]),
        ),
    )
    tips, axes = (np.asarray(store[name][frames], dtype=float)[kept] for name in ("rod_tip", "rod_axis"))
    stated = store.attrs["identity"]["recipe"]["rod"]
    tip = stated.get("tip", "flat")
    edge = stated["radius_mm"] if tip == "hemisphere" else stated["edge_radius_mm"]
    shape = Rod(
        radius=1e-3 * stated["radius_mm"],
        length=1e-3 * stated.get("length_mm", 40.0),
        edge_radius=1e-3 * edge,
    )
    depths = 1e3 * np.asarray(store["depth"][frames], dtype=float)[kept]
    forces = np.linalg.norm(np.asarray(store["rod_force"][frames], dtype=float)[kept], axis=1)
    places: list[list[Quantity]] = [[("depth", float(d), "mm")] for d in depths]
    if "time" in store:
        for quantities, time in zip(places, store["time"][frames][kept], strict=True):
            quantities.append(("time", float(time), "s"))
    pushed: list[Quantity] = [("force on the rod", float(f), "N") for f in forces]
    sideways = across(tuple(axes[0]))
    shape_name = store.attrs["shapes"][int(store["poke_shape"][index])]
    level = store.attrs["softness"][int(store["poke_softness"][index])]
    return View(
        title=f"{path.name}: poke {index}, inclusion {shape_name}, material {level}",
        labels=tuple(label([*quantities, force]) for quantities, force in zip(places, pushed, strict=True)),
        surfaces=(
            body,
            Surface(positions=rest[None], triangles=triangles, colour=REST, rest=True),
            rod(shape, tips, axes),
        ),
        curve=curve([quantities[0] for quantities in places], pushed),
        towards=towards(sideways, steep=True),
        notes=(*thinned(total), "A store holds the surface: stress and strain take a simulation."),
    )
