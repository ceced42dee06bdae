"""One simulated poke as arrays, and those arrays as bytes that depend on nothing else."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from factory._grid import SIZE, grid_points, interpolation
from factory._surface import surface_triangles
from tisim.result import Result, Status
from tisim.scene import Poke

STATUSES = tuple(Status)
COUNTERS = ("steps", "newton_iterations", "factorisations", "linear_iterations", "step_cuts")
Arrays = dict[str, NDArray[np.generic]]


@dataclass(frozen=True)
class Outcome:
    """What came back from one poke: its bytes, or the text of what went wrong.

    wall and core: seconds it took; they go to the ledger, never into the store's arrays.
    """

    index: int
    payload: bytes | None
    error: str | None
    wall: float = 0.0
    core: float = 0.0


def record(scene: Poke, result: Result) -> Arrays:
    """The arrays stored for one poke (names and units as in `_layout`)."""
    mesh = result.mesh
    if mesh.symmetry:
        raise ValueError("the poke came back on a mesh cut by a mirror plane: expected the whole block")
    frames = len(result.load)
    displacement = result.positions - mesh.nodes
    nodes, triangles = surface_triangles(mesh.facet_sets["surface"])
    points = grid_points(scene.block.size)
    at_grid = interpolation(mesh.nodes, mesh.facet_sets["top"], points.reshape(-1, 3))
    direction = np.asarray(scene.direction) / np.linalg.norm(scene.direction)
    start = result.rod_tip[0] - result.load[0] * direction if frames else first_touch(scene)
    arrays: Arrays = {
        "depth": result.load,
        "rod_tip": result.rod_tip,
        "rod_force": result.rod_force,
        "base_force": result.support_force,
        "penetration": result.penetration,
        "min_jacobian": result.min_jacobian,
        "residual": result.residual,
        "grid_displacement": at_grid(displacement).reshape(frames, SIZE, SIZE, 3).astype(np.float32),
        "surface_displacement": displacement[:, nodes].astype(np.float32),
        "surface_rest": mesh.nodes[nodes],
        "surface_triangle": triangles,
        "path_start": start,
        "path_end": start + scene.depth * direction,
        "mesh_nodes": np.array(mesh.n_nodes, dtype=np.int64),
        "mesh_elements": np.array(mesh.n_elements, dtype=np.int64),
        "status": np.array(STATUSES.index(result.status), dtype=np.uint8),
        "message": np.frombuffer(result.message.encode(), dtype=np.uint8),
        "counters": np.array([getattr(result.cost, name) for name in COUNTERS], dtype=np.int64),
    }
    arrays = {name: np.asarray(value, order="C") for name, value in arrays.items()}
    for name, value in arrays.items():
        if value.dtype.kind == "f" and not np.isfinite(value.astype(np.float64)).all():
            raise ValueError(f"the simulator returned values of {name} that are not finite")
    return arrays


def first_touch(scene: Poke) -> NDArray[np.float64]:
    """Centre of the rod's tip [m] where the rod first touches the undeformed top."""
    direction = np.asarray(scene.direction) / np.linalg.norm(scene.direction)
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
