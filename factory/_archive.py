"""One Zarr zip of a finished store: stored files in the order of their names, so that a store has one zip.

The shards are compressed already: they lie in the zip as they are, and are read from it without unpacking.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from factory._errors import InputError, one_line
from factory._staging import sync_folder
from factory._store import LEDGER, MANIFEST, DamagedError, file_faults, manifest_faults, plain_files

_DATE = (1980, 1, 1, 0, 0, 0)  # the first that a zip can state
_MODE = 0o100644 << 16  # a plain file that everybody may read
_BIG = 2**31 - 1  # bytes, from which on an entry has the 64-bit fields
_BLOCK = 1 << 20


@dataclass(frozen=True)
class Released:
    """A zip that was written and compared.

    Attributes
    ----------
    path, sums : Path
        The zip, and the file with its checksum beside it.
    sha256 : str
    files, size : int
        How many files it holds, and its bytes.
    """

    path: Path
    sums: Path
    sha256: str
    files: int
    size: int


def release_store(store: Path, target: Path) -> Released:
    """Write one zip of a store with its checksum beside it; the same store gives the same bytes.

    It is written under another name, opened again and compared with the store's manifest, and only then gets
    its own name: a run that was killed leaves no file that looks complete, and the next one begins anew.

    Raises
    ------
    InputError
        Where the target cannot be written or is there already; DamagedError where the store is not as its
        manifest says. Nothing is left then.
    """
    check_release(store, target)
    check_sound(store)
    sums = sums_file(target)
    partial, noted = (path.with_name(f".{path.name}.partial") for path in (target, sums))
    try:
        _write(store, partial)
        faults = zip_faults(partial)
        if not faults:
            faults = _other_outside(store, partial)
        if faults:
            raise DamagedError(f"{target}: the zip is not as the store ({faults[0]}): is the disk sound?")
        sha256 = _sha256(partial)
        line = f"{sha256}  {target.name}\n"
        if sums.exists() and sums.read_text(encoding="utf-8", errors="replace") != line:
            raise InputError(f"{sums}: exists and states another sum: remove it, or give another --out")
        noted.write_text(line, encoding="utf-8")
        noted.replace(sums)  # first: a zip that has its name has its checksum
        size = partial.stat().st_size
        with zipfile.ZipFile(partial) as archive:
            count = len(archive.namelist())
        partial.replace(target)
        sync_folder(target.parent)
    finally:
        for path in (partial, noted):
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)
    return Released(target, sums, sha256, count, size)


def sums_file(target: Path) -> Path:
    """Path of the checksum of a zip, in the format of `sha256sum -c`."""
    return target.with_name(f"{target.name}.sha256")


def check_release(store: Path, target: Path) -> None:
    """Refuse a target that is there, is no zip by name, lies in the store, or in no folder."""
    if not target.name.endswith(".zarr.zip"):
        raise InputError(f"--out {target}: expected a name that ends in .zarr.zip")
    if target.exists() or target.is_symlink():
        raise InputError(f"{target}: exists already: remove it, or give another --out")
    if target.resolve().is_relative_to(store.resolve()):
        raise InputError(f"--out {target}: lies in the store, which would change it: give another --out")
    if not target.parent.is_dir():
        raise InputError(f"--out {target}: expected a folder that exists, got {target.parent}")


def check_sound(store: Path) -> None:
    """DamagedError where a store holds anything else than its manifest says."""
    faults = [*file_faults(store), *manifest_faults(store)]
    if faults:
        more = f" and {len(faults) - 1} more faults" if len(faults) > 1 else ""
        raise DamagedError(f"{store}: the dataset is damaged: {faults[0]}{more}")


def _write(store: Path, path: Path) -> None:
    with path.open("wb") as handle:
        with zipfile.ZipFile(handle, "w", zipfile.ZIP_STORED, strict_timestamps=True) as archive:
            for name, source, _ in plain_files(store):
                entry = zipfile.ZipInfo(name, _DATE)
                entry.create_system, entry.external_attr = 3, _MODE  # the same on every system
                big = source.stat().st_size > _BIG
                with source.open("rb") as file, archive.open(entry, "w", force_zip64=big) as out:
                    shutil.copyfileobj(file, out, _BLOCK)
        handle.flush()
        os.fsync(handle.fileno())


def zip_faults(path: Path) -> list[str]:
    """Differences of a zip from its own manifest, one sentence a file."""
    try:
        with zipfile.ZipFile(path) as archive:
            return list(_faults(archive))
    except (OSError, zipfile.BadZipFile, NotImplementedError) as error:
        return [f"cannot be read as a zip ({one_line(error)})"]


def _faults(archive: zipfile.ZipFile) -> Iterator[str]:
    names = [name for name in archive.namelist() if not name.endswith("/")]
    yield from (f"{name}: is twice in the zip" for name in sorted({n for n in names if names.count(n) > 1}))
    try:
        content = json.loads(archive.read(MANIFEST))
    except (KeyError, ValueError, RecursionError, zipfile.BadZipFile):
        content = None
    expected = content.get("sha256") if isinstance(content, dict) else None
    if not isinstance(expected, dict):
        yield f"{MANIFEST}: missing or damaged"
        return
    found = set(names) - {MANIFEST, LEDGER}
    yield from (f"{name}: missing" for name in sorted(set(expected) - found))
    yield from (f"{name}: not in the manifest" for name in sorted(found - set(expected)))
    for name in sorted(found & set(expected)):
        try:
            with archive.open(name) as file:
                same = hashlib.file_digest(file, "sha256").hexdigest() == expected[name]  # type: ignore[arg-type]
        except zipfile.BadZipFile:
            same = False
        if not same:
            yield f"{name}: sha256 differs from the manifest"


def _other_outside(store: Path, path: Path) -> list[str]:
    """Manifest and ledger, which no manifest lists, where they differ from the store's."""
    with zipfile.ZipFile(path) as archive:
        there = set(archive.namelist())
        return [
            f"{name}: differs from the store's"
            for name in (MANIFEST, LEDGER)
            if (store / name).exists() != (name in there)
            or (name in there and archive.read(name) != (store / name).read_bytes())
        ]


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
