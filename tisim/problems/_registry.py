"""Registry of the kinds of scenes: how each is checked, grouped by mesh, scheduled and solved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tisim.result import Result

if TYPE_CHECKING:  # scipy is imported when a scene is solved
    from tisim.discretisation.body import Discretisation

OnStep = Callable[[float], None]
"""Callback that is called with the completed fraction of a scene, 0 to 1."""


def skip(_: float) -> None:
    """Ignore the progress."""


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


def _nodes(result: Result) -> NDArray[np.float64]:
    return result.mesh.nodes


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
        a field `mesh` (`tisim.Mesh` or None) holds a mesh that the user supplies.
    solve : callable (scene, on_step) -> Result
        Solves one scene. A scene without a solution gives a result with that status, never an exception.
        Calling `on_step` (see `OnStep`) is optional.
    check : callable (scene) -> None
        Raises a ValueError, in one sentence that begins with the field, for a scene that cannot be solved.
        Material and solver are checked earlier.
    takes : callable (scene) -> tuple of str
        Those of "viscosity", "softening" and "fibres" (`tisim.Material`) that the solution takes into account
        for this scene; a material with others is refused. Empty by default.
    mesh_key : callable (scene) -> tuple or None
        Equal for scenes that share a mesh, which are solved in sequence in one process; None for a scene
        that shares its mesh with no other.
    chained : callable (scene) -> bool
        True if scenes of one mesh use the solution of the previous one as start value (`solve_chain`).
    solve_chain : callable (scenes, on_step) -> iterator of Result, optional
        Solves scenes of one mesh, each started from the previous one.
    seconds : callable (scene) -> float
        Approximate cost [core-s]: the longest scenes are started first, and the number of processes depends
        on it. 10 by default.
    describe : callable (result, frame) -> str
        Short description of a frame, for the title of a picture.
    discretise : callable (result, frame) -> Discretisation
        Discretisation of the body, used to evaluate the stress of a frame; its supports do not matter. By
        default that of the result's mesh.
    rest : callable (result) -> ndarray of float, shape (n, 3)
        Stress-free node positions [m]. By default those of the result's mesh.
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
    rest: Callable[[Result], NDArray[np.float64]] = _nodes

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
        Replaces an added kind of the same scene class.

    Returns
    -------
    SceneKind
        The argument.

    Raises
    ------
    TypeError
        If `kind` is not a `SceneKind` or its scene is not a dataclass.
    ValueError
        If the scene class is built into tisim.
    """
    if not isinstance(kind, SceneKind) or not is_dataclass(kind.scene):
        raise TypeError(f"scene kind: expected a SceneKind whose scene is a dataclass, got {kind!r}")
    if kind.scene in _BUILT_IN:
        raise ValueError(f"scene kind: {kind.name} is a kind of tisim's own")
    _KINDS[kind.scene] = kind
    return kind


def register_built_in(kind: SceneKind) -> SceneKind:
    """Add a built-in kind, which no other kind may replace."""
    register(kind)
    _BUILT_IN.add(kind.scene)
    return kind


def unregister(scene: type) -> None:
    """Remove an added kind; built-in and unknown kinds are ignored."""
    if scene not in _BUILT_IN:
        _KINDS.pop(scene, None)


def kinds() -> tuple[SceneKind, ...]:
    """All kinds, the built-in ones first."""
    return tuple(_KINDS.values())


def kind_of(scene: object) -> SceneKind:
    """Kind of a scene, by its class or a base class; ValueError, which lists the kinds, if there is none."""
    for base in type(scene).__mro__:
        if base in _KINDS:
            return _KINDS[base]
    *some, last = (kind.name for kind in _KINDS.values())
    raise ValueError(f"expected a {', '.join(some)} or {last}, got {type(scene).__name__}")


def added(scene: object) -> SceneKind | None:
    """Kind of a scene if it was added by `register`, None if it is built in."""
    kind = kind_of(scene)
    return None if kind.scene in _BUILT_IN else kind
