"""`simulate`: the solution of scenes, one or many at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import as_completed
from contextlib import closing
from dataclasses import replace
from typing import Any, overload

import numpy as np

from tisim._checks import check_whole
from tisim.mesh import Mesh
from tisim.parallel import pool
from tisim.parallel.chunks import Chunk, make_chunks, own_mesh, solve_chunk
from tisim.parallel.threads import one_thread
from tisim.problems import check_scene
from tisim.result import Result
from tisim.scene import Scene

Progress = Callable[[float, int], None]

# Otherwise MKL may take different code paths for different memory alignments, and results would differ in
# their bytes. MKL reads the variable at its first call, which is after this import.
os.environ.setdefault("MKL_CBWR", "AUTO,STRICT")


@overload
def simulate(scenes: Scene, *, workers: int | None = None, on_progress: Progress | None = None) -> Result: ...


@overload
def simulate(
    scenes: Sequence[Scene], *, workers: int | None = None, on_progress: Progress | None = None
) -> list[Result]: ...


def simulate(
    scenes: Any, *, workers: int | None = None, on_progress: Progress | None = None
) -> Result | list[Result]:
    """Solve scenes of any kinds, meshes, laws, parameters and loads.

    Parameters
    ----------
    scenes : Scene or sequence of Scene
        One scene, or many.
    workers : int, optional
        Number of processes, each solving one scene at a time on one core. With 1, scenes are solved in this
        process. None uses all cores, but only this process as long as the time that processes would have
        saved so far is less than the cost of starting them (about 3 s once; they are kept for later calls).
    on_progress : callable (done, total), optional
        Called in this process after each scene, with the number of finished scenes. For a scene of several
        steps (depths, stretches, times) that is solved in this process, it is also called on the way, with a
        fractional number.

    Returns
    -------
    Result or list of Result
        The result of the one scene, or results in the order of the scenes.

    Raises
    ------
    TypeError
        If `scenes` is neither a scene nor a sequence.
    ValueError
        For invalid scenes, before anything is solved; the message names the first by its index. A scene
        without a solution raises nothing: its `Result.status` states the failure, and the frames before it
        are kept.
    RuntimeError
        If a worker process died twice. A worker that dies (killed, out of memory) is replaced, and its scenes
        are solved again, once.

    Notes
    -----
    Results are identical to the byte for any number of workers. Beams on one mesh are solved in chains of up
    to `tisim.parallel.chunks.CHAIN` neighbours in parameters, each started from the previous one, so that the
    solution of a beam depends on its batch by less than the solver's tolerance (and 1e-4 of the angles of
    compliant clamps, and of the deflection of a beam with a course, in whose history errors add up).

    Calls from several threads of one process wait for one another, where they solve in that process.

    Memory grows linearly with the batch: a result takes 24 bytes per node and frame (default beam of 100 mm:
    1,015 nodes, 26 kB; poke of 3,500 nodes and 20 frames: 1.7 MB) and shares its mesh with the results of the
    same beam. In addition each process holds the matrices of one scene (beam: 10 MB) and the data of the last
    16 beam meshes (7 MB each), for any size of the batch.
    """
    if not isinstance(scenes, Sequence):
        if hasattr(scenes, "__iter__"):
            scenes = list(scenes)
        elif hasattr(scenes, "material"):
            return _simulate([scenes], workers, on_progress)[0]
        else:
            wanted = "a scene or a sequence of scenes"
            raise TypeError(f"scenes: expected {wanted}, got {type(scenes).__name__}")
    return _simulate(list(scenes), workers, on_progress)


def _simulate(scenes: list[Any], workers: int | None, on_progress: Progress | None) -> list[Result]:
    if workers is not None:
        check_whole("workers", workers)
    for index, scene in enumerate(scenes):
        check_scene(index, scene)
    chunks = make_chunks(scenes)
    if workers is None:
        cores = pool.cores()
        workers = cores if pool.pays_off([c.seconds for c in chunks], cores) else 1
    found: dict[int, Result] = {}
    meshes: dict[object, Mesh] = {}

    def within(fraction: float) -> None:
        if on_progress is not None and 0.0 < fraction < 1.0:
            on_progress(len(found) + fraction, len(scenes))

    apart = workers > 1 and len(chunks) > 1
    with closing(_solve_apart(chunks, workers) if apart else _solve_here(chunks, within)) as solving:
        for chunk, index, result in solving:
            mesh = _same_mesh(scenes[index], meshes.setdefault(chunk.mesh_key, result.mesh))
            found[index] = replace(result, scene=scenes[index], mesh=mesh)
            if on_progress is not None:
                on_progress(len(found), len(scenes))
    return [found[index] for index in range(len(scenes))]


def _same_mesh(scene: Any, mesh: Mesh) -> Mesh:
    """The mesh supplied with the scene if `mesh` is a copy of it from another process, else `mesh`."""
    own = own_mesh(scene)
    return mesh if own is None or not np.array_equal(own.nodes, mesh.nodes) else own


def _nothing(_: float) -> None: ...


def _solve_here(
    chunks: list[Chunk], on_step: Callable[[float], None] = _nothing
) -> Generator[tuple[Chunk, int, Result]]:
    with one_thread():
        for chunk in chunks:
            for index, result in solve_chunk(chunk, on_step):
                yield chunk, index, result


def _solve_apart(chunks: list[Chunk], workers: int) -> Generator[tuple[Chunk, int, Result]]:
    from loky.process_executor import BrokenProcessPool

    waiting = [chunk for chunk in chunks if chunk.extensions is not None]
    for attempt in range(2):
        dead: list[Chunk] = []
        futures = pool.submit(waiting, workers)
        try:
            if attempt == 0:  # scenes that cannot be sent are solved here while the workers run
                yield from _solve_here([chunk for chunk in chunks if chunk.extensions is None])
            for future in as_completed(futures):
                try:
                    solved = future.result()
                except BrokenProcessPool:
                    dead.append(futures[future])
                    continue
                for index, result in solved:
                    yield futures[future], index, result
        except BaseException:  # an error, Ctrl-C, GeneratorExit: leave nothing running
            pool.stop(futures)
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
