"""What must hold in a finished store; each check returns its faults as sentences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from factory._grid import SIZE
from factory._layout import SPECS
from factory._manifest import manifest_faults
from factory._profile import LEVELS
from factory._record import STATUSES
from factory.reader import Dataset

FORCE_BALANCE = 0.01  # of the rod's force
FORCE_FLOOR = 1e-3  # N: forces below that are compared with it instead
TIP_SLACK = 0.01  # of the frame spacing

Check = Callable[[Dataset], list[str]]


def checksums(data: Dataset) -> list[str]:
    """Every file is the one the manifest was written for."""
    return manifest_faults(data.path)


def shapes(data: Dataset) -> list[str]:
    """Arrays are all there, with the shapes that the poke table says."""
    faults = []
    for name in SPECS:
        if name not in data.group:
            faults.append(f"{name}: missing")
    if faults:
        return faults
    table = data.table
    counts = {
        "poke": data.n_pokes,
        "geometry": len(data.attributes["shapes"]) * len(data.attributes["softness"]),
        **{kind: int(table[f"{kind}_count"].sum()) for kind in ("frame", "node", "triangle", "value")},
    }
    for name, spec in SPECS.items():
        shape = data.array(name).shape
        if spec.rows != "fixed" and shape[0] != counts[spec.rows]:
            faults.append(f"{name}: {shape[0]} rows, expected {counts[spec.rows]}")
        if spec.row and spec.rows != "fixed" and shape[1:] != spec.row:
            faults.append(f"{name}: rows of shape {shape[1:]}, expected {spec.row}")
    if data.array("profile").shape[1:] != (SIZE, SIZE, LEVELS):
        faults.append("profile: wrong shape")
    for kind in ("frame", "node", "triangle", "value"):
        count = table[f"{kind}_count"]
        if not np.array_equal(table[f"{kind}_start"], np.cumsum(count) - count):
            faults.append(f"{kind}_start: does not add up the counts")
    if not np.array_equal(table["value_count"], table["frame_count"] * table["node_count"]):
        faults.append("value_count: is not frames times surface nodes")
    if not np.array_equal(table["frame_poke"], np.repeat(np.arange(data.n_pokes), table["frame_count"])):
        faults.append("frame_poke: does not match frame_start and frame_count")
    return faults


def finite(data: Dataset) -> list[str]:
    """No NaN and no infinity anywhere; triangles point at nodes of their poke."""
    faults = []
    for name, spec in SPECS.items():
        if spec.dtype.startswith("f"):
            array = data.array(name)
            for start in range(0, max(array.shape[0], 1), spec.shard):
                if not np.isfinite(array[start : start + spec.shard]).all():
                    faults.append(f"{name}: has values that are not finite")
                    break
    for index in range(data.n_pokes):
        triangles = data.array("surface_triangle")[data.rows(index, "triangle")]
        if triangles.size and (triangles.min() < 0 or triangles.max() >= data.table["node_count"][index]):
            faults.append(f"poke {index}: a surface triangle has no such node")
    return faults


def statuses(data: Dataset) -> list[str]:
    """Every poke is done or has an error text, and says why it ended."""
    faults = []
    table = data.table
    for index in range(data.n_pokes):
        if not table["done"][index]:
            faults.append(f"poke {index}: failed: {data.message(index) or 'without an error text'}")
        elif table["status"][index] >= len(STATUSES):
            faults.append(f"poke {index}: status {table['status'][index]} is unknown")
        elif table["status"][index] != 0 and not data.message(index):
            faults.append(f"poke {index}: ended as {data.status(index)} without a message")
        elif table["frame_count"][index] == 0:
            faults.append(f"poke {index}: has no frame ({data.message(index)})")
    return faults


def equilibrium(data: Dataset) -> list[str]:
    """Every frame converged: residual, turned elements, penetration of the rod's edge."""
    table = data.table
    rod = data.attributes["identity"]["recipe"]["rod"]
    round_mm = rod["edge_radius_mm"] if rod["tip"] == "flat" else rod["radius_mm"]
    tolerance = float(data.attributes["solver_tolerance"])
    return [
        *_frames(data, table["residual"] > tolerance, f"residual above {tolerance:g}"),
        *_frames(data, table["min_jacobian"] <= 0, "an element turned over"),
        *_frames(
            data,
            table["penetration"] > 0.5e-3 * round_mm,
            f"penetration above half the edge radius ({0.5 * round_mm:g} mm)",
        ),
    ]


def forces(data: Dataset) -> list[str]:
    """The reaction of the fixed nodes is the force on the rod."""
    rod, base = data.table["rod_force"], data.table["base_force"]
    size = np.maximum(np.linalg.norm(rod, axis=1), FORCE_FLOOR)
    gap = np.linalg.norm(base - rod, axis=1) / size
    return _frames(data, gap > FORCE_BALANCE, f"base reaction is not the rod's force to {FORCE_BALANCE:.0%}")


def motion(data: Dataset) -> list[str]:
    """Frames lie on the rod's path, deeper one by one, apart by the spacing (the last may be nearer)."""
    table = data.table
    recipe = data.attributes["identity"]["recipe"]
    spacing = recipe["protocol"]["frame_spacing_mm"] * 1e-3
    poke = table["frame_poke"]
    expected = table["path_start"][poke] + table["depth"][:, None] * table["direction"][poke]
    off = np.linalg.norm(table["rod_tip"] - expected, axis=1) > 1e-6
    same = poke[1:] == poke[:-1]
    step = np.diff(table["depth"])
    last = np.append(poke[1:] != poke[:-1], True)[1:]
    close = np.append(False, same & ((step <= 0) | ((step < (1 - TIP_SLACK) * spacing) & ~last)))
    return [
        *_frames(data, off, "the tip is off the rod's path"),
        *_frames(data, close[: len(poke)], "nearer to the frame before than the spacing"),
    ]


def _frames(data: Dataset, bad: NDArray[np.bool_], what: str) -> list[str]:
    """One fault a poke: how many of its frames, and the first."""
    faults = []
    for index in np.unique(data.table["frame_poke"][bad]):
        rows = data.rows(int(index), "frame")
        those = np.flatnonzero(bad[rows])
        faults.append(f"poke {index}: {what} in {len(those)} frames (first: frame {those[0]})")
    return faults


CHECKS: dict[str, Check] = {
    "checksums": checksums,
    "shapes": shapes,
    "finite values": finite,
    "statuses": statuses,
    "equilibrium of each frame": equilibrium,
    "base reaction = rod force": forces,
    "rod path and spacing": motion,
}
