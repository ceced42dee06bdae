"""Convert a simulated poke to arrays, and these to bytes that depend on nothing else."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory.plan.poke import PlannedPoke
from factory.recipe.course import deepest, states_at
from factory.sampling import SIZE, grid_points, interpolation, surface_triangles
from tisim.result import Result, Status
from tisim.scene import Poke

STATUSES = tuple(status for status in Status if status is not Status.NOT_MESHED)  # of stored pokes
COUNTERS = ("steps", "newton_iterations", "factorisations", "linear_iterations", "step_cuts")
Arrays = dict[str, NDArray[np.generic]]

# arrays of `record`: kind of number and shape; a word names a count common to the arrays
_SHAPES: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "depth": ("f", ("frames",)),
    "rod_tip": ("f", ("frames", 3)),
    "rod_force": ("f", ("frames", 3)),
    "base_force": ("f", ("frames", 3)),
    "penetration": ("f", ("frames",)),
    "min_jacobian": ("f", ("frames",)),
    "residual": ("f", ("frames",)),
    "grid_displacement": ("f", ("frames", SIZE, SIZE, 3)),
    "surface_displacement": ("f", ("frames", "nodes", 3)),
    "surface_rest": ("f", ("nodes", 3)),
    "surface_triangle": ("i", ("triangles", 3)),
    "path_start": ("f", (3,)),
    "path_end": ("f", (3,)),
    "mesh_nodes": ("i", ()),
    "mesh_elements": ("i", ()),
    "status": ("u", ()),
    "message": ("u", ("bytes",)),
    "counters": ("i", (len(COUNTERS),)),
}
# further arrays of a poke with a course
_OF_TIME: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "time": ("f", ("frames",)),
    "phase": ("u", ("frames",)),
    "rod_speed": ("f", ("frames",)),
    "dissipated_energy": ("f", ("frames",)),
}
_NEAR = 1e-6  # m: tolerance on the planned path


@dataclass(frozen=True)
class Outcome:
    """Result of one poke: its arrays as bytes, or an error text.

    Attributes
    ----------
    index : int
        Index of the poke in its plan.
    payload : bytes or None
        The arrays (see `encode`); None if the poke failed.
    error : str or None
        Reason of the failure.
    wall, core : float
        Wall and core time [s]; they go to the ledger, never into the store's arrays.
    """

    index: int
    payload: bytes | None
    error: str | None
    wall: float = 0.0
    core: float = 0.0


@dataclass(frozen=True, eq=False)
class Trace:
    """One poke in the preview.

    Attributes
    ----------
    depth, force : ndarray, shape (frames,)
        Travel of the indenter [m] and magnitude of the force on it [N].
    grid : ndarray, shape (32, 32, 3), or None
        Displacement of the grid in the deepest frame [m].
    """

    depth: NDArray[np.float64]
    force: NDArray[np.float64]
    grid: NDArray[np.float32] | None


def record(scene: Poke, result: Result) -> Arrays:
    """Arrays stored for one poke (named as in `store.schema`); ValueError if the result is invalid."""
    mesh = result.mesh
    if result.status is Status.NOT_MESHED:
        raise ValueError(result.message)
    if mesh.symmetry:
        raise ValueError("the poke came back on a mesh cut by a mirror plane: expected the whole block")
    if result.rod_tip is None or result.rod_force is None or result.penetration is None:
        raise ValueError("the poke came back without the rod's tip, force and penetration")
    frames = len(result.load)
    tip, force, penetration = result.rod_tip, result.rod_force, result.penetration
    if tip is None or force is None or penetration is None:
        raise ValueError("the simulator returned no indenter: expected the result of a poke")
    displacement = result.positions - mesh.nodes
    nodes, triangles = surface_triangles(mesh.facet_sets["surface"])
    points = grid_points(scene.block.size)
    at_grid = interpolation(mesh.nodes, mesh.facet_sets["top"], points.reshape(-1, 3))
    direction = unit(scene.direction)
    start = tip[0] - result.load[0] * direction if frames else first_touch(scene)
    arrays: Arrays = {
        "depth": result.load,
        "rod_tip": tip,
        "rod_force": force,
        "base_force": result.support_force,
        "penetration": penetration,
        "min_jacobian": result.min_jacobian,
        "residual": result.residual,
        "grid_displacement": at_grid(displacement).reshape(frames, SIZE, SIZE, 3).astype(np.float32),
        "surface_displacement": displacement[:, nodes].astype(np.float32),
        "surface_rest": mesh.nodes[nodes],
        "surface_triangle": triangles,
        "path_start": start,
        "path_end": start + deepest(scene) * direction,
        "mesh_nodes": np.array(mesh.n_nodes, dtype=np.int64),
        "mesh_elements": np.array(mesh.n_elements, dtype=np.int64),
        "status": np.array(STATUSES.index(result.status), dtype=np.uint8),
        "message": np.frombuffer(result.message.encode(), dtype=np.uint8),
        "counters": np.array([getattr(result.cost, name) for name in COUNTERS], dtype=np.int64),
        **_of_time(scene, result),
    }
    arrays = {name: np.asarray(value, order="C") for name, value in arrays.items()}
    for name, value in arrays.items():
        if value.dtype.kind == "f" and not np.isfinite(value.astype(np.float64)).all():
            raise ValueError(f"the simulator returned values of {name} that are not finite")
    return arrays


def _of_time(scene: Poke, result: Result) -> Arrays:
    """Further arrays of a poke with a course; empty without one."""
    if scene.course is None:
        return {}
    if result.time is None:
        raise ValueError("the poke came back without the time of its frames: expected that of a course")
    corners = np.array(scene.course.times), np.array(scene.course.values)
    states = states_at(*corners, result.time)
    lost = np.zeros(len(result.time)) if result.dissipated is None else result.dissipated
    return {
        "time": result.time,
        "phase": states["phase"],
        "rod_speed": states["rod_speed"],
        "dissipated_energy": lost,
    }


def check_arrays(arrays: Mapping[str, NDArray[Any]], poke: PlannedPoke) -> None:
    """Read every array of a staged result; ValueError or KeyError if it is not this poke's result.

    Results staged by earlier versions do not name their poke; their path identifies it.
    """
    if "poke" in arrays and int(arrays["poke"]) != poke.index:
        raise ValueError(f"is the result of poke {int(arrays['poke'])}")
    counts: dict[str, int] = {}
    expected = _SHAPES if poke.scene.course is None else {**_SHAPES, **_OF_TIME}
    for name, (kind, shape) in expected.items():
        array = arrays[name]
        fits = array.dtype.kind == kind and array.ndim == len(shape)
        if not fits or any(
            counts.setdefault(wanted, found) != found if isinstance(wanted, str) else wanted != found
            for wanted, found in zip(shape, array.shape, strict=True)
        ):
            raise ValueError(f"array {name} has type {array.dtype} and shape {array.shape}")
        if kind == "f" and not np.isfinite(array).all():
            raise ValueError(f"array {name} has values that are not finite")
    if int(arrays["status"]) >= len(STATUSES):
        raise ValueError(f"status {int(arrays['status'])} is unknown")
    triangles = arrays["surface_triangle"]
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < counts["nodes"]):
        raise ValueError("a surface triangle has no such node")
    scene, direction = poke.scene, unit(poke.scene.direction)
    start, travel = arrays["path_start"], arrays["path_end"] - arrays["path_start"]
    at_top = start + (scene.block.size[2] - start[2]) / direction[2] * direction
    away = max(
        float(np.abs(travel - deepest(scene) * direction).max()),
        float(np.abs(at_top[:2] - np.asarray(scene.site)).max()),
    )
    if not away <= _NEAR:
        raise ValueError("is the result of another scene: its path is not the planned one")


def unit(direction: tuple[float, float, float]) -> NDArray[np.float64]:
    """The direction as a unit vector (3,)."""
    return np.asarray(direction) / np.linalg.norm(direction)


def first_touch(scene: Poke) -> NDArray[np.float64]:
    """Centre of the indenter's tip [m] where the indenter first touches the undeformed top."""
    direction = unit(scene.direction)
    cosine, sine = -float(direction[2]), math.hypot(float(direction[0]), float(direction[1]))
    rod = scene.rod
    round_part = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
    # the lowest point of the tip lies on a ball (or torus) of `round_part` set back along the axis
    above = round_part * (1 - cosine) + (rod.radius - round_part) * sine
    site = np.array([*scene.site, scene.block.size[2]])
    return site - direction * (above / cosine)


def encode(arrays: Arrays) -> bytes:
    """The arrays as an .npz file: no time stamps, so equal arrays give equal bytes."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()
