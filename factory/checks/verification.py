"""Checks of a finished store; each returns its faults as sentences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from factory.checks.clearance import clearance
from factory.errors import InputError, one_line
from factory.reader import Dataset, is_zip, open_dataset
from factory.recipe.course import PHASES, states_at
from factory.sampling import LEVELS, RIGID, SIZE, grid_points, inside, level_depths
from factory.simulation.record import STATUSES
from factory.store.archive import zip_faults
from factory.store.files import DamagedError, file_faults, manifest_faults

FORCE_BALANCE = 0.01  # relative to the indenter's force
FORCE_FLOOR = 1e-3  # N: least force that the balance is relative to
COURSE_SLACK = 1e-6  # relative to the course's depth, or to its speed
ENERGY_SLACK = 1e-9  # relative to the energy dissipated so far: rounding
TIP_SLACK = 0.01  # relative to the frame spacing
SAME_PLACE = 1e-9  # m: rounding of positions at rest

Check = Callable[[Dataset], list[str]]


@dataclass(frozen=True)
class Verification:
    """Faults found in a dataset.

    Attributes
    ----------
    path : Path
    faults : dict of str to list of str
        Sentences by name of the check; an empty list if it found none.
    pokes, frames : int
        Numbers checked; 0 if the dataset could not be opened, `frames` also if there are faults.
    waiting : int
        Number of pokes that a partial store lacks.
    """

    path: Path
    faults: dict[str, list[str]]
    pokes: int = 0
    frames: int = 0
    waiting: int = 0

    @property
    def total(self) -> int:
        """Number of faults."""
        return sum(len(found) for found in self.faults.values())


def verify_dataset(path: str | Path) -> Verification:
    """Check files, checksums, shapes, finite values, statuses and physics of a finished dataset.

    Raises
    ------
    InputError
        If there is no dataset of the factory. Damage is a fault, not an error.
    """
    folder = Path(path)
    faults: dict[str, list[str]] = {}
    data: Dataset | None = None
    try:
        data = open_dataset(folder)
    except DamagedError as error:
        faults["attributes"] = [str(error)]
    faults["files"] = _caught(lambda: file_faults(folder))
    sums = zip_faults if is_zip(folder) else manifest_faults
    faults["checksums"] = _caught(lambda: sums(folder))
    if data is None:
        return Verification(folder, faults)
    for name, check in CHECKS.items():
        faults[name] = _caught(lambda check=check: check(data))  # type: ignore[misc]
    if any(faults.values()):
        return Verification(folder, faults, data.n_pokes)
    waiting = len(data.waiting)
    return Verification(folder, faults, data.n_pokes - waiting, len(data.table["frame_poke"]), waiting)


def _caught(check: Callable[[], list[str]]) -> list[str]:
    """Run a check and return its faults; an exception that it raises is one."""
    try:
        return check()
    except InputError as error:
        return [str(error)]
    except Exception as error:  # a damaged file can break anywhere in the decoding
        return [f"cannot be checked ({type(error).__name__}: {one_line(error)})"]


def shapes(data: Dataset) -> list[str]:
    """Check that all arrays exist, with shapes that agree with the poke table."""
    present = set(data.group.array_keys())  # of all at once
    faults = [f"{name}: missing" for name in data.specs if name not in present]
    if faults:
        return faults
    table = data.table
    counts = {
        "poke": data.n_pokes,
        "geometry": len(data.shapes) * len(data.levels),
        **{kind: int(table[f"{kind}_count"].sum()) for kind in ("frame", "node", "triangle", "value")},
    }
    for name, spec in data.specs.items():
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
    shape, level = table["poke_shape"], table["poke_softness"]
    for name, codes, names in (("poke_shape", shape, data.shapes), ("poke_softness", level, data.levels)):
        if not ((codes >= 0) & (codes < len(names))).all():
            faults.append(f"{name}: has an index beyond the {len(names)} names")
    if not np.array_equal(table["poke_geometry"], shape * len(data.levels) + level):
        faults.append("poke_geometry: is not shape x material levels + level")
    if not np.array_equal(table["value_count"], table["frame_count"] * table["node_count"]):
        faults.append("value_count: is not frames times surface nodes")
    if not np.array_equal(table["frame_poke"], np.repeat(np.arange(data.n_pokes), table["frame_count"])):
        faults.append("frame_poke: does not match frame_start and frame_count")
    return faults


def finite(data: Dataset) -> list[str]:
    """Check that all values are finite, and that triangles refer to nodes of their poke."""
    faults = []
    for name, spec in data.specs.items():
        if spec.dtype.startswith("f"):
            if name in data.table:  # in memory: to read them again takes an eighth of all checks
                if not np.isfinite(data.table[name]).all():
                    faults.append(f"{name}: has values that are not finite")
                continue
            array = data.array(name)
            for start in range(0, max(array.shape[0], 1), spec.shard):
                if not np.isfinite(data.read(name, slice(start, start + spec.shard))).all():
                    faults.append(f"{name}: has values that are not finite")
                    break
    for index in range(data.n_pokes):
        triangles = data.read("surface_triangle", data.rows(index, "triangle"))
        if triangles.size and (triangles.min() < 0 or triangles.max() >= data.table["node_count"][index]):
            faults.append(f"poke {index}: a surface triangle has no such node")
    return faults


def statuses(data: Dataset) -> list[str]:
    """Check that every simulated poke succeeded and has frames, and a message if it ended early."""
    faults = []
    table, waiting = data.table, set(data.waiting)
    for index in range(data.n_pokes):
        if index in waiting:
            continue
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
    """Check the residual, det F and the penetration of the rod in every frame."""
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
    """Check that the reaction at the fixed nodes balances the force on the rod in every frame."""
    rod, base = data.table["rod_force"], data.table["base_force"]
    size = np.maximum(np.linalg.norm(rod, axis=1), FORCE_FLOOR)
    gap = np.linalg.norm(base - rod, axis=1) / size
    return _frames(data, gap > FORCE_BALANCE, f"base reaction is not the rod's force to {FORCE_BALANCE:.0%}")


# what a poke has in common with the one whose solve it takes, and what its rows count
_MOVED: dict[str, Literal["frame", "node", "triangle", "value"]] = {
    "grid_displacement": "frame",
    "surface_rest": "node",
    "surface_triangle": "triangle",
    "surface_displacement": "value",
}


def one_solve(data: Dataset) -> list[str]:
    """Check that pokes which reuse another's solve have its displacements and proportional forces."""
    table = data.table
    if "solved_as" not in table:
        return []
    faults = []
    derived = table["done"] & (table["solved_as"] != np.arange(data.n_pokes))
    for index in np.flatnonzero(derived).tolist():
        other, factor = int(table["solved_as"][index]), float(table["force_factor"][index])
        if not (0 <= other < index and table["solved_as"][other] == other):
            faults.append(f"poke {index}: takes the solve of poke {other}, which has none of its own")
            continue
        rows, its = data.rows(index, "frame"), data.rows(other, "frame")
        same = np.array_equal(table["depth"][rows], table["depth"][its])
        for name in ("rod_force", "base_force"):
            same &= np.array_equal(table[name][rows], factor * table[name][its])
        for name, count in _MOVED.items():
            own, theirs = (data.rows(k, count) for k in (index, other))
            same &= np.array_equal(data.read(name, own), data.read(name, theirs))
        if not same:
            faults.append(f"poke {index}: is not {factor:.4g} times the solve of poke {other}")
    return faults


def motion(data: Dataset) -> list[str]:
    """Check that frames lie on the rod's path and deepen by at least the spacing (the last may be nearer).

    With a course only the path is checked here; `clock` checks depths and times.
    """
    table = data.table
    recipe = data.attributes["identity"]["recipe"]
    spacing = recipe["protocol"]["frame_spacing_mm"] * 1e-3
    poke = table["frame_poke"]
    expected = table["path_start"][poke] + table["depth"][:, None] * table["direction"][poke]
    off = np.linalg.norm(table["rod_tip"] - expected, axis=1) > 1e-6
    if data.timed:
        return _frames(data, off, "the tip is off the rod's path")
    same = poke[1:] == poke[:-1]
    step = np.diff(table["depth"])
    last = np.append(poke[1:] != poke[:-1], True)[1:]
    close = np.append(False, same & ((step <= 0) | ((step < (1 - TIP_SLACK) * spacing) & ~last)))
    return [
        *_frames(data, off, "the tip is off the rod's path"),
        *_frames(data, close[: len(poke)], "nearer to the frame before than the spacing"),
    ]


def clock(data: Dataset) -> list[str]:
    """Check that time rises, depth, phase and speed follow the course, and dissipation never decreases."""
    if not data.timed:
        return []
    table = data.table
    poke, time, lost = table["frame_poke"], table["time"], table["dissipated_energy"]
    first = np.append(True, poke[1:] != poke[:-1])[: len(poke)]
    faults = []
    for index in range(data.n_pokes):
        corners = np.append(0.0, table["course_time"][index])
        if not (np.diff(corners) > 0.0).all() or (table["course_depth"][index] < 0.0).any():
            return [f"poke {index}: its course goes back in time or above the surface"]
    off = {name: np.zeros(len(poke), dtype=bool) for name in ("depth", "phase", "rod_speed")}
    for index in np.unique(poke):
        rows = data.rows(int(index), "frame")
        times, depths = table["course_time"][index], table["course_depth"][index]
        states = states_at(times, depths, time[rows])
        off["phase"][rows] = table["phase"][rows] != states["phase"]
        for name in ("depth", "rod_speed"):
            slack = COURSE_SLACK * max(float(np.abs(states[name]).max()), float(depths.max()))
            off[name][rows] = np.abs(table[name][rows] - states[name]) > slack
    early = np.where(first, time <= 0.0, np.diff(time, prepend=0.0) <= 0.0)
    gain = np.where(first, lost < 0.0, np.diff(lost, prepend=0.0) < -ENERGY_SLACK * np.abs(lost))
    faults += _frames(data, early, "not later than the frame before")
    faults += _frames(data, table["phase"] >= len(PHASES), "an unknown phase")
    for name, bad in off.items():
        faults += _frames(data, bad, f"{name} is not that of the rod's course")
    faults += _frames(data, gain, "energy dissipated before has come back")
    return faults


def blocks(data: Dataset) -> list[str]:
    """Check that grid, levels and the surface of every poke are those of the block that the recipe states."""
    faults = []
    for geometry in range(len(data.shapes) * len(data.levels)):
        block = data.block(geometry)
        for name, found, expected in (
            ("grid_rest", data.grid_rest(geometry), grid_points(block)),
            ("level_depth", data.level_depth(geometry), level_depths(block[2])),
        ):
            if found.shape != expected.shape or not np.allclose(found, expected, rtol=0.0, atol=SAME_PLACE):
                faults.append(f"geometry {geometry}: {name} is not that of its block")
    for index in np.flatnonzero(data.table["done"]).tolist():
        block = data.block(int(data.table["poke_geometry"][index]))
        rest = data.read("surface_rest", data.rows(index, "node"))
        corners = np.array([rest.min(axis=0), rest.max(axis=0)])
        expected = np.array([(-block[0] / 2, -block[1] / 2, 0.0), (block[0] / 2, block[1] / 2, block[2])])
        if not np.allclose(corners, expected, rtol=0.0, atol=SAME_PLACE):
            faults.append(f"poke {index}: its surface at rest is not that of its block")
    return faults


def inclusion_profiles(data: Dataset) -> list[str]:
    """Check that the rigid part of every stiffness profile is the inclusion that the store describes."""
    faults = []
    of: tuple[dict[str, Any], NDArray[np.float64]] | None = None  # what `rigid` was computed of
    for geometry in range(len(data.shapes) * len(data.levels)):
        try:
            inclusion = data.inclusion(geometry)
        except InputError as error:
            faults.append(str(error))
            continue
        grid = data.grid_rest(geometry)
        described = inclusion.encode()
        # its levels have one body
        if of is None or of[0] != described or not np.array_equal(of[1], grid):
            rigid, of = inside(grid, float(grid[0, 0, 2]), inclusion), (described, grid)
        if not np.array_equal(data.read("profile", geometry) == round(255 * RIGID), rigid):
            faults.append(
                f"geometry {geometry}: the profile's rigid part is not the {inclusion.kind} described"
            )
    return faults


def _frames(data: Dataset, bad: NDArray[np.bool_], what: str) -> list[str]:
    """One fault per poke with bad frames: their number and the first."""
    faults = []
    for index in np.unique(data.table["frame_poke"][bad]):
        rows = data.rows(int(index), "frame")
        those = np.flatnonzero(bad[rows])
        faults.append(f"poke {index}: {what} in {len(those)} frames (first: frame {those[0]})")
    return faults


CHECKS: dict[str, Check] = {
    "shapes": shapes,
    "finite values": finite,
    "statuses": statuses,
    "blocks": blocks,
    "inclusions": inclusion_profiles,
    "equilibrium of each frame": equilibrium,
    "base reaction = rod force": forces,
    "solves taken over": one_solve,
    "rod path and spacing": motion,
    "indenter outside rigid bodies": clearance,
    "time, phase and energy": clock,
}
