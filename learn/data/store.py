"""A finished dataset: its small tables in memory, its displacement field file by file.

>>> store = learn.data.open_store("datasets/quick-ogden.zarr")
>>> store.frames, len(store.setups), store.n_points
>>> store.displacement(slice(0, 64))               # [m], (64, 1024, 3) float32
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.data._files import displacement_reader, group_here, reading
from learn.data._format import GRID, RIGID
from learn.data.setup import Setup
from learn.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_PRESSES = 1e-3  # relative to shear modulus x rod radius x depth: a smaller force counts as no contact


@dataclass(frozen=True, eq=False, kw_only=True)
class Clock:
    """Time data of a store whose rod follows a course over time. SI units.

    Attributes
    ----------
    time : since first contact [s], shape (f,).
    phase : "load", "hold", "retract", "reload" or "rest", shape (f,).
    rod_speed : rate of change of the depth [m/s], 0 in a hold, negative in a retraction, shape (f,).
    approach_speed : speed of the rod from first contact on, in its course's first ramp [m/s], shape (p,).
    dissipated_energy : energy dissipated by the material since first contact [J], shape (f,).
    """

    time: Floats
    phase: NDArray[np.str_]
    rod_speed: Floats
    approach_speed: Floats
    dissipated_energy: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Store:
    """A dataset of p pokes, f frames, n = 1024 grid points, g geometries (shape x softness). SI units.

    Attributes
    ----------
    location, attributes : folder, zip or URL, and attributes of the root group.
    setups : the blocks, each with its grid, and the indenter: one, unless the shapes' blocks differ in size.
    setup_index : setup of each geometry, shape (g,).
    profile : stiffness under each point as stored, top level first, shape (g, n, levels), uint8.
    done : True for each poke that was simulated, shape (p,).
    shape, softness, geometry : indices of each poke, shape (p,).
    modulus : shear modulus at small strain [Pa], shape (p,).
    direction, path_start : unit vector of the push, and the tip at first contact [m], shape (p, 3).
    frame_start, frame_count : first frame of each poke and number of its frames, shape (p,).
    frame_poke : poke of each frame, shape (f,).
    depth : travel since first contact [m], shape (f,).
    rod_force : force on the indenter [N], shape (f, 3).
    solved_as : index of the poke whose solve is used: itself, or one that differs by a factor of the moduli,
        shape (p,).
    clock : time data of the frames; None if the dataset has no time.
    has_fields : False if only the tables are here (`learn.data.tables`), so that `displacement` and `surface`
        raise InputError.
    """

    location: str
    attributes: dict[str, Any]
    setups: tuple[Setup, ...]
    setup_index: Ints
    profile: NDArray[np.uint8]
    done: NDArray[np.bool_]
    shape: Ints
    softness: Ints
    geometry: Ints
    modulus: Floats
    direction: Floats
    path_start: Floats
    frame_start: Ints
    frame_count: Ints
    frame_poke: Ints
    depth: Floats
    rod_force: Floats
    solved_as: Ints
    clock: Clock | None = None
    has_fields: bool = True

    @property
    def copies(self) -> NDArray[np.bool_]:
        """True for pokes (p,) that repeat another's solve, with forces scaled by the modulus.

        All False unless the dataset states that the modulus only scales the forces (`scales_with_modulus`).
        """
        return (self.solved_as != np.arange(self.pokes)) & self.scales_with_modulus

    def clocks(self, rows: NDArray[np.int64]) -> Floats:
        """Time since contact [s], the rod's speed and its speed of approach [m/s] of frames, shape (b, 3).

        Shape (b, 0) if the dataset has no time.
        """
        if self.clock is None:
            return np.empty((len(rows), 0))
        approach = self.clock.approach_speed[self.frame_poke[rows]]
        return np.stack([self.clock.time[rows], self.clock.rod_speed[rows], approach], axis=1)

    @property
    def presses(self) -> NDArray[np.bool_]:
        """True for frames in which the rod presses on the tissue, shape (f,): all, unless it is retracted."""
        if self.clock is None:
            return np.ones(self.frames, dtype=bool)
        force = np.linalg.norm(self.rod_force, axis=1)
        unit = self.modulus[self.frame_poke] * self.rod_radius * self.depth
        return np.asarray((self.depth > 0.0) & (force > _PRESSES * unit))

    @property
    def address(self) -> str:
        """URL or absolute path of the store; of tables alone, where it was when they were written."""
        local = self.has_fields and "://" not in self.location
        return str(Path(self.location).resolve()) if local else self.location

    @property
    def uuid(self) -> str:
        return str(self.attributes["uuid"])

    @property
    def law(self) -> str:
        return str(self.attributes["model"])

    @property
    def scales_with_modulus(self) -> bool:
        """True if all material levels give equal displacements, with forces proportional to the modulus."""
        return self.attributes.get("scales_with_modulus") is True

    @property
    def shapes(self) -> list[str]:
        return [str(name) for name in self.attributes["shapes"]]

    @property
    def softness_names(self) -> list[str]:
        return [str(name) for name in self.attributes["softness"]]

    @property
    def setup(self) -> Setup:
        """The only setup. InputError if there are several, and the caller has to choose one."""
        if len(self.setups) > 1:
            raise InputError(f"{self.location}: has {self.describe_blocks()}: expected a single block")
        return self.setups[0]

    def setup_of(self, poke: int) -> Setup:
        """The setup of a poke."""
        return self.setups[int(self.setup_index[self.geometry[poke]])]

    def setup_under(self, shapes: Sequence[str] | None) -> int:
        """Index of the setup that these shapes share, or of the only one; InputError names `--shape`."""
        if len(self.setups) == 1:
            return 0
        wanted = [self.shapes.index(name) for name in shapes or ()]
        found = np.unique(self.setup_index[self.geometry[np.isin(self.shape, wanted)]])
        if len(found) != 1:
            raise InputError(
                f"{self.location}: has {self.describe_blocks()}: expected --shape, a shape in the block that"
                " is wanted, or several in one block"
            )
        return int(found[0])

    def describe_blocks(self) -> str:
        """Number and sizes of the blocks: "36 blocks of 70 to 130 x 71 to 129 x 24 to 40 mm"."""
        sizes = np.array([setup.block_size for setup in self.setups]) * 1e3
        ends = zip(sizes.min(axis=0), sizes.max(axis=0), strict=True)
        sides = " x ".join(f"{a:.4g}" if b - a < 1e-6 else f"{a:.4g} to {b:.4g}" for a, b in ends)
        return f"{len(sizes)} block{'s' if len(sizes) > 1 else ''} of {sides} mm"

    @property
    def n_points(self) -> int:
        """Number of points of each grid."""
        return int(self.profile.shape[1])

    @property
    def rod_radius(self) -> float:
        """Radius of the indenter [m]."""
        return self.setups[0].rod_radius

    @property
    def pokes(self) -> int:
        return len(self.done)

    @property
    def frames(self) -> int:
        return len(self.depth)

    @property
    def shard(self) -> int:
        """Number of frames in one file of the displacement, which are best read together."""
        array = self._grid_displacement()
        return int((array.shards or array.chunks)[0])

    @property
    def chunk(self) -> int:
        """Number of frames that are decompressed together."""
        return int(self._grid_displacement().chunks[0])

    def displacement(self, rows: slice, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """Displacement [m] of the grid points in these frames, (frames, n, 3), written to `out` if given.

        InputError if the store cannot be read or holds a value that is not finite.
        """
        array = self._grid_displacement()
        start, stop, _ = rows.indices(self.frames)
        if out is None:
            out = np.empty((max(stop - start, 0), self.n_points, 3), dtype=np.float32)
        with reading(f"{self.location}: grid_displacement"):
            reader = displacement_reader(self.location)
            if reader is not None:
                reader.read(start, stop, out.reshape(-1, GRID, GRID, 3))
            else:
                out[...] = np.asarray(array[start:stop]).reshape(out.shape)
        flat = out.reshape(-1)
        if not np.isfinite(np.dot(flat, flat)):  # one pass over the values, without temporary arrays
            bad = int(np.flatnonzero(~np.isfinite(out).all(axis=(1, 2)))[0]) + start
            raise InputError(
                f"{self.location}: grid_displacement: frame {bad} has a value that is not finite"
            )
        return out

    def surface(self, poke: int) -> tuple[Floats, NDArray[np.int64], NDArray[np.float32]]:
        """One poke's own surface mesh: rest nodes (m, 3), triangles (t, 3), displacement (frames, m, 3)."""
        table = {
            name: int(self._array(name)[poke])
            for name in ("node_start", "node_count", "triangle_start", "triangle_count", "value_start")
        }
        nodes = slice(table["node_start"], table["node_start"] + table["node_count"])
        faces = slice(table["triangle_start"], table["triangle_start"] + table["triangle_count"])
        frames, count = int(self.frame_count[poke]), table["node_count"]
        values = slice(table["value_start"], table["value_start"] + frames * count)
        moved = np.asarray(self._array("surface_displacement", values)).reshape(frames, count, 3)
        rest = np.asarray(self._array("surface_rest", nodes), dtype=np.float64)
        triangles = np.asarray(self._array("surface_triangle", faces), dtype=np.int64)
        if triangles.size and not (triangles.min() >= 0 and triangles.max() < count):
            raise InputError(f"{self.location}: surface_triangle: poke {poke} points at a node it has not")
        if not (np.isfinite(moved).all() and np.isfinite(rest).all()):
            raise InputError(f"{self.location}: surface of poke {poke} has a value that is not finite")
        return rest, triangles, moved

    def _grid_displacement(self) -> Any:
        self._check_fields()
        return group_here(self.location)["grid_displacement"]

    def _check_fields(self) -> None:
        if not self.has_fields:
            raise InputError(
                f"{self.location}: of this dataset only the tables are here, not its displacement fields:"
                " --dataset states where it is now"
            )

    def _array(self, name: str, rows: slice | None = None) -> NDArray[Any]:
        self._check_fields()
        array: Any = group_here(self.location)[name]
        with reading(f"{self.location}: {name}"):
            return np.asarray(array[rows if rows is not None else slice(None)])


def rigid_masks(profile: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], Ints]:
    """Masks of rigid levels, one per distinct inclusion (k, n, levels), and the k of each geometry (g,)."""
    rigid = profile == RIGID
    # a row as one value of packed bits: np.unique over rows is a thousand times slower
    bits = np.packbits(rigid.reshape(len(rigid), -1), axis=1)
    row = bits.view(np.dtype((np.void, bits.shape[1])))[:, 0]
    _, first, index = np.unique(row, return_index=True, return_inverse=True)
    return rigid[first], np.asarray(index, dtype=np.int64)
