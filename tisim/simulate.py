"""The one entry: scenes go in, results come out, many at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import as_completed
from contextlib import closing
from dataclasses import replace

import numpy as np
import scipy.linalg  # noqa: F401 - loads scipy's BLAS, so that its threads can be limited
from loky import cpu_count
from loky.process_executor import BrokenProcessPool
from threadpoolctl import threadpool_limits

from tisim import _pool
from tisim._batch import Chunk, make_chunks, solve_chunk
from tisim._validate import check_scene
from tisim.mesh import Mesh
from tisim.result import Result
from tisim.scene import Coupon, Press, Scene

Progress = Callable[[int, int], None]

# MKL may otherwise take another path for another alignment of memory, and the bytes would differ; it
# reads this when it is first called, which is after this import.
os.environ.setdefault("MKL_CBWR", "AUTO,STRICT")


def simulate(
    scenes: Sequence[Scene], *, workers: int | None = None, progress: Progress | None = None
) -> list[Result]:
    """Solve scenes of any kinds, meshes, laws, parameters and loads; results in the order of the scenes.

    workers: processes to spread the scenes over, each solving one scene at a time on one core. 1 solves
        in this process. None takes all cores, and this process alone while the work saved so far is less
        than starting processes costs (about 3 s once; they stay for the next call).
    progress: called here as progress(done, total) when scenes are finished.

    Bad scenes raise ValueError, naming the scene by its index, before anything is solved. A scene that
    has no answer raises nothing: its `Result.status` says so, and its good frames are kept.
    Results are the same bytes whatever `workers` is. Beams on one mesh are solved in runs of up to
    `tisim._batch.RUN` neighbours in parameters, each started from the one before, so a beam's answer
    depends on its batch by less than the solver's tolerance (and 1e-4 of the angles of clamps that yield).
    A worker process that dies (killed, out of memory) is replaced and its scenes are solved again, once.

    Memory grows linearly in the batch: a result holds 24 bytes a node and frame (default beam of 100 mm:
    1,015 nodes, 26 kB; poke of 3,500 nodes and 20 frames: 1.7 MB) and shares its mesh with the results of the
    same beam. Each process holds besides one scene's matrices (beam: 10 MB) and the layouts of the last
    16 beam meshes (7 MB each), whatever the size of the batch.
    """
    scenes = list(scenes)
    if workers is not None and (not isinstance(workers, int) or workers < 1):
        raise ValueError(f"workers: expected a whole number of at least 1 or None, got {workers!r}")
    for index, scene in enumerate(scenes):
        check_scene(index, scene)
    chunks = make_chunks(scenes)
    if workers is None:
        workers = cpu_count() if _pool.pays_off([c.seconds for c in chunks], cpu_count()) else 1
    found: dict[int, Result] = {}
    meshes: dict[object, Mesh] = {}
    apart = workers > 1 and len(chunks) > 1
    with closing(_solve_apart(chunks, workers) if apart else _solve_here(chunks)) as solving:
        for chunk, index, result in solving:
            mesh = _same_mesh(scenes[index], meshes.setdefault(chunk.mesh_key, result.mesh))
            found[index] = replace(result, scene=scenes[index], mesh=mesh)
            if progress is not None:
                progress(len(found), len(scenes))
    return [found[index] for index in range(len(scenes))]


def _same_mesh(scene: Scene, mesh: Mesh) -> Mesh:
    """The scene's own mesh, where `mesh` is a copy of it that came back from another process."""
    own = None if isinstance(scene, Coupon | Press) else scene.mesh
    return mesh if own is None or not np.array_equal(own.nodes, mesh.nodes) else own


def _solve_here(chunks: list[Chunk]) -> Generator[tuple[Chunk, int, Result]]:
    # BLAS threads that spin while they wait cost a factor; scipy's BLAS is there, being imported above
    with threadpool_limits(1):
        for chunk in chunks:
            for index, result in solve_chunk(chunk):
                yield chunk, index, result


def _solve_apart(chunks: list[Chunk], workers: int) -> Generator[tuple[Chunk, int, Result]]:
    waiting = chunks
    for attempt in range(2):
        dead: list[Chunk] = []
        futures = _pool.submit(waiting, workers)
        try:
            for future in as_completed(futures):
                try:
                    solved = future.result()
                except BrokenProcessPool:
                    dead.append(futures[future])
                    continue
                for index, result in solved:
                    yield futures[future], index, result
        except BaseException:  # an error, Ctrl-C, GeneratorExit: nothing goes on behind the caller's back
            _pool.stop(futures)
            raise
        if not dead:
            return
        waiting = dead
        if attempt == 1:
            lost = sorted(index for chunk in dead for index in chunk.indices)
            raise RuntimeError(
                f"a worker process died twice, the second time with scenes {_some(lost)} unfinished:"
                " it was killed from outside, or ran out of memory (fewer workers need less)"
            )


def _some(indices: list[int]) -> str:
    shown = ", ".join(str(i) for i in indices[:8])
    return shown + (f" and {len(indices) - 8} more" if len(indices) > 8 else "")
