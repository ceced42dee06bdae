"""Make pokes.npz, a small part of the `quick` dataset: python tests/learn/data/make_pokes.py QUICK.zarr

Build the store first: `python -m factory.build --model ogden --recipe quick`. Every other frame is kept;
displacements are 16-bit integers relative to each frame's largest component (steps of 3e-4 mm at most).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import zarr

KEPT = slice(1, None, 2)  # frames of each poke: 2, 4, 6, 8, 10 mm


def main(store: str) -> None:
    group = zarr.open_group(store, mode="r")

    def read(name: str) -> np.ndarray[Any, Any]:
        array: Any = group[name]
        return np.asarray(array[...])

    rows = np.concatenate(
        [np.arange(a, a + n)[KEPT] for a, n in zip(read("frame_start"), read("frame_count"), strict=True)]
    )
    moved = read("grid_displacement")[rows].astype(np.float64)
    largest = np.abs(moved).max(axis=(1, 2, 3))
    about = {name: group.attrs[name] for name in ("model", "shapes", "softness", "parameter_names")}
    rod = dict(group.attrs["identity"])["recipe"]["rod"]  # type: ignore[arg-type, index, call-overload]
    np.savez_compressed(
        Path(__file__).with_name("pokes.npz"),
        about=json.dumps({**about, "identity": {"recipe": {"rod": rod}}}),
        displacement=np.rint(moved / largest[:, None, None, None] * 32767).astype(np.int16),
        largest=largest,
        depth=read("depth")[rows],
        rod_force=read("rod_force")[rows],
        frame_poke=read("frame_poke")[rows],
        **{  # type: ignore[arg-type]
            name: read(name)
            for name in (
                "grid_rest", "level_depth", "profile", "poke_shape", "poke_softness", "poke_geometry",
                "parameter", "direction", "path_start",
            )
        },
    )  # fmt: skip


if __name__ == "__main__":
    main(sys.argv[1])
