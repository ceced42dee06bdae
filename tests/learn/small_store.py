"""Small stores in the dataset's file format, written without the factory, with an analytical field.

The field is smooth, equivariant under rotations of the scene, and depends on the interior: it is scaled by
sqrt(0.5) over an inclusion. The force is proportional to the modulus.
"""

from __future__ import annotations

import functools
import hashlib
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import zarr
import zarr.codecs

HEIGHT, SIDE, RADIUS = 0.032, 0.1, 2.5e-3
MODULI = {"S0": 30e3, "S0.5": 15e3, "S1": 9e3}
CODES = {"S0": 204, "S0.5": 102, "S1": 0}


def grid(size: tuple[float, float, float] = (SIDE, SIDE, HEIGHT)) -> np.ndarray[Any, np.dtype[np.float64]]:
    cells = (np.arange(32) + 0.5) / 32 - 0.5
    yy, xx = np.meshgrid(cells * size[1], cells * size[0], indexing="ij")
    return np.stack([xx, yy, np.full_like(xx, size[2])], axis=-1)


def field(
    points: np.ndarray[Any, Any],
    start: np.ndarray[Any, Any],
    direction: np.ndarray[Any, Any],
    depth: float,
    soft: np.ndarray[Any, Any],
) -> np.ndarray[Any, Any]:
    """Displacement (n, 3) at points (n, 3); `soft` (n,) is 1, and smaller over an inclusion."""
    r = points - start
    rho = np.sqrt((r**2).sum(axis=1) + RADIUS**2)
    fall = (RADIUS / rho) * np.exp(-rho / 0.02) * np.sqrt(soft)
    return depth * fall[:, None] * (direction + 0.3 * (1 + 20 * depth) * r / rho[:, None])


def write_store(
    folder: Path,
    *,
    shapes: int = 3,
    softness: tuple[str, ...] = ("S0", "S1"),
    sites: int = 2,
    frames: int = 4,
    chunk: int = 4,
    shard: int = 8,
    blosc: bool = True,
    seed: int = 0,
    blocks: tuple[tuple[float, float, float], ...] = (),
) -> Path:
    """Write a complete store: `sites` pokes per shape and softness, at contact points shared by levels.

    `blocks`: size of the block of each shape [m]; by default one of 100 x 100 x 32 mm for all.
    """
    whole = _whole_store(shapes, softness, sites, frames, chunk, shard, blosc, seed, blocks)
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in whole.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


@functools.cache
def _whole_store(*arguments: Any) -> dict[str, bytes]:
    """The files of a store, written by zarr once: that takes ten times as long as writing them again."""
    with tempfile.TemporaryDirectory() as place:
        folder = _write_with_zarr(Path(place) / "s.zarr", *arguments)
        files = (path for path in folder.rglob("*") if path.is_file())
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def _write_with_zarr(
    folder: Path,
    shapes: int,
    softness: tuple[str, ...],
    sites: int,
    frames: int,
    chunk: int,
    shard: int,
    blosc: bool,
    seed: int,
    blocks: tuple[tuple[float, float, float], ...],
) -> Path:
    random = np.random.default_rng(seed)
    sizes = blocks or ((SIDE, SIDE, HEIGHT),) * shapes
    grids, levels = [grid(size) for size in sizes], [(np.arange(128) + 0.5) * h / 128 for _, _, h in sizes]
    profile, arrays = [], {name: [] for name in _FRAME + _POKE}
    surface: list[np.ndarray[Any, Any]] = []
    count = 0
    for shape, (xyz, depth_of_level) in enumerate(zip(grids, levels, strict=True)):
        centre = random.uniform(-0.02, 0.02, 2)
        reach = 0.008 + 0.002 * shape
        inside = ((xyz[..., :2] - centre) ** 2).sum(axis=-1) <= reach**2
        rigid = inside[..., None] & (depth_of_level > 0.012 + 0.002 * shape)
        places = [(random.uniform(-0.03, 0.03, 2), random.normal(size=2) * 0.3) for _ in range(sites)]
        for level, name in enumerate(softness):
            profile.append(np.where(rigid, 255, CODES[name]).astype(np.uint8))
            for site, lean in places:
                start = np.array([*site, sizes[shape][2]])
                direction = np.array([*lean, -1.0])
                direction /= np.linalg.norm(direction)
                soft = np.where(inside.reshape(-1), 0.5, 1.0)
                depth = 1e-3 * (1 + np.arange(frames))
                moved = [field(xyz.reshape(-1, 3), start, direction, d, soft) for d in depth]
                size = MODULI[name] * RADIUS * depth * 8 * (1 + 60 * depth) * (2 - soft.mean())
                _append(arrays, start, direction, depth, size, np.array(moved), count, frames, shape, level)
                arrays["poke_geometry"].append(shape * len(softness) + level)
                arrays["parameter"].append([MODULI[name], 20 * MODULI[name]])
                surface.append(xyz.reshape(-1, 3))
                count += 1
    data = {name: np.array(value) for name, value in arrays.items()}
    data["displacement"] = np.concatenate(arrays["displacement"]).astype(np.float32)
    for name in _FRAME[:-1]:
        data[name] = np.concatenate(arrays[name])
    write_arrays(
        folder,
        data,
        np.array(profile),
        np.repeat(grids, len(softness), axis=0) if blocks else grids[0],
        np.repeat(levels, len(softness), axis=0) if blocks else levels[0],
        np.concatenate(surface),
        chunk=chunk,
        shard=shard,
        blosc=blosc,
    )
    group = zarr.open_group(folder, mode="r+")
    rod = {"radius_mm": RADIUS * 1e3, "tip": "flat", "edge_radius_mm": 1.0}
    group.attrs.update(
        format=1, uuid=f"uuid-{seed}-{shapes}", fingerprint=f"f{seed}", model="neo-hookean", pokes=count,
        shapes=[f"shape-{k}" for k in range(shapes)], softness=list(softness),
        parameter_names=["mu", "bulk"], identity={"recipe": {"rod": rod}},
    )  # fmt: skip
    write_manifest(folder)
    return folder


_FRAME = ("frame_poke", "depth", "rod_force", "displacement")
_POKE = (
    "poke_shape",
    "poke_softness",
    "poke_geometry",
    "direction",
    "path_start",
    "frame_count",
    "parameter",
)


def _append(
    arrays: dict[str, list[Any]],
    start: np.ndarray[Any, Any],
    direction: np.ndarray[Any, Any],
    depth: np.ndarray[Any, Any],
    size: np.ndarray[Any, Any],
    moved: np.ndarray[Any, Any],
    poke: int,
    frames: int,
    shape: int,
    level: int,
) -> None:
    arrays["frame_poke"].append(np.full(frames, poke))
    arrays["depth"].append(depth)
    arrays["rod_force"].append(-size[:, None] * direction)
    arrays["displacement"].append(moved)
    arrays["poke_shape"].append(shape)
    arrays["poke_softness"].append(level)
    arrays["direction"].append(direction)
    arrays["path_start"].append(start)
    arrays["frame_count"].append(frames)


def _triangles() -> np.ndarray[Any, Any]:
    a = (np.arange(31)[:, None] * 32 + np.arange(31)).reshape(-1)
    return np.concatenate([np.stack([a, a + 1, a + 33], 1), np.stack([a, a + 33, a + 32], 1)])


def write_arrays(
    folder: Path,
    data: dict[str, np.ndarray[Any, Any]],
    profile: np.ndarray[Any, Any],
    xyz: np.ndarray[Any, Any],
    level_depth: np.ndarray[Any, Any],
    surface: np.ndarray[Any, Any],
    *,
    chunk: int,
    shard: int,
    blosc: bool = True,
) -> None:
    """Write all arrays of the format; the surface nodes of each poke are the grid points."""
    corners = _triangles()
    pokes, frames = len(data["poke_shape"]), data["frame_count"]
    nodes = len(surface) // pokes
    group = zarr.create_group(folder, zarr_format=3)

    def put(
        name: str, value: np.ndarray[Any, Any], dtype: str, units: str | None = None, **more: Any
    ) -> None:
        array = group.create_array(name, data=value.astype(dtype), **more)
        if units:
            array.attrs["units"] = units

    put("grid_rest", xyz, "f8", "m")
    put("level_depth", level_depth, "f8", "m")
    put("profile", profile, "u1", "1")
    put("done", np.ones(pokes), "bool")
    put("status", np.zeros(pokes), "u1")
    put("law", np.zeros(pokes), "u1")
    for name in ("poke_shape", "poke_softness", "poke_geometry"):
        put(name, data[name], "i4")
    put("parameter", data["parameter"], "f8")
    put("direction", data["direction"], "f8", "1")
    put("path_start", data["path_start"], "f8", "m")
    starts = {"frame": frames, "node": np.full(pokes, nodes), "triangle": np.full(pokes, len(corners))}
    starts["value"] = frames * nodes
    for kind, counts in starts.items():
        put(f"{kind}_start", np.cumsum(counts) - counts, "i8")
        put(f"{kind}_count", counts, "i8")
    put("frame_poke", data["frame_poke"], "i4")
    put("depth", data["depth"], "f8", "m")
    put("rod_force", data["rod_force"], "f8", "N")
    moved = data["displacement"].reshape(-1, 32, 32, 3)
    layout: dict[str, Any] = {"chunks": (chunk, 32, 32, 3), "shards": (shard, 32, 32, 3)}
    if blosc:
        layout["compressors"] = zarr.codecs.BloscCodec(cname="zstd", clevel=3, shuffle="shuffle", typesize=4)
    put("grid_displacement", moved, "f4", "m", **layout)
    put("surface_rest", surface, "f8", "m")
    put("surface_triangle", np.tile(corners, (pokes, 1)), "i4")
    put("surface_displacement", moved.reshape(-1, 3), "f4", "m")


def leave_out(folder: Path, pokes: list[int]) -> None:
    """Make pokes of a store ones that were not simulated, as in that of a stopped build: without frames."""
    group = zarr.open_group(folder, mode="r+")

    def values(name: str) -> np.ndarray[Any, Any]:
        return np.asarray(group[name][...])  # type: ignore[index]

    kept = ~np.isin(values("frame_poke"), pokes)
    for name in ("frame_poke", "depth", "rod_force", "grid_displacement"):
        left = values(name)[kept]
        group[name].resize(left.shape)  # type: ignore[union-attr]
        group[name][...] = left  # type: ignore[index]
    counts, done = values("frame_count"), values("done")
    counts[pokes], done[pokes] = 0, False
    for name, value in (("frame_count", counts), ("done", done), ("frame_start", np.cumsum(counts) - counts)):
        group[name][...] = value  # type: ignore[index]
    write_manifest(folder)


def write_manifest(folder: Path) -> None:
    """Write the manifest of the present files' sha256 sums."""
    files = [p for p in sorted(folder.rglob("*")) if p.is_file() and p.name != "manifest.json"]
    sums = {p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}
    (folder / "provenance").mkdir(exist_ok=True)
    (folder / "provenance" / "manifest.json").write_text(json.dumps({"sha256": sums}))
