"""Checks of a scene before any work is done; each fault is stated in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from typing import Any

import numpy as np

from tisim import laws, parts
from tisim._checks import (
    FieldError,
    check_choice,
    check_not_negative,
    check_number,
    check_positive,
    check_type,
    check_whole,
)
from tisim.course import Course
from tisim.material import Material
from tisim.mesh import Mesh
from tisim.problems._registry import kind_of
from tisim.scene import Solver


def check_scene(index: int, scene: Any) -> None:
    """Raise ValueError that names the scene by its index in the list, the field and the expected value."""
    try:
        kind = kind_of(scene)
    except ValueError as error:
        raise ValueError(f"scene {index}: {error}") from None
    try:
        check_material(scene.material)
        check_solver(scene.solver)
        check_parts(scene.material, kind.takes(scene), kind.name)
        kind.check(scene)
    except ValueError as error:
        raise ValueError(f"scene {index}: {kind.name}.{error}") from None


def check_material(material: Material) -> None:
    check_type("material", material, (Material,))
    check_choice("material.law", material.law, laws.all_names())
    check_positive("material.density", material.density, "a density above 0 kg/m3")
    if not isinstance(material.parameters, Mapping):
        raise FieldError("material.parameters", "parameters by name", material.parameters)
    try:
        laws.get(material.law).check(material.parameters)
        # packing has additional rules (non-zero exponents)
        laws.get(material.law).pack(material.parameters)
    except (ValueError, TypeError) as error:
        raise FieldError("material.parameters", f"a sound set ({error})", dict(material.parameters)) from None
    for name, part in parts.of(material).items():
        check_type(f"material.{name}", part, (parts.FIELDS[name],))
        try:
            part.check()
        except FieldError as bad:
            raise bad.within(f"material.{name}") from None
        except ValueError as error:
            raise ValueError(f"material.{name}.{error}") from None


def check_parts(material: Material, takes: tuple[str, ...], name: str) -> None:
    """Raise FieldError for a part of the material that a kind of scene ignores.

    Parameters
    ----------
    material : Material
    takes : tuple of str
        Parts that the kind takes into account, see `SceneKind.takes`.
    name : str
        Name of the kind, for the error message.
    """
    for field, part in parts.of(material).items():
        if field not in takes:
            raise FieldError(
                f"material.{field}", f"None, since this {name} does not take it into account", part
            )


def oblique_fibres(material: Material) -> bool:
    """True if the material has fibres that are oblique to x, y and z."""
    fibres = material.fibres
    return fibres is not None and int(np.count_nonzero(np.abs(fibres.axis()) > 1e-9)) > 1


def check_course(scene: Any, *, start: float, instead_of: tuple[str, ...] = ()) -> None:
    """Raise FieldError unless the course is valid and the fields that it replaces have their default values.

    A viscous material needs a course, since without one there is no time.

    Parameters
    ----------
    scene
        A scene with a field `course`.
    start : float
        Value of the state at rest, passed to `Course.check`.
    instead_of : tuple of str
        Fields of the scene that the course replaces.
    """
    course = scene.course
    if course is None:
        if scene.material.viscosity is not None:
            raise FieldError("course", "a tisim.Course, since the material is viscous", course)
        return
    check_type("course", course, (Course,))
    course.check(start=start)
    for name in instead_of:
        default: Any = next(f.default for f in fields(scene) if f.name == name)
        if not np.array_equal(getattr(scene, name), default):
            raise FieldError(name, "nothing, where a course is given", getattr(scene, name))


def check_solver(solver: Solver) -> None:
    check_type("solver", solver, (Solver,))
    check_choice("solver.method", solver.method, ("static", "implicit", "explicit"))
    check_number("solver.tolerance", solver.tolerance, "a number between 0 and 1", lambda v: 0.0 < v < 1.0)
    check_positive("solver.duration", solver.duration, "a time above 0 s")
    check_positive("solver.time_step", solver.time_step, "a time above 0 s")
    check_not_negative("solver.mass_damping", solver.mass_damping)
    check_not_negative("solver.stiffness_damping", solver.stiffness_damping)
    check_whole("solver.max_iterations", solver.max_iterations)


def check_static(solver: Solver, what: str) -> None:
    """Raise FieldError unless the method is "static"; `what` names the scenes in the plural."""
    if solver.method != "static":
        raise FieldError("solver.method", f"static, the only one offered for {what}", solver.method)


def check_stretches(stretches: Any, mode: str) -> None:
    """Raise FieldError unless there is at least one stretch and all are possible in this mode of loading."""
    if not isinstance(stretches, tuple | list | np.ndarray) or not len(stretches):
        raise FieldError("stretches", "at least one stretch", stretches)
    for value in stretches:
        if mode == "simple-shear":
            check_number("stretches", value, "finite numbers, 1 + gamma", lambda _: True)
        else:
            check_positive("stretches", value, "stretches above 0")


def check_mesh(mesh: Mesh | None, *, node_sets: tuple[str, ...], facet_sets: tuple[str, ...]) -> None:
    if mesh is None:
        return
    check_type("mesh", mesh, (Mesh,))
    for what, wanted, there in (
        ("node", node_sets, mesh.node_sets),
        ("facet", facet_sets, mesh.facet_sets),
    ):
        for name in wanted:
            if name not in there or not len(there[name]):
                raise FieldError("mesh", f"a {what} set {name!r} that is not empty", sorted(there))
    for name in facet_sets:
        facets = mesh.facet_sets[name]
        again = len(facets) - len(np.unique(np.sort(facets, axis=1), axis=0))
        if again:  # its load and its contact would count twice
            raise FieldError("mesh", f"a facet set {name!r} with each facet once", f"{again} given again")
    if not mesh.n_elements:
        raise FieldError("mesh", "at least one element", 0)
    _check_elements(mesh, node_sets)


@lru_cache(maxsize=16)
def _check_elements(mesh: Mesh, held: tuple[str, ...]) -> None:
    """FieldError for elements inside-out, or a part of the body that no held node set is connected to."""
    from scipy import sparse
    from scipy.sparse.csgraph import connected_components

    from tisim.discretisation.quadrature import reference

    try:
        reference(mesh)
    except ValueError as error:
        raise FieldError("mesh", f"elements of positive volume ({error})", mesh.kind) from None
    first = np.repeat(mesh.elements[:, 0], mesh.elements.shape[1])
    ones = np.ones(len(first), dtype=bool)
    joined = sparse.coo_matrix((ones, (first, mesh.elements.ravel())), shape=(mesh.n_nodes, mesh.n_nodes))
    _, part = connected_components(joined, directed=False)
    fixed = np.unique(part[np.concatenate([mesh.node_sets[name] for name in held])])
    loose = ~np.isin(part[mesh.elements[:, 0]], fixed)
    if loose.any():
        wanted = f"elements that are all connected to {' or '.join(held)}, others would fall"
        raise FieldError("mesh", wanted, f"{int(loose.sum())} that are not")
