"""A batch as chunks: scenes that share a mesh follow one another, neighbours in parameters side by side."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from tisim import laws
from tisim.mesh import Mesh
from tisim.result import Result
from tisim.scene import Beam, Coupon, Poke, Press, Scene

# Beams of a run start from one another: the cut into runs is part of the answer's bytes, so it must not
# depend on the number of workers. Eight keep many cores busy and pay for the layout and the cold start.
RUN = 8

# Rough core-seconds of a scene, to decide where to solve it and to begin with the longest.
_SECONDS_PER_BEAM_NODE = 5e-5
_SECONDS = {"coupon": 0.05, "poke": 10.0, "press": 2.0, "dynamic": 20.0}


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Scenes solved one after the other in one process.

    mesh_key: equal for scenes that live on the same mesh. seconds: guess of the work [core-s].
    """

    indices: tuple[int, ...]
    scenes: tuple[Scene, ...]
    mesh_key: Any
    seconds: float


def make_chunks(scenes: Sequence[Scene]) -> list[Chunk]:
    """Chunks of a batch, the longest first; depends on the scenes alone."""
    digests: dict[int, str] = {}
    keys = [_mesh_key(index, scene, digests) for index, scene in enumerate(scenes)]
    order = sorted(range(len(scenes)), key=lambda i: (repr(keys[i]), *_neighbourhood(scenes[i]), i))
    chunks = []
    for _, members in groupby(order, key=lambda i: repr(keys[i])):
        group = list(members)
        runs = -(-len(group) // RUN)
        for k in range(runs):  # runs of nearly equal length
            run = group[k * len(group) // runs : (k + 1) * len(group) // runs]
            chunks.append(
                Chunk(
                    indices=tuple(run),
                    scenes=tuple(_portable(scenes[i]) for i in run),
                    mesh_key=keys[run[0]],
                    seconds=sum(_seconds(scenes[i]) for i in run),
                )
            )
    return sorted(chunks, key=lambda c: (-c.seconds, c.indices))


def _mesh_key(index: int, scene: Scene, digests: dict[int, str]) -> tuple[Any, ...]:
    mesh = None if isinstance(scene, Coupon | Press) else scene.mesh
    if mesh is not None:
        digest = digests.setdefault(id(mesh), "") or _digest(mesh)
        digests[id(mesh)] = digest
        return ("own", type(scene).__name__, digest) if _is_run(scene) else ("own", digest, index)
    if isinstance(scene, Beam) and _is_run(scene):
        planar = scene.gravity[1] == 0.0 and scene.tip_force[1] == 0.0
        shape = (scene.length, scene.section, scene.supports, scene.element, scene.layer, scene.rings)
        return ("beam", *shape, planar)
    if isinstance(scene, Coupon):
        return ("coupon",)
    if isinstance(scene, Press):
        return ("press", scene.radius, scene.height, scene.element, scene.refinement, scene.platens)
    return ("alone", index)  # a poke's mesh is made for its site


def _is_run(scene: Scene) -> bool:
    return isinstance(scene, Beam) and scene.solver.method == "static"


def _neighbourhood(scene: Scene) -> tuple[Any, ...]:
    material = scene.material
    moduli = laws.get(material.law).moduli(material.parameters)
    parameters = sorted((name, repr(value)) for name, value in material.parameters.items())
    return material.law, moduli.shear, moduli.bulk, repr(parameters)


def _seconds(scene: Scene) -> float:
    if isinstance(scene, Coupon):
        return _SECONDS["coupon"]
    if isinstance(scene, Press):
        return _SECONDS["press"] * scene.refinement**4
    if scene.solver.method != "static":
        return _SECONDS["dynamic"]
    if isinstance(scene, Poke):
        return _SECONDS["poke"] * scene.refinement**3
    if scene.mesh is not None:
        return _SECONDS_PER_BEAM_NODE * scene.mesh.n_nodes
    return _SECONDS_PER_BEAM_NODE * 70.0 * scene.length / scene.layer * (scene.rings / 2.0) ** 2


def _portable(scene: Scene) -> Scene:
    """The scene with plain parameters, which any mapping may have held and pickle may not take."""
    plain: dict[str, float | tuple[float, ...]] = {}
    for name, value in scene.material.parameters.items():
        plain[name] = tuple(float(v) for v in value) if hasattr(value, "__len__") else float(value)  # type: ignore[union-attr]
    return replace(scene, material=replace(scene.material, parameters=plain))


def _digest(mesh: Mesh) -> str:
    """What a mesh is, whichever object holds it."""
    h = hashlib.sha256(repr((mesh.kind, mesh.symmetry, mesh.nodes.shape, mesh.elements.shape)).encode())
    h.update(mesh.nodes.tobytes())
    h.update(mesh.elements.tobytes())
    for sets in (mesh.node_sets, mesh.facet_sets):
        for name in sorted(sets):
            h.update(repr((name, sets[name].shape, sets[name].dtype.str)).encode())
            h.update(sets[name].tobytes())
    return h.hexdigest()


_known: OrderedDict[Any, Mesh] = OrderedDict()


def _known_mesh(key: Any, mesh: Mesh) -> Mesh:
    """The object that stood for this mesh before in this process, so that its layout is found again."""
    found = _known.setdefault(key, mesh)
    _known.move_to_end(key)
    if len(_known) > 8:
        _known.popitem(last=False)
    return found


def solve_chunk(chunk: Chunk) -> Iterator[tuple[int, Result]]:
    """(index, result) of each scene as it is solved."""
    scenes = chunk.scenes
    own = None if isinstance(scenes[0], Coupon | Press) else scenes[0].mesh
    if own is not None:
        known = _known_mesh(chunk.mesh_key, own)
        scenes = tuple(replace(s, mesh=known) for s in scenes if not isinstance(s, Coupon | Press))
    if all(_is_run(scene) for scene in scenes):
        from tisim._beam import solve_beams

        solving: Iterator[Result] = solve_beams(scenes)  # type: ignore[arg-type]
    else:
        solving = (_solver_of(scene)(scene) for scene in scenes)
    for index in chunk.indices:
        try:
            result = next(solving)
        except ValueError as error:
            raise ValueError(f"scene {index}: {error}") from error
        except Exception as error:
            error.add_note(f"while solving scene {index}")
            raise
        yield index, result


def _solver_of(scene: Scene) -> Callable[[Any], Result]:
    """The function that solves a scene; imported when it is needed, the kernels with it."""
    if isinstance(scene, Coupon):
        from tisim._coupon import solve_coupon

        return solve_coupon
    if isinstance(scene, Press):
        from tisim._press import solve_press

        return solve_press
    if scene.solver.method != "static":
        from tisim._dynamics import solve_dynamic

        return solve_dynamic
    from tisim._poke import solve_poke

    return solve_poke
