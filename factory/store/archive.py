"""Write a finished store as one Zarr zip, files in the order of their names: equal stores give equal zips.

The shards are already compressed: the zip stores them as they are, and they are read without unpacking.
"""

from __future__ import annotations

import contextlib
import fcntl
import glob
import hashlib
import json
import os
import shutil
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from factory.errors import InputError, one_line
from factory.store.files import LEDGER, MANIFEST, DamagedError, file_faults, manifest_faults, plain_files
from factory.store.staging import sync_folder, write_atomic
from tisim.io.whole import whole_file, whole_name

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest date of a zip entry
_MODE = 0o100644 << 16  # a regular file, readable by all
_BIG = 2**31 - 1  # bytes, above which an entry has 64-bit fields
_BLOCK = 1 << 20


@dataclass(frozen=True)
class Released:
    """A zip that was written and verified.

    Attributes
    ----------
    path, sums : Path
        The zip, and the file with its checksum beside it.
    sha256 : str
    files, size : int
        Number of files in it, and its size [bytes].
    """

    path: Path
    sums: Path
    sha256: str
    files: int
    size: int


def release_store(store: Path, target: Path) -> Released:
    """Write one zip of a store with its checksum beside it; the same store gives the same bytes.

    It is written under a name drawn for it, reopened and compared with the store's manifest, and only then
    renamed: a killed run leaves no file that looks complete, and the next run starts again.

    Raises
    ------
    InputError
        If the target exists or is refused (`check_release`), or its checksum file states another sum;
        DamagedError if the store or the zip differs from the manifest. No zip is left then.
    """
    check_release(store, target)
    check_sound(store)
    sums = sums_file(target)
    _remove_parts(target)
    with whole_file(target) as part, part.open("xb") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        _write(store, handle)
        faults = zip_faults(part)
        if not faults:
            faults = _other_outside(store, part)
        if faults:
            raise DamagedError(f"{target}: the zip is not as the store ({faults[0]}): is the disk sound?")
        sha256 = _sha256(part)
        line = f"{sha256}  {target.name}\n"
        if sums.exists() and sums.read_text(encoding="utf-8", errors="replace") != line:
            raise InputError(f"{sums}: exists and states another sum: remove it, or give another --out")
        write_atomic(sums, line.encode())  # before the zip, so that a complete zip has its checksum
        size = part.stat().st_size
        with zipfile.ZipFile(part) as archive:
            count = len(archive.namelist())
    sync_folder(target.parent)
    return Released(target, sums, sha256, count, size)


def sums_file(target: Path) -> Path:
    """Path of a zip's checksum file, in the format of `sha256sum -c`."""
    return target.with_name(f"{target.name}.sha256")


def check_release(store: Path, target: Path) -> None:
    """Refuse a target that exists, is not named .zarr.zip, or lies in the store or in no existing folder."""
    if not target.name.endswith(".zarr.zip"):
        raise InputError(f"--out {target}: expected a name that ends in .zarr.zip")
    if target.exists() or target.is_symlink():
        raise InputError(f"{target}: exists already: remove it, or give another --out")
    if target.resolve().is_relative_to(store.resolve()):
        raise InputError(f"--out {target}: lies in the store, which would change it: give another --out")
    if not target.parent.is_dir():
        raise InputError(f"--out {target}: expected a folder that exists, got {target.parent}")


def check_sound(store: Path) -> None:
    """Raise DamagedError if the files of a store differ from its manifest."""
    faults = [*file_faults(store), *manifest_faults(store)]
    if faults:
        more = f" and {len(faults) - 1} more faults" if len(faults) > 1 else ""
        raise DamagedError(f"{store}: the dataset is damaged: {faults[0]}{more}")


def _remove_parts(target: Path) -> None:
    """Remove the parts that killed runs left, each as large as the store; those locked are being written."""
    for part in target.parent.glob(f"{glob.escape(target.name)}.*.part"):
        if whole_name(part.name) != target.name:
            continue
        with contextlib.suppress(OSError), part.open("rb") as handle:  # then it stays, and harms nothing
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()


def _write(store: Path, handle: BinaryIO) -> None:
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
    """Differences between a zip's files and the manifest in it, one sentence each."""
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
    """Differences of the manifest and the ledger, which no manifest lists, from the store's."""
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
