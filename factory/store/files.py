"""The files of a finished store: attributes of its root, its ledger, and a manifest with sha256 of the rest.

Nothing here decodes an array, and nothing follows a link.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import stat
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from factory.errors import InputError, describe_os_error
from factory.strict_yaml import validation_sentence

PROVENANCE = "provenance"  # a Zarr group, so that its files do not disturb a listing of the arrays
MANIFEST = f"{PROVENANCE}/manifest.json"
LEDGER = f"{PROVENANCE}/ledger.jsonl"
_OUTSIDE = {MANIFEST, LEDGER}  # the ledger holds wall times: no two runs agree on them


class DamagedError(InputError):
    """The files of a dataset are damaged."""


_Side = Annotated[float, Field(gt=0)]
_TWO, _THREE = (Field(min_length=count, max_length=count) for count in (2, 3))


class _Lenient(BaseModel):
    model_config = ConfigDict(extra="allow", strict=True, allow_inf_nan=False)


class _Rod(_Lenient):
    radius_mm: float = Field(gt=0)
    edge_radius_mm: float = Field(gt=0)
    tip: str


class _Protocol(_Lenient):
    frame_spacing_mm: float = Field(gt=0)
    shared_sites: int = Field(ge=0)
    own_sites: int = Field(ge=0)
    course: list[dict[str, Any]] = Field(default_factory=list)


class _Shape(_Lenient):
    id: str
    block_mm: Annotated[list[_Side], _THREE] | None = None


class _Recipe(_Lenient):
    name: str
    block_mm: Annotated[list[_Side | Annotated[list[_Side], _TWO]], _THREE]
    rod: _Rod
    protocol: _Protocol
    softness: list[str]
    shapes: list[_Shape]

    @model_validator(mode="after")
    def _in_blocks(self) -> Self:
        stated = [shape.block_mm is not None for shape in self.shapes]
        if any(stated) != all(stated) or not (
            any(stated) or all(isinstance(s, float) for s in self.block_mm)
        ):
            raise ValueError("block_mm: expected three sides, or a block of each shape")
        return self


class _Identity(_Lenient):
    model: str
    recipe: _Recipe


class _Attributes(_Lenient):
    """Root attributes that readers of a store require."""

    format: int
    uuid: str
    fingerprint: str
    model: str
    pokes: int = Field(ge=1)
    pokes_done: int = Field(ge=0)
    shapes: list[str] = Field(min_length=1)
    softness: list[str] = Field(min_length=1)
    parameter_names: list[str]
    solver_tolerance: float = Field(gt=0)
    identity: _Identity


def is_store(path: Path | zipfile.Path) -> bool:
    """True if `path` is a dataset of the factory, even a damaged one."""
    attributes = _raw_attributes(path)
    return (attributes is not None and "fingerprint" in attributes) or (path / MANIFEST).is_file()


def root_attributes(store: Path | zipfile.Path) -> dict[str, Any] | None:
    """Attributes of the store's root group; None if this is not a store.

    Raises
    ------
    DamagedError
        If the attributes of a store are missing or invalid; the message names the key.
    """
    if not is_store(store):
        return None
    attributes = _raw_attributes(store)
    file = store / "zarr.json"
    if attributes is None:
        raise DamagedError(f"{file}: expected the attributes of the dataset: the file is missing or damaged")
    try:
        _Attributes.model_validate(attributes)
    except ValidationError as error:
        raise DamagedError(f"{file}: attributes: {validation_sentence(error)}") from None
    return attributes


def check_identity(identity: object, where: Path) -> dict[str, Any]:
    """Validate the identity of a plan read from a file; DamagedError names an invalid key."""
    try:
        _Identity.model_validate(identity)
    except ValidationError as error:
        raise DamagedError(f"{where}: {validation_sentence(error)}") from None
    assert isinstance(identity, dict)
    return identity


def read_json(path: Path | zipfile.Path) -> object:
    """Content of a JSON file; ValueError if it is damaged, OSError if it cannot be read."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except RecursionError:
        raise ValueError("nested too deep") from None


def _raw_attributes(store: Path | zipfile.Path) -> dict[str, Any] | None:
    try:
        metadata = read_json(store / "zarr.json")
    except (OSError, ValueError):
        return None
    attributes = metadata.get("attributes") if isinstance(metadata, dict) else None
    return attributes if isinstance(attributes, dict) else None


def read_ledger(path: Path | zipfile.Path) -> dict[int, dict[str, Any]]:
    """Last valid line of each poke: index, wall_seconds, core_seconds and error text.

    Invalid lines, e.g. truncated by a crash, are skipped; an unreadable ledger counts as empty.
    """
    lines: dict[int, dict[str, Any]] = {}
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except (OSError, zipfile.BadZipFile):
        return lines
    for line in text.splitlines():
        with contextlib.suppress(ValueError, RecursionError):
            entry = json.loads(line)
            if _is_sound(entry):
                lines[entry["poke"]] = entry
    return lines


def _is_sound(entry: object) -> bool:
    if not isinstance(entry, dict) or type(entry.get("poke")) is not int:
        return False
    walls = [entry.get("wall_seconds"), entry.get("core_seconds", 0.0)]
    numbers = all(type(v) in (int, float) and math.isfinite(v) and v >= 0 for v in walls)
    return numbers and isinstance(entry.get("error"), str | None)


def plain_files(folder: Path) -> Iterator[tuple[str, Path, bool]]:
    """Yield name, path and whether it is a regular file, for everything but folders, sorted by name.

    Links, pipes and devices are listed with False, and never followed or opened.
    """
    found: list[tuple[str, Path, bool]] = []
    for root, folders, files in os.walk(folder, followlinks=False):
        inner = Path(root).relative_to(folder).as_posix()
        before = "" if inner == "." else f"{inner}/"
        for name in (*folders, *files):
            path = os.path.join(root, name)  # noqa: PTH118 - a store has hundreds of files, and a Path is slow
            mode = os.lstat(path).st_mode
            if not stat.S_ISDIR(mode):
                found.append((before + name, Path(path), stat.S_ISREG(mode)))
    yield from sorted(found)


def write_manifest(folder: Path) -> None:
    """Write provenance/manifest.json: {"sha256": {file: digest}}."""
    text = json.dumps({"sha256": _sums(folder)}, indent=1, sort_keys=True) + "\n"
    (folder / MANIFEST).write_text(text, encoding="utf-8")


def file_faults(folder: Path) -> list[str]:
    """Links, pipes and devices in a store, one sentence each."""
    return [
        f"{name}: is {'a symbolic link' if path.is_symlink() else 'no plain file'}, which no dataset contains"
        for name, path, sound in plain_files(folder)
        if not sound
    ]


def manifest_faults(folder: Path) -> list[str]:
    """Differences between the store's files and its manifest, one sentence each."""
    path = folder / MANIFEST
    try:
        if path.is_symlink() or not path.is_file():
            return [f"{MANIFEST}: missing or no plain file"]
        content = read_json(path)
    except OSError as error:
        return [describe_os_error(error, f"{MANIFEST}: cannot be read")]
    except ValueError:
        return [f"{MANIFEST}: is not valid JSON"]
    expected = content.get("sha256") if isinstance(content, dict) else None
    if not isinstance(expected, dict):
        return [f'{MANIFEST}: expected {{"sha256": {{file: digest}}}}']
    outside = sorted(name for name in expected if not _stays_inside(name))
    faults = [f"{MANIFEST}: names {name!r}, which is not inside of the dataset" for name in outside]
    found = _sums(folder)
    listed = set(expected) - set(outside)
    faults += [f"{name}: missing" for name in sorted(listed - set(found))]
    faults += [f"{name}: not in the manifest" for name in sorted(set(found) - listed)]
    faults += [
        f"{name}: sha256 differs from the manifest"
        for name in sorted(listed & set(found))
        if expected[name] != found[name]
    ]
    return faults


def missing_files(store: Path | zipfile.Path) -> list[str]:
    """Files of the manifest that the store lacks; none if the manifest cannot be read."""
    listed = _listed(store) or {}
    if isinstance(store, zipfile.Path):
        found = set(store.root.namelist())
    else:
        found = {name for name, _, _ in plain_files(store)}
    return sorted(name for name in listed if name not in found)


def altered_files(store: Path | zipfile.Path, arrays: Mapping[str, range | None]) -> list[str]:
    """Files whose sha256 is not the manifest's: of these arrays, and the root's metadata.

    Parameters
    ----------
    store : Path or zipfile.Path
    arrays : mapping of str to range or None
        Numbers of the shards along the first dimension to look at; None for all.

    Raises
    ------
    DamagedError
        If the manifest cannot be read.
    """
    listed = _listed(store)
    if listed is None:
        raise DamagedError(f"{store / MANIFEST}: missing or damaged, the dataset cannot be checked")
    mine = (name for name in sorted(listed) if _holds(name, arrays) and _stays_inside(name))
    return [name for name in mine if _sha256(store / name) != listed[name]]


def _holds(name: str, arrays: Mapping[str, range | None]) -> bool:
    """True for metadata and those shards of the arrays; Zarr names a shard ARRAY/c/I/J/..."""
    array, _, rest = name.partition("/")
    if not rest or array not in arrays:
        return name == "zarr.json"
    shards, parts = arrays[array], rest.split("/")
    return shards is None or parts[0] != "c" or not parts[1].isdecimal() or int(parts[1]) in shards


def manifest_digest(store: Path) -> str:
    """sha256 of a store's manifest, which stands for all of its files; "" without one."""
    return _sha256(store / MANIFEST) or ""


def _listed(store: Path | zipfile.Path) -> dict[str, object] | None:
    """Digests of the manifest by file; None if it cannot be read."""
    try:
        content = read_json(store / MANIFEST)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        return None
    listed = content.get("sha256") if isinstance(content, dict) else None
    return listed if isinstance(listed, dict) else None


def _sha256(path: Path | zipfile.Path) -> str | None:
    """Digest of a file; None if there is none, or a zip's entry is damaged."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()  # type: ignore[arg-type]
    except (FileNotFoundError, zipfile.BadZipFile):
        return None


def _stays_inside(name: str) -> bool:
    path = PurePosixPath(name)
    plain = bool(name) and "\\" not in name and "\0" not in name and path.as_posix() == name
    return plain and not path.is_absolute() and ".." not in path.parts


def _sums(folder: Path) -> dict[str, str]:
    sums = {}
    for name, path, sound in plain_files(folder):
        if sound and name not in _OUTSIDE:
            with path.open("rb") as file:
                sums[name] = hashlib.file_digest(file, "sha256").hexdigest()
    return sums
