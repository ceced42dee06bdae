"""Assemble the Zarr store from staged results: one process writes whole shards in the order of the plan.

The bytes depend on the plan alone, not on time, the number of workers or the order in which pokes finished.
"""

from __future__ import annotations

import json
import os
import shutil
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import zarr
import zarr.codecs
from numpy.typing import NDArray

from factory.materials.parts import part_entries
from factory.plan.dataset import FORMAT, Plan
from factory.plan.shared_solves import scale_with_modulus
from factory.recipe.course import deepest
from factory.sampling import LEVELS, SIZE, codes, grid_points, inside, level_depths
from factory.simulation.record import COUNTERS, unit
from factory.store.files import PROVENANCE, read_ledger, write_manifest
from factory.store.schema import (
    FIRST_DIMENSION,
    FIXED_DIMENSION,
    MESSAGE_BYTES,
    NOT_SIMULATED,
    STORED_KINDS,
    STORED_LAWS,
    Rows,
    Spec,
    flags,
    specs_of,
)
from factory.store.staging import DamagedResultError, Staging, sync_folder
from tisim import Inclusion, laws

_RAGGED: dict[Rows, str] = {"frame": "depth", "node": "surface_rest", "triangle": "surface_triangle"}


def assemble(plan: Plan, staging: Staging, target: Path) -> None:
    """Write the store in the building folder, then move it to the target; can be repeated after any kill.

    Raises
    ------
    DamagedResultError
        If a staged result cannot be read; the target is then unchanged.
    """
    shutil.rmtree(staging.store, ignore_errors=True)
    try:
        _write(plan, staging, staging.store)
        _sync_tree(staging.store)
    except BaseException:
        shutil.rmtree(staging.store, ignore_errors=True)  # a full disk needs the room
        raise
    old = staging.folder / "old"
    shutil.rmtree(old, ignore_errors=True)
    if target.exists():
        target.rename(old)
    staging.store.rename(target)
    sync_folder(target.parent)
    shutil.rmtree(old, ignore_errors=True)


def _write(plan: Plan, staging: Staging, folder: Path) -> None:
    done, errors = staging.finished(), staging.errors()
    specs = _specs(plan)
    small = _poke_arrays(plan, staging, done, errors)
    totals: dict[Rows, int] = {
        "poke": len(plan.pokes),
        "geometry": len(plan.inclusions) * len(plan.materials),
        **{kind: int(small[f"{kind}_count"].sum()) for kind in ("frame", "node", "triangle", "value")},
    }
    group = zarr.create_group(store=folder, zarr_format=3, attributes=_attributes(plan, done))
    fixed = {**small, **_block_arrays(plan, specs), **_geometry_arrays(plan)}
    streams: dict[str, _Appender] = {}
    for name, spec in specs.items():
        if name in fixed:
            array = _create(group, name, spec, fixed[name].shape)
            array[...] = fixed[name]
        else:
            array = _create(group, name, spec, (totals[spec.rows], *spec.row))
            streams[name] = _Appender(array, spec)
    for poke in plan.pokes:
        if poke.index not in done:
            continue
        with staging.opened(poke.index) as result:
            frames = len(result["depth"])
            derived: dict[str, NDArray[Any]] = {
                "frame_poke": np.full(frames, poke.index, dtype=np.int32),
                "rod_axis": np.tile(unit(poke.scene.direction), (frames, 1)),
            }
            for name, stream in streams.items():
                rows = derived[name] if name in derived else result[name]
                try:
                    stream.append(rows.reshape(-1, *specs[name].row))
                except ValueError as error:  # rows of another shape: the result changed since its check
                    raise DamagedResultError(poke.index, f"array {name}: {error}") from None
    for stream in streams.values():
        stream.finish()
    zarr.create_group(store=folder, path=PROVENANCE, zarr_format=3)
    with warnings.catch_warnings():
        # consolidated metadata is an extension of Zarr 3; without it plain xarray.open_zarr warns
        warnings.simplefilter("ignore")
        zarr.consolidate_metadata(folder, zarr_format=3)
    _provenance(staging, folder)
    write_manifest(folder)


def stored_laws(law: str) -> tuple[str, ...]:
    """Names behind the codes of the array `law`: `STORED_LAWS`, then `law` if it is not one of these."""
    return STORED_LAWS if law in STORED_LAWS else (*STORED_LAWS, law)


def _stored_kinds(plan: Plan) -> tuple[str, ...]:
    """Names behind the codes of `inclusion_kind`: `STORED_KINDS`, then any other kinds of the plan."""
    return tuple(dict.fromkeys((*STORED_KINDS, *(inclusion.kind for inclusion in plan.inclusions))))


def _specs(plan: Plan) -> dict[str, Spec]:
    """Specifications of the store's arrays, with codes for the plan's own laws and inclusion kinds."""
    specs = specs_of(plan.identity)
    return {
        **specs,
        "law": replace(specs["law"], attributes=flags(stored_laws(plan.law))),
        "inclusion_kind": replace(specs["inclusion_kind"], attributes=flags(_stored_kinds(plan))),
    }


class _Appender:
    """Buffer of rows that writes whole shards, each once."""

    def __init__(self, array: Any, spec: Spec) -> None:
        self._array, self._shard = array, spec.shard
        self._rows: list[NDArray[Any]] = []
        self._held = 0
        self._written = 0

    def append(self, rows: NDArray[Any]) -> None:
        while self._held + len(rows) >= self._shard:
            room = self._shard - self._held
            self._rows.append(rows[:room])
            self._flush()
            rows = rows[room:]
        if len(rows):
            self._rows.append(rows)
            self._held += len(rows)

    def finish(self) -> None:
        if self._rows:
            self._flush()
        if self._written != self._array.shape[0]:
            raise ValueError(f"{self._array.path}: {self._written} rows of {self._array.shape[0]} came")

    def _flush(self) -> None:
        block = np.concatenate(self._rows)
        self._array[self._written : self._written + len(block)] = block
        self._written += len(block)
        self._rows, self._held = [], 0


def _create(group: zarr.Group, name: str, spec: Spec, shape: tuple[int, ...]) -> Any:
    first = FIXED_DIMENSION[name] if spec.rows == "fixed" else FIRST_DIMENSION[spec.rows]
    attributes = {"long_name": spec.text, **({"units": spec.units} if spec.units else {}), **spec.attributes}
    chunks = (spec.chunk, *shape[1:])
    return group.create_array(
        name,
        shape=shape,
        dtype=spec.dtype,
        chunks=chunks,
        shards=(spec.shard, *shape[1:]) if spec.shard > spec.chunk else None,
        compressors=compressor(np.dtype(spec.dtype)),
        fill_value=0,
        dimension_names=(first, *spec.dims),
        attributes=attributes,
    )


def compressor(dtype: np.dtype[Any]) -> zarr.codecs.BloscCodec:
    """Blosc with lz4, which reads faster than zstd for 2 % more bytes.

    Streaming for training reaches a third of the rate of a memmap (benchmarks/loader_throughput.py); other
    codecs are compared in benchmarks/store_layout.py.
    """
    return zarr.codecs.BloscCodec(
        cname="lz4",
        clevel=3,
        shuffle="shuffle",
        typesize=dtype.itemsize,
    )


def _attributes(plan: Plan, done: set[int]) -> dict[str, Any]:
    recipe = plan.recipe
    return {
        "title": f"Simulated pokes: recipe {recipe.name}, {plan.law}",
        "format": FORMAT,
        "uuid": plan.uuid,
        "fingerprint": plan.fingerprint,
        "model": plan.law,
        "seed": recipe.seed,
        "pokes": len(plan.pokes),
        "pokes_done": len(done),
        "shapes": [shape.id for shape in recipe.shapes],
        "softness": list(recipe.levels),
        "parameter_names": list(_parameter_columns(plan)),
        "scales_with_modulus": scale_with_modulus([poke.scene for poke in plan.pokes]),
        "solver_tolerance": plan.pokes[0].scene.solver.tolerance,
        "identity": plan.identity,
        **_described(plan),
    }


def _described(plan: Plan) -> dict[str, Any]:
    """Further attributes: moduli of a law and fields of inclusions outside the format; material parts."""
    found: dict[str, Any] = {}
    if plan.law not in STORED_LAWS:
        moduli = [laws.get(m.law).moduli(m.parameters) for m in plan.materials]
        found["shear_modulus"] = [m.shear_modulus for m in moduli]
        found["bulk_modulus"] = [m.bulk_modulus for m in moduli]
    parts = [part_entries(material) for material in plan.materials]
    if any(parts):
        found["parts"] = parts
    if any(inclusion.kind not in STORED_KINDS for inclusion in plan.inclusions):
        found["inclusions"] = [inclusion.encode() for inclusion in plan.inclusions]
    return found


def _parameter_columns(plan: Plan) -> dict[str, NDArray[np.float64]]:
    """Values of each column of `parameter` by material level, in the order of the law's definition.

    A series has as many columns as the longest of all levels; beyond a level's own terms they are 0.
    """
    columns: dict[str, NDArray[np.float64]] = {}
    for key, (_, shape) in laws.get(plan.law).parameters.items():
        rows = [np.atleast_1d(np.asarray(m.parameters[key], dtype=float)) for m in plan.materials]
        for term in range(max(len(row) for row in rows)):
            name = f"{key}_{term + 1}" if shape == "series" else key
            columns[name] = np.array([row[term] if term < len(row) else 0.0 for row in rows])
    return columns


def _poke_arrays(
    plan: Plan, staging: Staging, done: set[int], errors: dict[int, str]
) -> dict[str, NDArray[Any]]:
    """Arrays with one row per poke."""
    n = len(plan.pokes)
    pieces = (len(plan.recipe.protocol.course),)
    parameters = np.column_stack(list(_parameter_columns(plan).values()))
    widths = {
        "parameter": parameters.shape[1:],
        "course_time": pieces,
        "course_depth": pieces,
    }
    arrays: dict[str, NDArray[Any]] = {}
    for name, spec in specs_of(plan.identity).items():
        if spec.rows == "poke":
            row = widths.get(name, spec.row)
            arrays[name] = np.zeros((n, *row), dtype=spec.dtype)
    for poke in plan.pokes:
        i, scene = poke.index, poke.scene
        arrays["poke_shape"][i] = poke.shape
        arrays["poke_softness"][i] = poke.level
        arrays["poke_geometry"][i] = poke.geometry
        arrays["law"][i] = stored_laws(plan.law).index(plan.law)
        arrays["parameter"][i] = parameters[poke.level]
        arrays["site_shared"][i] = poke.shared
        arrays["site_number"][i] = poke.site
        arrays["seed"][i] = poke.seed
        arrays["site"][i] = scene.site
        arrays["direction"][i] = unit(scene.direction)
        arrays["depth_asked"][i] = deepest(scene)
        if "solved_as" in arrays:
            arrays["solved_as"][i] = poke.solved_as if poke.derived else i
            arrays["force_factor"][i] = poke.force_factor
        if scene.course is not None:
            arrays["course_time"][i], arrays["course_depth"][i] = scene.course.times, scene.course.values
        text = errors.get(i, NOT_SIMULATED).encode()
        if i in done:
            with staging.opened(i) as result:
                arrays["done"][i] = True
                text = result["message"].tobytes()
                for name in ("status", "path_start", "path_end", "mesh_nodes", "mesh_elements"):
                    arrays[name][i] = result[name]
                for name, value in zip(COUNTERS, result["counters"], strict=True):
                    arrays[name][i] = value
                for kind, source in _RAGGED.items():
                    arrays[f"{kind}_count"][i] = len(result[source])
        arrays["message"][i, : min(len(text), MESSAGE_BYTES)] = np.frombuffer(text[:MESSAGE_BYTES], np.uint8)
    arrays["value_count"] = arrays["frame_count"] * arrays["node_count"]
    for kind in ("frame", "node", "triangle", "value"):
        count = arrays[f"{kind}_count"]
        arrays[f"{kind}_start"] = np.cumsum(count) - count
    return arrays


def _block_arrays(plan: Plan, specs: Mapping[str, Spec]) -> dict[str, NDArray[Any]]:
    """Grid and levels of the block of each geometry, or of the one block of all."""
    arrays = {
        "grid_rest": np.array([grid_points(block) for block in plan.blocks]),
        "level_depth": np.array([level_depths(block[2]) for block in plan.blocks]),
    }
    one = {name for name, spec in specs.items() if spec.rows == "fixed"}
    return {name: rows[0] if name in one else rows for name, rows in arrays.items()}


def _geometry_arrays(plan: Plan) -> dict[str, NDArray[Any]]:
    silicones = [card.stiffness for card in plan.cards]
    levels = np.zeros((len(plan.inclusions), len(silicones), SIZE, SIZE, LEVELS), dtype=np.uint8)
    blocks = plan.blocks[:: len(silicones)]
    for row, (block, inclusion) in enumerate(zip(blocks, plan.inclusions, strict=True)):
        rigid = inside(grid_points(block), block[2], inclusion)  # once for all silicones
        levels[row] = [codes(rigid, stiffness) for stiffness in silicones]
    kinds = _stored_kinds(plan)
    bodies = [inclusion for inclusion in plan.inclusions for _ in silicones]
    return {
        "profile": levels.reshape(-1, *levels.shape[2:]),
        "inclusion_kind": np.array([kinds.index(body.kind) for body in bodies], dtype=np.uint8),
        "inclusion_size": np.array([_three(body.dimensions) for body in bodies]),
        "inclusion_angle": np.array([_angle(body) for body in bodies]),
        "inclusion_centre": np.array([body.centre for body in bodies]),
    }


def _three(dimensions: tuple[float, ...]) -> tuple[float, ...]:
    """First three dimensions, padded with zeros; the attribute `inclusions` holds shapes that have more."""
    return (*dimensions, 0.0, 0.0, 0.0)[:3]


def _angle(inclusion: Inclusion) -> float:
    return float(getattr(inclusion, inclusion.angles[0])) if inclusion.angles else 0.0


def _provenance(staging: Staging, folder: Path) -> None:
    """Write wall times to a separate file: they differ from run to run, the arrays must not."""
    ledger = read_ledger(staging.ledger_file)
    text = "".join(json.dumps(ledger[i]) + "\n" for i in sorted(ledger))
    (folder / PROVENANCE / "ledger.jsonl").write_text(text, encoding="utf-8")


def _sync_tree(folder: Path) -> None:
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            handle = os.open(path, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)
        else:
            sync_folder(path)
    sync_folder(folder)
