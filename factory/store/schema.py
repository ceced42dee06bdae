"""The arrays of a store: names, dimensions, types, units, chunks and shards.

Pokes are ragged, so their frames, surface nodes and triangles are laid end to end; `frame_start` and
the other `*_start` hold the first row of each poke. All units are SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from factory.materials.laws import LAWS
from factory.recipe.course import PHASES
from factory.sampling import LEVELS, SIZE
from factory.simulation.record import COUNTERS, STATUSES

# items counted by the first dimension; "value" = surface nodes of all frames of all pokes
Rows = Literal["fixed", "poke", "frame", "node", "triangle", "value", "geometry"]
MESSAGE_BYTES = 512
NOT_SIMULATED = "not simulated yet"  # message of the pokes that a partial store lacks
# Laws and inclusion kinds that every store lists. Another one follows them in the stores that have it,
# so that a new law or shape changes no other store.
STORED_LAWS = (*LAWS, "yeoh", "eight-chain")
STORED_KINDS = ("box", "sphere", "cylinder")


@dataclass(frozen=True, kw_only=True)
class Spec:
    """One array of a store.

    Attributes
    ----------
    rows : Rows
        Items counted by the first dimension.
    dtype : str
        NumPy type of the values.
    text : str
        Description of the content.
    dims : tuple of str
        Names of the dimensions after the first.
    row : tuple of int
        Shape of one row.
    units : str or None
        Unit of the values.
    chunk, shard : int
        Rows in a chunk (compressed together) and in a shard (one file).
    attributes : dict
        Attributes of the array besides its text and units.
    """

    rows: Rows
    dtype: str
    text: str
    dims: tuple[str, ...] = ()
    row: tuple[int, ...] = ()
    units: str | None = None
    chunk: int = 4096
    shard: int = 4096
    attributes: dict[str, Any] = field(default_factory=dict)


def flags(names: tuple[str, ...]) -> dict[str, Any]:
    """Attributes of an array of codes: code i means names[i] (CF conventions)."""
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
        attributes=flags(STORED_KINDS),
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
        attributes=flags(tuple(str(s) for s in STATUSES)),
    ),
    "message": Spec(
        rows="poke", dtype="u1", dims=("byte",), row=(MESSAGE_BYTES,),
        text="what stopped the poke, or the error where done is false: UTF-8, filled up with zeros",
    ),
    "poke_shape": Spec(rows="poke", dtype="i4", text="index into attribute shapes"),
    "poke_softness": Spec(rows="poke", dtype="i4", text="index into attribute softness"),
    "poke_geometry": Spec(rows="poke", dtype="i4", text="row of profile and inclusion_*"),
    "law": Spec(rows="poke", dtype="u1", text="constitutive law", attributes=flags(STORED_LAWS)),
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

# only in stores of recipes with a course, so that the others stay as they were
COURSE_SPECS: dict[str, Spec] = {
    "course_time": Spec(
        rows="poke", dtype="f8", units="s", dims=("course_piece",),
        text="end of each piece (ramp or hold) of the rod's course, which begins at first touch at time 0",
    ),
    "course_depth": Spec(
        rows="poke", dtype="f8", units="m", dims=("course_piece",),
        text="depth at the end of each piece of the rod's course; straight lines join them",
    ),
    "time": Spec(rows="frame", dtype="f8", units="s", **_FRAME, text="time since first touch"),
    "phase": Spec(
        rows="frame", dtype="u1", **_FRAME, attributes=flags(PHASES),
        text="piece of the course that the frame lies in, or ends",
    ),
    "rod_speed": Spec(
        rows="frame", dtype="f8", units="m s-1", **_FRAME,
        text="change of depth in time in that piece: 0 in a hold, negative in a retraction",
    ),
    "dissipated_energy": Spec(
        rows="frame", dtype="f8", units="J", **_FRAME,
        text="energy that the block's material has lost since first touch (viscosity, softening)",
    ),
}

# only in stores where pokes that differ by a factor of the moduli share one solve
DERIVED_SPECS: dict[str, Spec] = {
    "solved_as": Spec(
        rows="poke", dtype="i4",
        text="poke whose solve this is: itself, or an earlier one that differs by the modulus alone; such a"
        " poke moves as that one, and its solver counters are 0",
    ),
    "force_factor": Spec(
        rows="poke", dtype="f8", units="1", text="by which the forces of that solve are multiplied"
    ),
}

# in place of the arrays of these names in stores whose shapes have blocks of their own
BLOCK_SPECS: dict[str, Spec] = {
    "grid_rest": Spec(
        rows="geometry", dtype="f8", units="m", chunk=64, shard=64,
        dims=("grid_row", "grid_column", "axis"), row=(SIZE, SIZE, 3),
        text="rest positions of the grid on the top face of the block; rows along y, columns along x",
    ),
    "level_depth": Spec(
        rows="geometry", dtype="f8", units="m", chunk=64, shard=64, dims=("level",), row=(LEVELS,),
        text="depth below the rest surface of each profile level",
    ),
}

FIRST_DIMENSION: dict[Rows, str] = {
    "poke": "poke", "frame": "frame", "node": "surface_node", "triangle": "surface_triangle_row",
    "value": "surface_value", "geometry": "geometry",
}
# fmt: on
FIXED_DIMENSION = {"grid_rest": "grid_row", "level_depth": "level"}


def specs_of(identity: Mapping[str, Any]) -> dict[str, Spec]:
    """Specifications of a store's arrays, by name, from a plan's identity."""
    return {
        **SPECS,
        **(BLOCK_SPECS if any("block_mm" in shape for shape in identity["recipe"]["shapes"]) else {}),
        **(COURSE_SPECS if identity["recipe"]["protocol"].get("course") else {}),
        **(DERIVED_SPECS if identity.get("one_solve") else {}),
    }
