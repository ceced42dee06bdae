"""The kinds of scenes there are: what each checks, shares, costs, and how it is solved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tisim.result import Result

if TYPE_CHECKING:  # scipy is imported when a scene is solved
    from tisim.discretisation.body import Discretisation

OnStep = Callable[[float], None]
"""Called with the fraction of a scene that is done, 0 to 1."""


def skip(_: float) -> None:
    """No progress is wanted."""


def _nothing(_: Any) -> None: ...


def _alone(_: Any) -> tuple[Any, ...] | None:
    return None


def _not_chained(_: Any) -> bool:
    return False


def _no_parts(_: Any) -> tuple[str, ...]:
    return ()


def _ten_seconds(_: Any) -> float:
    return 10.0


def _type_name(result: Result, frame: int) -> str:
    return f"{type(result.scene).__name__}, frame at {result.load[frame]:.4g}"


def _of_mesh(result: Result, _: int) -> Discretisation:
    from tisim.discretisation.body import Discretisation

    return Discretisation.build(result.mesh, np.zeros(0, dtype=np.int32))


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneKind:
    """One kind of scene; `register` adds it.

    Attributes
    ----------
    scene : type
        A frozen dataclass with a field `material` (`tisim.Material`) and a field `solver` (`tisim.Solver`);
        a field `mesh` (`tisim.Mesh` or None) holds a mesh of the user's own.
    solve : callable (scene, on_step) -> Result
        Solves one scene. What has no answer is a status of the result, never an exception. on_step: see
        `OnStep`; to call it is optional.
    check : callable (scene) -> None
        Raises a ValueError, in one sentence that begins with the field, for a scene that cannot be solved.
        Material and solver are checked before it.
    takes : callable (scene) -> tuple of str
        Which of "viscosity", "softening" and "fibres" (`tisim.Material`) the solution takes into account for
        this scene; a material with others is refused. None by default.
    mesh_key : callable (scene) -> tuple or None
        Equal for scenes that share a mesh, which are solved one after the other in one process; None for a
        scene with a mesh of its own.
    chained : callable (scene) -> bool
        Whether scenes of one mesh start from one another (`solve_chain`).
    solve_chain : callable (scenes, on_step) -> iterator of Result, optional
        Solves scenes of one mesh, each started from the one before.
    seconds : callable (scene) -> float
        Rough cost [core-s], to begin with the longest and to decide on the number of processes.
    describe : callable (result, frame) -> str
        A frame in a few words, for the title of a picture.
    discretise : callable (result, frame) -> Discretisation
        What the body was integrated on, for the stress of a frame; its supports do not matter. That of the
        result's mesh by default.
    """

    scene: type
    solve: Callable[[Any, OnStep], Result]
    check: Callable[[Any], None] = _nothing
    takes: Callable[[Any], tuple[str, ...]] = _no_parts
    mesh_key: Callable[[Any], tuple[Any, ...] | None] = _alone
    chained: Callable[[Any], bool] = _not_chained
    solve_chain: Callable[[Sequence[Any], OnStep], Iterator[Result]] | None = None
    seconds: Callable[[Any], float] = _ten_seconds
    describe: Callable[[Result, int], str] = _type_name
    discretise: Callable[[Result, int], Discretisation] = _of_mesh

    @property
    def name(self) -> str:
        """Name of the scene's class."""
        return self.scene.__name__


_KINDS: dict[type, SceneKind] = {}
_BUILT_IN: set[type] = set()


def register(kind: SceneKind) -> SceneKind:
    """Add a kind of scene to those that `tisim.simulate` solves.

    Parameters
    ----------
    kind : SceneKind
        One with the scene class of a kind that was added before takes its place.

    Returns
    -------
    SceneKind
        The same.

    Raises
    ------
    TypeError
        If it is no `SceneKind`, or its scene no dataclass.
    ValueError
        If the scene is one of tisim's own.
    """
    if not isinstance(kind, SceneKind) or not is_dataclass(kind.scene):
        raise TypeError(f"scene kind: expected a SceneKind whose scene is a dataclass, got {kind!r}")
    if kind.scene in _BUILT_IN:
        raise ValueError(f"scene kind: {kind.name} is a kind of tisim's own")
    _KINDS[kind.scene] = kind
    return kind


def register_built_in(kind: SceneKind) -> SceneKind:
    """Add one of tisim's own kinds, which no other may replace."""
    register(kind)
    _BUILT_IN.add(kind.scene)
    return kind


def unregister(scene: type) -> None:
    """Take out a kind that was added."""
    if scene not in _BUILT_IN:
        _KINDS.pop(scene, None)


def kinds() -> tuple[SceneKind, ...]:
    """All kinds, tisim's own first."""
    return tuple(_KINDS.values())


def kind_of(scene: object) -> SceneKind:
    """The kind of a scene; ValueError, which names the kinds there are, for what is none."""
    for base in type(scene).__mro__:
        if base in _KINDS:
            return _KINDS[base]
    *some, last = (kind.name for kind in _KINDS.values())
    raise ValueError(f"expected a {', '.join(some)} or {last}, got {type(scene).__name__}")


def added(scene: object) -> SceneKind | None:
    """The kind of a scene if it was registered from outside, None for tisim's own."""
    kind = kind_of(scene)
    return None if kind.scene in _BUILT_IN else kind
