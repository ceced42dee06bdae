"""What this package needs of a store: array names, dimensions, kinds of number and units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

FORMAT = 1  # of the store; its root attribute `format`
GRID = 32
LEVELS = 128
RIGID = 255  # profile value of the rigid inclusion; silicones are lower
MANIFEST = "provenance/manifest.json"

Rows = Literal["fixed", "poke", "frame", "node", "triangle", "value", "geometry"]


@dataclass(frozen=True, kw_only=True)
class Needed:
    """One array. row: shape of one row (None: not checked); kinds: numpy's letters for its type."""

    rows: Rows
    kinds: str = "f"
    row: tuple[int, ...] | None = ()
    units: str | None = None
    big: bool = False


ATTRIBUTES = ("uuid", "fingerprint", "model", "pokes", "shapes", "softness", "parameter_names", "identity")

# fmt: off
ARRAYS: dict[str, Needed] = {
    "grid_rest": Needed(rows="fixed", row=(GRID, 3), units="m"),
    "level_depth": Needed(rows="fixed", units="m"),
    "profile": Needed(rows="geometry", kinds="u", row=(GRID, GRID, LEVELS), units="1"),
    "done": Needed(rows="poke", kinds="b"),
    "status": Needed(rows="poke", kinds="u"),
    "poke_shape": Needed(rows="poke", kinds="i"),
    "poke_softness": Needed(rows="poke", kinds="i"),
    "poke_geometry": Needed(rows="poke", kinds="i"),
    "law": Needed(rows="poke", kinds="u"),
    "parameter": Needed(rows="poke", row=None),
    "direction": Needed(rows="poke", row=(3,), units="1"),
    "path_start": Needed(rows="poke", row=(3,), units="m"),
    "frame_start": Needed(rows="poke", kinds="i"),
    "frame_count": Needed(rows="poke", kinds="i"),
    "frame_poke": Needed(rows="frame", kinds="i"),
    "depth": Needed(rows="frame", units="m"),
    "rod_force": Needed(rows="frame", row=(3,), units="N"),
    "grid_displacement": Needed(rows="frame", row=(GRID, GRID, 3), units="m", big=True),
    # only where errors off the grid are asked for
    "node_start": Needed(rows="poke", kinds="i"),
    "node_count": Needed(rows="poke", kinds="i"),
    "triangle_start": Needed(rows="poke", kinds="i"),
    "triangle_count": Needed(rows="poke", kinds="i"),
    "value_start": Needed(rows="poke", kinds="i"),
    "surface_rest": Needed(rows="node", row=(3,), units="m", big=True),
    "surface_triangle": Needed(rows="triangle", kinds="i", row=(3,), big=True),
    "surface_displacement": Needed(rows="value", row=(3,), units="m", big=True),
}
# fmt: on
