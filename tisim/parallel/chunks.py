"""Division of a batch into chunks of scenes on the same mesh, ordered by their parameters."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from tisim import laws, parts
from tisim.mesh import Mesh, MeshError
from tisim.parallel.extensions import Extension, needed
from tisim.parallel.threads import one_thread
from tisim.problems import SceneKind, kind_of
from tisim.result import Result, Status

# Scenes of a chain start from one another: the division into chains affects the bytes of the results, so it
# must not depend on the number of workers. Eight use many cores and amortise mesh, sparsity and first solve.
CHAIN = 8


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Scenes solved in sequence in one process.

    Attributes
    ----------
    indices : tuple of int
        Indices of the scenes in the batch.
    scenes : tuple
    mesh_key : tuple
        Equal for scenes on the same mesh.
    seconds : float
        Approximate cost [core-s].
    extensions : tuple of Extension or None
        Added laws and kinds of scenes that the scenes need; None if they cannot be sent to another process.
    """

    indices: tuple[int, ...]
    scenes: tuple[Any, ...]
    mesh_key: Any
    seconds: float
    extensions: tuple[Extension, ...] | None = ()


def make_chunks(scenes: Sequence[Any]) -> list[Chunk]:
    """Chunks of a batch, the most expensive first; they depend on the scenes alone."""
    digests: dict[int, str] = {}
    keys = [_mesh_key(index, scene, digests) for index, scene in enumerate(scenes)]
    order = sorted(range(len(scenes)), key=lambda i: (repr(keys[i]), *_neighbourhood(scenes[i]), i))
    chunks = []
    for _, members in groupby(order, key=lambda i: repr(keys[i])):
        group = list(members)
        count = -(-len(group) // CHAIN)
        for k in range(count):  # chains of nearly equal length
            chain = group[k * len(group) // count : (k + 1) * len(group) // count]
            plain = tuple(_portable(scenes[i]) for i in chain)
            chunks.append(
                Chunk(
                    indices=tuple(chain),
                    scenes=plain,
                    mesh_key=keys[chain[0]],
                    seconds=sum(kind_of(scenes[i]).seconds(scenes[i]) for i in chain),
                    extensions=needed(plain),
                )
            )
    return sorted(chunks, key=lambda c: (-c.seconds, c.indices))


def own_mesh(scene: Any) -> Mesh | None:
    """The mesh that the user supplied with a scene; None if one is made for it."""
    return getattr(scene, "mesh", None)


def _mesh_key(index: int, scene: Any, digests: dict[int, str]) -> tuple[Any, ...]:
    kind, mesh = kind_of(scene), own_mesh(scene)
    if mesh is not None:
        digest = digests.setdefault(id(mesh), "") or _digest(mesh)
        digests[id(mesh)] = digest
        return ("own", kind.name, digest) if kind.chained(scene) else ("own", digest, index)
    key = kind.mesh_key(scene)
    return ("alone", index) if key is None else key


def _neighbourhood(scene: Any) -> tuple[Any, ...]:
    material = scene.material
    moduli = laws.get(material.law).moduli(material.parameters)
    parameters = sorted((name, repr(value)) for name, value in material.parameters.items())
    beside = repr(parts.of(material))
    return material.law, moduli.shear_modulus, moduli.bulk_modulus, repr(parameters), beside


def _portable(scene: Any) -> Any:
    """The scene with its parameters as a dict of numbers and tuples: other mappings may not pickle."""
    plain: dict[str, float | tuple[float, ...]] = {}
    for name, value in scene.material.parameters.items():
        plain[name] = tuple(float(v) for v in value) if hasattr(value, "__len__") else float(value)
    return replace(scene, material=replace(scene.material, parameters=plain))


def _digest(mesh: Mesh) -> str:
    """Key of a mesh's contents: equal for equal meshes in different objects."""
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
    """The first object in this process with this mesh, so that caches keyed by the object are found."""
    found = _known.setdefault(key, mesh)
    _known.move_to_end(key)
    if len(_known) > 8:
        _known.popitem(last=False)
    return found


def _no_step(_: float) -> None: ...


def solve_chunk(chunk: Chunk, on_step: Callable[[float], None] = _no_step) -> Iterator[tuple[int, Result]]:
    """Solve a chunk; yield (index, result) of each scene.

    Kinds of scenes that report their progress call `on_step` with the completed fraction of the scene.
    """
    scenes = chunk.scenes
    own = own_mesh(scenes[0])
    if own is not None:
        known = _known_mesh(chunk.mesh_key, own)
        scenes = tuple(replace(s, mesh=known) for s in scenes)
    kinds = [kind_of(scene) for scene in scenes]
    chain = kinds[0].solve_chain
    if chain is not None and all(kind.chained(s) for kind, s in zip(kinds, scenes, strict=True)):
        solving = chain(scenes, on_step)
    else:
        solving = (_solve(kind, scene, on_step) for kind, scene in zip(kinds, scenes, strict=True))
    for index in chunk.indices:
        try:
            with one_thread():
                result = next(solving)
        except ValueError as error:
            raise ValueError(f"scene {index}: {error}") from error
        except Exception as error:
            error.add_note(f"while solving scene {index}")
            raise
        yield index, result


def _solve(kind: SceneKind, scene: Any, on_step: Callable[[float], None]) -> Result:
    try:
        return kind.solve(scene, on_step)
    except MeshError as error:  # the checks of a scene make no mesh, since that takes as long as a step
        return Result(
            scene=scene,
            status=Status.NOT_MESHED,
            message=str(error),
            mesh=Mesh(kind="tet4", nodes=np.zeros((0, 3)), elements=np.zeros((0, 4), dtype=np.int32)),
            load=np.zeros(0),
            positions=np.zeros((0, 0, 3)),
            support_force=np.zeros((0, 3)),
            min_jacobian=np.zeros(0),
            residual=np.zeros(0),
        )
