"""The arrays of a store: names, dimensions, types, units, and how they are cut into chunks.

Pokes are ragged, so their frames, surface nodes and triangles are laid end to end; `frame_start` and
its like say where each poke begins. All units are SI.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from factory._grid import SIZE
from factory._profile import LEVELS
from factory._record import COUNTERS, STATUSES
from factory.materials import STORED_LAWS

# what the first dimension counts; "value" = surface nodes of all frames of all pokes
Rows = Literal["fixed", "poke", "frame", "node", "triangle", "value", "geometry"]
MESSAGE_BYTES = 512


@dataclass(frozen=True, kw_only=True)
class Spec:
    """One array. row: shape of one row; chunk, shard: rows in a chunk and in a shard (one file)."""

    rows: Rows
    dtype: str
    text: str
    dims: tuple[str, ...] = ()
    row: tuple[int, ...] = ()
    units: str | None = None
    chunk: int = 4096
    shard: int = 4096
    attributes: dict[str, Any] = field(default_factory=dict)


def _flags(names: tuple[str, ...]) -> dict[str, Any]:
    return {"flag_values": list(range(len(names))), "flag_meanings": " ".join(names)}


_AXIS: dict[str, Any] = {"dims": ("axis",), "row": (3,)}
_FRAME: dict[str, Any] = {"chunk": 4096, "shard": 65536}

# chunk and shard sizes: see benchmarks/store_layout.py
# fmt: off
SPECS: dict[str, Spec] = {
    "grid_rest": Spec(
        rows="fixed", dtype="f8", units="m", dims=("grid_column", "axis"), row=(SIZE, 3),
        text="rest positions of the grid on the top face; rows along y, columns along x",
    ),
    "level_depth": Spec(
        rows="fixed", dtype="f8", units="m", text="depth below the rest surface of each profile level"
    ),
    "profile": Spec(
        rows="geometry", dtype="u1", units="1", chunk=1, shard=1,
        dims=("grid_row", "grid_column", "level"), row=(SIZE, SIZE, LEVELS),
        text="stiffness under each grid point: rigid 1.0, silicone by mixture; a poke's row is "
        "poke_geometry[poke] (shape x softness)",
        attributes={"scale_factor": 1 / 255},
    ),
    "inclusion_kind": Spec(
        rows="geometry", dtype="u1", text="kind of the rigid inclusion",
        attributes=_flags(("box", "sphere", "cylinder")),
    ),
    "inclusion_size": Spec(
        rows="geometry", dtype="f8", units="m", **_AXIS,
        text="box: sides; sphere: radius, 0, 0; cylinder: radius, height, 0",
    ),
    "inclusion_centre": Spec(rows="geometry", dtype="f8", units="m", **_AXIS, text="centre of the inclusion"),
    "inclusion_angle": Spec(
        rows="geometry", dtype="f8", units="rad", text="turn of the inclusion about the vertical"
    ),
    # one row a poke
    "done": Spec(rows="poke", dtype="bool", text="the poke was simulated (its frames are all good)"),
    "status": Spec(
        rows="poke", dtype="u1", text="why the simulation ended; meaningless where done is false",
        attributes=_flags(tuple(str(s) for s in STATUSES)),
    ),
    "message": Spec(
        rows="poke", dtype="u1", dims=("byte",), row=(MESSAGE_BYTES,),
        text="what stopped the poke, or the error where done is false: UTF-8, filled up with zeros",
    ),
    "poke_shape": Spec(rows="poke", dtype="i4", text="index into attribute shapes"),
    "poke_softness": Spec(rows="poke", dtype="i4", text="index into attribute softness"),
    "poke_geometry": Spec(rows="poke", dtype="i4", text="row of profile and inclusion_*"),
    "law": Spec(rows="poke", dtype="u1", text="constitutive law", attributes=_flags(STORED_LAWS)),
    "parameter": Spec(
        rows="poke", dtype="f8", dims=("parameter_name",),
        text="material parameters in the order of attribute parameter_names (moduli in Pa)",
    ),
    "site_shared": Spec(rows="poke", dtype="bool", text="the site is common to all softness levels"),
    "site_number": Spec(rows="poke", dtype="i4", text="number of the site within its shape and softness"),
    "seed": Spec(rows="poke", dtype="u8", text="what site and direction were drawn from"),
    "site": Spec(
        rows="poke", dtype="f8", units="m", dims=("plane_axis",), row=(2,),
        text="where the rod's axis meets the rest surface (x, y)",
    ),
    "direction": Spec(rows="poke", dtype="f8", units="1", **_AXIS, text="direction of the push, unit length"),
    "depth_asked": Spec(rows="poke", dtype="f8", units="m", text="travel asked for, from first touch"),
    "path_start": Spec(rows="poke", dtype="f8", units="m", **_AXIS, text="rod tip at first touch"),
    "path_end": Spec(rows="poke", dtype="f8", units="m", **_AXIS, text="rod tip at the depth asked for"),
    "mesh_nodes": Spec(rows="poke", dtype="i8", text="nodes of the volume mesh"),
    "mesh_elements": Spec(rows="poke", dtype="i8", text="elements of the volume mesh"),
    **{name: Spec(rows="poke", dtype="i8", text=f"solver: {name.replace('_', ' ')}") for name in COUNTERS},
    **{
        f"{kind}_{end}": Spec(rows="poke", dtype="i8", text=text)
        for kind, what in (
            ("frame", "frames"),
            ("node", "surface nodes"),
            ("triangle", "surface triangles"),
            ("value", "surface_displacement"),
        )
        for end, text in (("start", f"first row of the poke in {what}"), ("count", f"rows in {what}"))
    },
    # one row a frame
    "frame_poke": Spec(rows="frame", dtype="i4", **_FRAME, text="poke that the frame belongs to"),
    "depth": Spec(
        rows="frame", dtype="f8", units="m", **_FRAME, text="travel of the rod since first touch"
    ),
    "rod_tip": Spec(rows="frame", dtype="f8", units="m", **_AXIS, **_FRAME, text="centre of the rod's tip"),
    "rod_axis": Spec(
        rows="frame", dtype="f8", units="1", **_AXIS, **_FRAME,
        text="unit vector along the rod, towards its tip: with rod_tip the pose of the round rod",
    ),
    "rod_force": Spec(
        rows="frame", dtype="f8", units="N", **_AXIS, **_FRAME, text="force of the tissue on the rod"
    ),
    "base_force": Spec(
        rows="frame", dtype="f8", units="N", **_AXIS, **_FRAME,
        text="force of all fixed nodes (base and inclusion) on the tissue",
    ),
    "penetration": Spec(
        rows="frame", dtype="f8", units="m", **_FRAME, text="deepest overlap of tissue and rod"
    ),
    "min_jacobian": Spec(
        rows="frame", dtype="f8", units="1", **_FRAME, text="smallest det F at the integration points"
    ),
    "residual": Spec(
        rows="frame", dtype="f8", units="1", **_FRAME,
        text="residual force at the free nodes relative to the applied load",
    ),
    "grid_displacement": Spec(
        rows="frame", dtype="f4", units="m", dims=("grid_row", "grid_column", "axis"), row=(SIZE, SIZE, 3),
        text="displacement of the grid points (position = grid_rest + displacement)",
        chunk=256, shard=1024,
    ),
    # surfaces
    "surface_rest": Spec(
        rows="node", dtype="f8", units="m", **_AXIS, text="rest positions of the surface nodes",
        chunk=65536, shard=524288,
    ),
    "surface_triangle": Spec(
        rows="triangle", dtype="i4", dims=("corner",), row=(3,),
        text="outward triangles; indices count from the poke's first surface node",
        chunk=65536, shard=524288,
    ),
    "surface_displacement": Spec(
        rows="value", dtype="f4", units="m", **_AXIS,
        text="displacement of the surface nodes, frame after frame of each poke "
        "(position = surface_rest + displacement)",
        chunk=262144, shard=1048576,
    ),
}

FIRST_DIMENSION: dict[Rows, str] = {
    "poke": "poke", "frame": "frame", "node": "surface_node", "triangle": "surface_triangle_row",
    "value": "surface_value", "geometry": "geometry",
}
# fmt: on
FIXED_DIMENSION = {"grid_rest": "grid_row", "level_depth": "level"}
