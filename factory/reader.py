"""Read a store: small tables as a whole, large arrays poke by poke.

>>> data = open_dataset("datasets/quick-ogden.zarr")
>>> poke = data.poke(3)
>>> poke.surface[-1]                    # positions of the surface nodes in the last frame [m]
"""

from __future__ import annotations

import contextlib
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
import zarr
import zarr.storage
from numpy.typing import NDArray

from factory.errors import InputError, describe_os_error, one_line
from factory.plan.dataset import FORMAT
from factory.recipe.course import PHASES
from factory.simulation.record import STATUSES
from factory.store.files import DamagedError, altered_files, missing_files, plain_files, root_attributes
from factory.store.poke_data import PokeData
from factory.store.schema import NOT_SIMULATED, Spec, specs_of
from factory.store.staging import building_folder
from tisim import Inclusion, inclusions

Counted = Literal["frame", "node", "triangle", "value"]
_BIG = {"profile", "grid_displacement", "surface_displacement", "surface_rest", "surface_triangle"}


@dataclass(frozen=True, eq=False)
class Dataset:
    """A finished store.

    Attributes
    ----------
    path : Path
        A folder, or a Zarr zip of `factory.release`.
    attributes : dict
        Attributes of the store's root: recipe, seeds, names of shapes and material levels, versions.
    group : zarr.Group
    table : dict of str to ndarray
        All arrays but the large ones (profiles, displacements, surfaces), in memory.
    """

    path: Path
    attributes: dict[str, Any]
    group: zarr.Group

    def __repr__(self) -> str:
        return (
            f"Dataset({self.path}: {self.attributes['model']}, {self.n_pokes} pokes of "
            f"{len(self.shapes)} shapes at {len(self.levels)} material levels)"
        )

    @cached_property
    def root(self) -> Path | zipfile.Path:
        """Folder of the store, or root of its zip."""
        return files_of(self.path)

    @cached_property
    def table(self) -> dict[str, NDArray[Any]]:
        return {name: self.read(name) for name in self.specs if name not in _BIG}

    @property
    def specs(self) -> dict[str, Spec]:
        """Specifications of the store's arrays, by name."""
        return specs_of(self.attributes["identity"])

    @property
    def timed(self) -> bool:
        """True if frames have a time, i.e. the recipe has a course."""
        return "time" in self.specs

    def array(self, name: str) -> Any:
        """The Zarr array itself; DamagedError if its metadata or one of its files is missing or damaged."""
        with self._damage_named(name):
            if not (self.root / name / "zarr.json").is_file():  # the root's metadata list it nonetheless
                raise KeyError(name)
            if name not in self._opened:
                self._opened[name] = self.group[name]
            array = self._opened[name]
        if name in self._lost:  # Zarr reads a missing chunk as zeros
            raise DamagedError(f"{self.path / self._lost[name]}: missing, and the manifest lists it")
        return array

    def read(self, name: str, rows: slice | int = slice(None)) -> NDArray[Any]:
        """Rows of an array; DamagedError if they cannot be read."""
        array = self.array(name)
        with self._damage_named(name):
            return np.asarray(array[rows])

    @cached_property
    def _opened(self) -> dict[str, Any]:
        """Arrays opened so far: each look-up in the group costs about as much as reading a table."""
        return {}

    @cached_property
    def _lost(self) -> dict[str, str]:
        """A missing file of each array that lacks one of those that the manifest lists."""
        return {name.partition("/")[0]: name for name in missing_files(self.root)}

    @contextlib.contextmanager
    def _damage_named(self, name: str) -> Iterator[None]:
        try:
            yield
        except KeyError:
            raise DamagedError(f"{self.path / name}: the array is missing") from None
        except Exception as error:  # a damaged file can break anywhere in the decoding
            raise DamagedError(
                f"{self.path / name}: the array cannot be read ({type(error).__name__}: {one_line(error)})"
            ) from None

    def size_of(self, name: str = "") -> int:
        """Bytes of an array's files, or of the whole store."""
        if isinstance(self.root, zipfile.Path):
            prefix = f"{name}/" if name else ""
            return sum(e.file_size for e in self.root.root.infolist() if e.filename.startswith(prefix))
        return sum(path.stat().st_size for _, path, sound in plain_files(self.path / name) if sound)

    @property
    def n_pokes(self) -> int:
        return int(self.attributes["pokes"])

    @property
    def shapes(self) -> list[str]:
        """Names of the inclusions."""
        return list(self.attributes["shapes"])

    @property
    def levels(self) -> list[str]:
        """Names of the material levels."""
        return list(self.attributes["softness"])

    @cached_property
    def waiting(self) -> tuple[int, ...]:
        """Indices of the pokes that a partial store (`factory.build --partial`) lacks."""
        lacking = np.flatnonzero(~self.table["done"].astype(bool)).tolist()
        return tuple(index for index in lacking if self.message(index) == NOT_SIMULATED)

    def message(self, index: int) -> str:
        """Reason why a poke ended early, or its error; may be empty."""
        return bytes(self.table["message"][index]).rstrip(b"\0").decode(errors="replace")

    def status(self, index: int) -> str:
        """Status as a word; "failed" where the poke has no result."""
        if not self.table["done"][index]:
            return "failed"
        return name_of([str(s) for s in STATUSES], int(self.table["status"][index]))

    def rows(self, index: int, counted: Counted) -> slice:
        """Rows of a poke in the arrays that count frames, nodes, triangles or values."""
        start = int(self.table[f"{counted}_start"][index])
        return slice(start, start + int(self.table[f"{counted}_count"][index]))

    def rows_of(self, index: int) -> dict[str, slice]:
        """Rows of a poke in each of the large arrays."""
        geometry = int(self.table["poke_geometry"][index])
        return {
            "profile": slice(geometry, geometry + 1),
            "grid_displacement": self.rows(index, "frame"),
            "surface_displacement": self.rows(index, "value"),
            "surface_rest": self.rows(index, "node"),
            "surface_triangle": self.rows(index, "triangle"),
        }

    def check_sums(self, poke: int | None = None) -> None:
        """Raise DamagedError if a file of the tables, or of one poke in the large arrays, is altered.

        A flipped bit may decode to another value without an error; sums are compared with the manifest.
        """
        arrays: dict[str, range | None] = dict.fromkeys(self.specs.keys() - _BIG)
        altered = altered_files(self.root, arrays)
        if not altered and poke is not None:
            shards = {name: self._shards(name, rows) for name, rows in self.rows_of(poke).items()}
            altered = altered_files(self.root, shards)
        if altered:
            raise DamagedError(f"{self.path / altered[0]}: its sha256 differs from the manifest")

    def _shards(self, name: str, rows: slice) -> range:
        """Numbers of an array's files that hold rows, along its first dimension."""
        array = self.array(name)
        size = int((array.shards or array.chunks)[0])
        return range(rows.start // size, -(-rows.stop // size) if rows.stop > rows.start else 0)

    def check_rows(self) -> None:
        """Raise DamagedError if lengths of tables contradict the attributes or the tables' own counts."""
        expected: dict[str, int] = {
            "poke": self.n_pokes,
            "geometry": len(self.shapes) * len(self.levels),
            "frame": int(self.table["frame_count"].sum()),
        }
        for name, spec in self.specs.items():
            if name not in self.table or spec.rows not in expected:
                continue
            array = self.table[name]
            if array.shape[:1] != (expected[spec.rows],) or (spec.row and array.shape[1:] != spec.row):
                raise DamagedError(
                    f"{self.path / name}: has shape {array.shape}, expected {expected[spec.rows]} rows"
                )

    def block(self, geometry: int) -> tuple[float, float, float]:
        """Sides of the block of one geometry [m]; DamagedError if the recipe states none."""
        recipe = self.attributes["identity"]["recipe"]
        try:
            shape = recipe["shapes"][geometry // len(self.levels)]
            width, length, height = (side * 1e-3 for side in shape.get("block_mm", recipe["block_mm"]))
        except (LookupError, TypeError, ValueError) as error:
            raise DamagedError(f"{self.path}: block of geometry {geometry}: {one_line(error)}") from None
        return width, length, height

    def grid_rest(self, geometry: int) -> NDArray[np.float64]:
        """Rest positions of the grid on the top of one geometry's block [m], shape (32, 32, 3)."""
        rest = self.table["grid_rest"]
        return rest if self.specs["grid_rest"].rows == "fixed" else np.asarray(rest[geometry])

    def level_depth(self, geometry: int) -> NDArray[np.float64]:
        """Depths of the profile levels of one geometry below the rest surface [m], shape (128,)."""
        depth = self.table["level_depth"]
        return depth if self.specs["level_depth"].rows == "fixed" else np.asarray(depth[geometry])

    def inclusion(self, geometry: int) -> Inclusion:
        """The inclusion of one geometry (a row of `inclusion_*` and `profile`).

        Raises
        ------
        DamagedError
            If the row describes no inclusion, or its kind is not registered in `tisim.inclusions`.
        """
        try:
            if "inclusions" in self.attributes:
                return inclusions.decode(self.attributes["inclusions"][geometry // len(self.levels)])
            kinds = str(self.array("inclusion_kind").attrs["flag_meanings"]).split()
            return inclusions.from_dimensions(
                kinds[int(self.table["inclusion_kind"][geometry])],
                self.table["inclusion_size"][geometry],
                self.table["inclusion_centre"][geometry],
                float(self.table["inclusion_angle"][geometry]),
            )
        except (LookupError, TypeError, ValueError) as error:
            raise DamagedError(f"{self.path}: inclusion of geometry {geometry}: {one_line(error)}") from None

    def poke(self, index: int) -> PokeData:
        """All data of one poke; InputError if there is none, DamagedError if the store cannot be read."""
        if not 0 <= index < self.n_pokes:
            raise InputError(f"poke {index}: expected 0 to {self.n_pokes - 1}")
        self.check_rows()
        table, frames, rows = self.table, self.rows(index, "frame"), self.rows_of(index)
        geometry = int(table["poke_geometry"][index])
        rest = self.read("surface_rest", rows["surface_rest"])
        moved = self.read("surface_displacement", rows["surface_displacement"])
        depth = table["depth"][frames]
        if moved.shape != (len(depth) * len(rest), 3) or rest.shape[1:] != (3,):
            raise DamagedError(f"{self.path}: poke {index}: its surface and its frames do not match")
        profile = self.array("profile")
        if not 0 <= geometry < profile.shape[0]:
            raise DamagedError(f"{self.path}: poke {index}: geometry {geometry} is not in the store")
        return PokeData(
            index=index,
            shape=name_of(self.shapes, int(table["poke_shape"][index])),
            level=name_of(self.levels, int(table["poke_softness"][index])),
            status=self.status(index),
            message=self.message(index),
            block=self.block(geometry),
            inclusion=self.inclusion(geometry),
            direction=table["direction"][index],
            depth=depth,
            rod_tip=table["rod_tip"][frames],
            rod_force=table["rod_force"][frames],
            base_force=table["base_force"][frames],
            grid=self.grid_rest(geometry) + self.read("grid_displacement", rows["grid_displacement"]),
            surface=rest + moved.reshape(len(depth), len(rest), 3),
            surface_rest=rest,
            triangles=self.read("surface_triangle", rows["surface_triangle"]),
            profile=self.read("profile", geometry),
            **self._of_time(frames),
        )

    def _of_time(self, frames: slice) -> dict[str, Any]:
        if not self.timed:
            return {}
        phase = tuple(name_of(PHASES, int(code)) for code in self.table["phase"][frames])
        names = ("time", "rod_speed", "dissipated_energy")
        return {"phase": phase, **{name: self.table[name][frames] for name in names}}


def name_of(names: Sequence[str], number: int) -> str:
    """Name of a code, or "unknown (7)" for an invalid code of a damaged store."""
    return names[number] if 0 <= number < len(names) else f"unknown ({number})"


def open_dataset(path: str | Path) -> Dataset:
    """Open a finished store for reading.

    Raises
    ------
    InputError
        If there is no dataset of the factory, or one that is still being built; DamagedError if its
        metadata are damaged.
    """
    folder = Path(path)
    if not (folder.is_dir() or is_zip(folder)):
        hint = ""
        if building_folder(folder).is_dir():
            hint = f": it is still being built in {building_folder(folder).name}"
        raise InputError(f"{folder}: no such dataset{hint}")
    try:
        attributes = root_attributes(files_of(folder))
    except OSError as error:
        raise InputError(describe_os_error(error, "cannot read")) from None
    except zipfile.BadZipFile as error:
        raise DamagedError(f"{folder}: cannot be read as a zip ({one_line(error)})") from None
    if attributes is None:
        raise InputError(f"{folder}: not a dataset of the factory")
    if attributes["format"] != FORMAT:
        raise InputError(f"{folder}: format {attributes['format']}, expected {FORMAT}")
    try:
        store = zarr.storage.ZipStore(folder, mode="r") if is_zip(folder) else folder
        group = zarr.open_group(store=store, mode="r", zarr_format=3)
    except Exception as error:  # damaged metadata can break anywhere in the decoding
        raise DamagedError(
            f"{folder / 'zarr.json'}: cannot be read ({type(error).__name__}: {one_line(error)})"
        ) from None
    return Dataset(folder, attributes, group)


def is_zip(path: Path) -> bool:
    """True if the path is a file with the suffix .zip."""
    return path.suffix == ".zip" and path.is_file()


def files_of(path: Path) -> Path | zipfile.Path:
    """The folder of a store, or the root of its zip; BadZipFile if that is not a valid zip."""
    return zipfile.Path(path) if is_zip(path) else path
