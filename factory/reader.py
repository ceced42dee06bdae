"""Reading a store: small tables at once, one poke's arrays when asked.

>>> data = open_dataset("datasets/quick-ogden.zarr")
>>> poke = data.poke(3)
>>> poke.surface[-1]                    # positions of the surface nodes in the last frame [m]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from numpy.typing import NDArray

from factory._layout import SPECS
from factory._parts import building_folder
from factory._record import STATUSES
from factory._store import root_attributes
from factory.errors import InputError
from factory.plan import FORMAT

_BIG = {"profile", "grid_displacement", "surface_displacement", "surface_rest", "surface_triangle"}


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeData:
    """One poke; f frames, n surface nodes, t triangles. SI units.

    depth, rod_force, base_force, rod_tip: by frame. direction: of the push. grid: positions of the top
    grid, (f, 32, 32, 3). surface: positions of the surface nodes, (f, n, 3); surface_rest (n, 3);
    triangles (t, 3). profile: stiffness under each grid point, uint8 = 255 x code, (32, 32, 128).
    """

    index: int
    shape: str
    softness: str
    status: str
    message: str
    direction: NDArray[np.float64]
    depth: NDArray[np.float64]
    rod_tip: NDArray[np.float64]
    rod_force: NDArray[np.float64]
    base_force: NDArray[np.float64]
    grid: NDArray[np.float64]
    surface: NDArray[np.float64]
    surface_rest: NDArray[np.float64]
    triangles: NDArray[np.int32]
    profile: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Dataset:
    """A finished store. `table[name]` is any array of one row a poke or frame, in memory."""

    path: Path
    attributes: dict[str, Any]
    group: zarr.Group

    @cached_property
    def table(self) -> dict[str, NDArray[Any]]:
        return {name: self.array(name)[...] for name in SPECS if name not in _BIG}

    def array(self, name: str) -> Any:
        """The Zarr array itself."""
        return self.group[name]

    @property
    def n_pokes(self) -> int:
        return int(self.attributes["pokes"])

    def message(self, index: int) -> str:
        """What stopped a poke, or its error."""
        return bytes(self.table["message"][index]).rstrip(b"\0").decode(errors="replace")

    def status(self, index: int) -> str:
        """Status as a word; "failed" where the poke has no result."""
        if not self.table["done"][index]:
            return "failed"
        return str(STATUSES[int(self.table["status"][index])])

    def rows(self, index: int, kind: str) -> slice:
        """Rows of a poke in arrays counted by kind: frame, node, triangle or value."""
        start = int(self.table[f"{kind}_start"][index])
        return slice(start, start + int(self.table[f"{kind}_count"][index]))

    def poke(self, index: int) -> PokeData:
        """Everything about one poke."""
        table, frames = self.table, self.rows(index, "frame")
        rest = self.array("surface_rest")[self.rows(index, "node")]
        moved = self.array("surface_displacement")[self.rows(index, "value")]
        return PokeData(
            index=index,
            shape=self.attributes["shapes"][int(table["poke_shape"][index])],
            softness=self.attributes["softness"][int(table["poke_softness"][index])],
            status=self.status(index),
            message=self.message(index),
            direction=table["direction"][index],
            depth=table["depth"][frames],
            rod_tip=table["rod_tip"][frames],
            rod_force=table["rod_force"][frames],
            base_force=table["base_force"][frames],
            grid=table["grid_rest"] + self.array("grid_displacement")[frames],
            surface=rest + moved.reshape(-1, len(rest), 3),
            surface_rest=rest,
            triangles=self.array("surface_triangle")[self.rows(index, "triangle")],
            profile=self.array("profile")[int(table["poke_geometry"][index])],
        )


def open_dataset(path: str | Path) -> Dataset:
    """A finished store, for reading; InputError where there is none."""
    folder = Path(path)
    if not folder.is_dir():
        hint = ""
        if building_folder(folder).is_dir():
            hint = f": it is still being built in {building_folder(folder).name}"
        raise InputError(f"{folder}: no such dataset{hint}")
    attributes = root_attributes(folder)
    if attributes is None:
        raise InputError(f"{folder}: not a dataset of the factory")
    if attributes.get("format") != FORMAT:
        raise InputError(f"{folder}: format {attributes.get('format')}, expected {FORMAT}")
    return Dataset(folder, attributes, zarr.open_group(store=folder, mode="r", zarr_format=3))
