"""Simulators that replace tisim in tests: fast, deterministic, and able to fail on command.

They are controlled by environment variables, which the worker processes inherit:
STANDIN_SECONDS: time to sleep in each poke.
STANDIN_FAIL: comma-separated site codes (see `site_code`): these pokes raise.
STANDIN_DIE: a site code: this poke kills its worker, every time.
STANDIN_LOG: file to which one line is appended for each simulated poke.
STANDIN_KILL: path of a file; the first worker that can remove it kills itself.
"""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np

from tisim.mesh import Mesh, boundary_facets
from tisim.result import Cost, Result, Status
from tisim.scene import Poke


def block_mesh(size: tuple[float, float, float], cells: tuple[int, int, int]) -> Mesh:
    """Regular hexahedral block with its base at z = 0, centred in x and y."""
    nx, ny, nz = cells
    axes = [
        np.linspace(-size[0] / 2, size[0] / 2, nx + 1),
        np.linspace(-size[1] / 2, size[1] / 2, ny + 1),
        np.linspace(0, size[2], nz + 1),
    ]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.arange(len(nodes)).reshape(nx + 1, ny + 1, nz + 1)
    low = [index[:-1, :-1, :-1], index[1:, :-1, :-1], index[1:, 1:, :-1], index[:-1, 1:, :-1]]
    high = [index[:-1, :-1, 1:], index[1:, :-1, 1:], index[1:, 1:, 1:], index[:-1, 1:, 1:]]
    elements = np.stack([c.ravel() for c in low + high], axis=1).astype(np.int32)
    surface = boundary_facets("hex8", elements)
    top = surface[(nodes[surface][:, :, 2] > size[2] - 1e-9).all(axis=1)]
    return Mesh(kind="hex8", nodes=nodes, elements=elements, facet_sets={"surface": surface, "top": top})


def simulate(scenes: list[Poke], *, workers: int | None = None) -> list[Result]:
    """Simulate with the signature of `tisim.simulate`."""
    assert workers == 1
    return [_poke(scene) for scene in scenes]


def _poke(scene: Poke) -> Result:
    if log := os.environ.get("STANDIN_LOG"):
        with Path(log).open("a") as file:
            file.write(f"{site_code(scene)} {scene.material.parameters}\n")
    if kill := os.environ.get("STANDIN_KILL"):
        try:
            Path(kill).unlink()
        except FileNotFoundError:
            pass
        else:
            os.kill(os.getpid(), signal.SIGKILL)
    if os.environ.get("STANDIN_DIE") == str(site_code(scene)):
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(float(os.environ.get("STANDIN_SECONDS", "0")))
    if str(site_code(scene)) in os.environ.get("STANDIN_FAIL", "").split(","):
        raise RuntimeError("the stand-in was told\nto fail")
    # meshes of different sizes, like the real ones
    mesh = block_mesh(scene.block.size, (6 + abs(site_code(scene)) % 3, 6, 2))
    frames = 3 + abs(site_code(scene)) % 4
    depth = scene.frame_spacing * np.arange(1, frames + 1)
    course: dict[str, np.ndarray] = {}
    if scene.course is not None:  # all frames of the course, with an energy that grows with the travel
        moments = np.array(scene.course.frames)
        depth = np.array([scene.course.value(t) for t in moments])
        lost = np.cumsum(np.abs(np.diff(depth, prepend=0.0))) * 1e-3
        course, frames = {"time": moments, "dissipated": lost}, len(moments)
    direction = np.asarray(scene.direction)
    distance = np.linalg.norm(mesh.nodes[:, :2] - np.asarray(scene.site), axis=1)
    sink = np.exp(-((distance / 0.02) ** 2)) * mesh.nodes[:, 2] / scene.block.size[2]
    positions = mesh.nodes + depth[:, None, None] * sink[:, None] * direction
    start = np.array([*scene.site, scene.block.size[2]])
    force = -direction * 100 * depth[:, None]
    return Result(
        scene=scene,
        status=Status.NOT_CONVERGED,
        message="the stand-in stops where it likes",
        mesh=mesh,
        load=depth,
        positions=positions,
        support_force=force,
        rod_force=force.copy(),
        rod_tip=start + depth[:, None] * direction,
        penetration=np.full(frames, 1e-5),
        min_jacobian=np.full(frames, 0.5),
        residual=np.full(frames, 1e-8),
        nominal_stress=np.zeros(frames),
        **course,
        cost=Cost(core_seconds=time.process_time(), steps=frames, newton_iterations=3 * frames),
    )


def site_code(scene: Poke) -> int:
    """x of the contact point [micrometres]: identifies a poke in these tests."""
    return round(scene.site[0] * 1e6)
