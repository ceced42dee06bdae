"""Stress, strain, stretch and energy of a result, by element and smoothed to nodes.

They follow from the stresses at the quadrature points that the solver integrates to forces, including the
pressure of elements that integrate it separately (tet10, hex8, hex20).

- By element, first Piola-Kirchhoff stress, Green-Lagrange strain and energy density are means over the rest
  volume, and the Cauchy stress is the mean over the deformed volume: their integrals over the body equal
  those of the solution.
- At nodes, the field of each tet10 and hex20 is first fitted by a linear function (least squares over its
  points, with their weights). The fit has the moments of the integrated field, which single points do not
  represent (a hex20 has its volumetric stiffness mainly at eight of them). Other elements keep their mean.
  The values at a node are averaged over its elements by volume, without those held rigid in a clamp.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tisim.mesh import Mesh, unfold
from tisim.problems import kind_of
from tisim.result import Result, frame_index

if TYPE_CHECKING:  # scipy and Taichi are imported when fields are computed
    from tisim.discretisation.body import DiscretisedBody

Array = NDArray[np.float64]

_HARDLY = 1e-9  # weight of a rigid element in the average over elements
_LINEAR = ("tet10", "hex20")  # element types in which stress varies


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantities:
    """Fields of k elements or nodes.

    Attributes
    ----------
    cauchy : ndarray, shape (k, 3, 3)
        Cauchy stress: force per deformed area [Pa].
    first_piola : ndarray, shape (k, 3, 3)
        First Piola-Kirchhoff stress: force per rest area [Pa]; P[i, K] is the force along i on an area normal
        to K at rest.
    green_lagrange : ndarray, shape (k, 3, 3)
        Green-Lagrange strain (F^T F - I)/2.
    energy_density : ndarray, shape (k,)
        Stored energy per rest volume [J/m3].
    """

    cauchy: Array
    first_piola: Array
    green_lagrange: Array
    energy_density: Array

    @cached_property
    def von_mises(self) -> Array:
        """Von Mises equivalent of the Cauchy stress [Pa], shape (k,)."""
        deviator = self.cauchy + self.pressure[:, None, None] * np.eye(3)
        return np.asarray(np.sqrt(1.5 * np.einsum("kij,kij->k", deviator, deviator)))

    @cached_property
    def pressure(self) -> Array:
        """Pressure, minus the mean normal Cauchy stress [Pa], shape (k,)."""
        return np.asarray(-np.trace(self.cauchy, axis1=1, axis2=2) / 3.0)

    @cached_property
    def principal_stresses(self) -> Array:
        """Principal Cauchy stresses [Pa], shape (k, 3), in descending order."""
        return np.asarray(np.linalg.eigvalsh(self.cauchy)[:, ::-1])

    @cached_property
    def principal_stretches(self) -> Array:
        """Principal stretches, deformed over rest length, shape (k, 3), in descending order."""
        squares = np.linalg.eigvalsh(np.eye(3) + 2.0 * self.green_lagrange)[:, ::-1]
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Fields:
    """Stress, strain and energy of one frame on the result's mesh (m elements, n nodes).

    Attributes
    ----------
    frame : int
        Number of the frame.
    mesh : Mesh
        Mesh of the result.
    elements, nodes : Quantities
        Fields by element (m), and smoothed to nodes (n).
    node_forces : ndarray, shape (n, 3)
        Internal nodal forces, the integral of P grad N [N]: 0 at free nodes without load, minus the body's
        force on its supports at held nodes. For a reduced model they are those of its mesh alone.
    energy : float
        Energy stored in the whole body [J].
    """

    frame: int
    mesh: Mesh
    elements: Quantities
    nodes: Quantities
    node_forces: Array
    energy: float


def fields(result: Result, frame: int = -1) -> Fields:
    """Stress, strain, stretch and energy of one frame.

    Parameters
    ----------
    result : Result
    frame : int
        Index of the frame; negative ones count from the end.

    Returns
    -------
    Fields

    Raises
    ------
    ValueError
        If the result does not have the frame.

    Notes
    -----
    The history of a material with viscosity or softening is integrated from frame to frame, in one time step
    each, with stresses that change at a constant rate. It is inaccurate if frames in a hold are far apart
    (docs/how-to/viewing.md quantifies this); `Course(frames=...)` requests more frames.
    """
    return next(_frames(result, [frame_index(result, frame)]))


def fields_of_frames(result: Result) -> Iterator[Fields]:
    """`fields` of all frames in sequence; the history of a material is integrated only once."""
    return _frames(result, range(len(result.positions)))


def _frames(result: Result, wanted: Sequence[int]) -> Iterator[Fields]:
    from tisim.discretisation.body import DiscretisedBody
    from tisim.parallel.threads import one_thread

    kind, material = kind_of(result.scene), result.scene.material
    memory: DiscretisedBody | None = None
    before = 0.0
    for frame in range(max(wanted, default=-1) + 1):
        if frame not in wanted and not material.remembers:
            continue
        x = result.positions[frame]
        with one_thread():
            discretisation = kind.discretise(result, frame)
            body = DiscretisedBody(discretisation, material)
            if body.history is not None:
                if memory is not None:
                    body.take(memory.history)
                now = before if result.time is None else float(result.time[frame])
                body.begin(now - before)
                body.accept(x)
                memory, before = body, now
            found = fields_at(body, x, frame) if frame in wanted else None
        if found is not None:  # outside: the caller may keep this generator, and solve something else
            yield found


def fields_at(body: DiscretisedBody, x: Array, frame: int = -1) -> Fields:
    """Fields of a body at positions x (n, 3) [m], in its last accepted state."""
    mesh, ref = body.discretisation.mesh, body.discretisation.reference
    psi, P = body.point_response(x)
    energy = body.stored_energy(x)
    F = np.einsum("eai,eqak->eqik", x[mesh.elements], ref.gradients, optimize=True)
    C = np.swapaxes(F, 2, 3) @ F
    J = np.linalg.det(F)
    factor = body.discretisation.stiffness
    if factor is not None:
        psi, energy, P = psi * factor, energy * factor, P * factor[..., None, None]
    forces = np.zeros_like(x)
    element_forces = np.einsum("eq,eqik,eqak->eai", ref.weights, P, ref.gradients, optimize=True)
    np.add.at(forces, mesh.elements, element_forces)
    kirchhoff = P @ np.swapaxes(F, 2, 3)
    rest, now = ref.weights, ref.weights * np.where(J > 0.0, J, 0.0)
    parts = {
        "cauchy": (kirchhoff / np.where(J > 0.0, J, 1.0)[..., None, None], now),
        "first_piola": (P, rest),
        "green_lagrange": (0.5 * (C - np.eye(3)), rest),
        "energy_density": (energy, rest),
    }
    rigid = np.isin(mesh.elements, body.discretisation.fixed).all(axis=1)
    counted = rest.sum(axis=1) * np.where(rigid, _HARDLY, 1.0)
    whole, smooth = {}, {}
    for name, (values, weights) in parts.items():
        flat = values.reshape(*values.shape[:2], -1)
        mean, corners = _fitted(body, flat, weights)
        whole[name] = mean.reshape(-1, *values.shape[2:])
        smooth[name] = _at_nodes(mesh, corners, counted).reshape(-1, *values.shape[2:])
    for name in ("cauchy", "first_piola", "green_lagrange"):
        _mirror(mesh, smooth[name])
    total = float(np.vdot(rest, energy)) * body.discretisation.multiplicity
    return Fields(
        frame=frame,
        mesh=mesh,
        elements=Quantities(**whole),
        nodes=Quantities(**smooth),
        node_forces=forces,
        energy=total,
    )


def _fitted(body: DiscretisedBody, values: Array, weights: Array) -> tuple[Array, Array]:
    """Weighted mean (m, c) of elements' point values (m, q, c), and their linear fit at nodes (m, a, c)."""
    mesh, ref = body.discretisation.mesh, body.discretisation.reference
    total = weights.sum(axis=1)
    total = np.where(total > 0.0, total, 1.0)
    mean = np.einsum("eq,eqc->ec", weights, values) / total[:, None]
    corners = mesh.nodes[mesh.elements]
    if mesh.kind not in _LINEAR:
        return mean, np.repeat(mean[:, None], corners.shape[1], axis=1)
    points = ref.values @ corners
    centre = np.einsum("eq,eqi->ei", weights, points) / total[:, None]
    size = np.cbrt(ref.weights.sum(axis=1))[:, None, None]
    at = (points - centre[:, None]) / size
    gram = np.einsum("eq,eqi,eqj->eij", weights, at, at, optimize=True)
    moments = np.einsum("eq,eqi,eqc->eic", weights, at, values, optimize=True)
    slope = np.linalg.pinv(gram, hermitian=True) @ moments
    return mean, mean[:, None] + (corners - centre[:, None]) / size @ slope


def _at_nodes(mesh: Mesh, corners: Array, volume: Array) -> Array:
    """Volume-weighted means (n, c) of the elements' values at their nodes (m, a, c)."""
    found, weight = np.zeros((mesh.n_nodes, corners.shape[2])), np.zeros(mesh.n_nodes)
    np.add.at(found, mesh.elements, volume[:, None, None] * corners)
    np.add.at(weight, mesh.elements, np.broadcast_to(volume[:, None], mesh.elements.shape))
    return found / np.where(weight > 0.0, weight, 1.0)[:, None]


def mirrored(tensors: Array, name: str) -> Array:
    """Tensors (..., 3, 3) reflected in a plane normal to an axis ("x", "y" or "z")."""
    sign = np.ones(3)
    sign["xyz".index(name)] = -1.0
    return np.asarray(tensors * np.outer(sign, sign))


def _mirror(mesh: Mesh, tensors: Array) -> None:
    """Average tensors (n, 3, 3) on mirror planes with those of the other half, in place."""
    for name in mesh.symmetry:
        plane = mesh.node_sets[f"mirror_{name}"]
        tensors[plane] = 0.5 * (tensors[plane] + mirrored(tensors[plane], name))


def unfold_quantities(mesh: Mesh, found: Quantities, *, nodes: bool) -> Quantities:
    """Quantities of a mesh's nodes or elements on the whole body of `tisim.mesh.unfold`."""
    values = {name: getattr(found, name) for name in Quantities.__dataclass_fields__}
    for name in mesh.symmetry:
        copied = np.ones(mesh.n_nodes if nodes else mesh.n_elements, dtype=bool)
        if nodes:
            copied[mesh.node_sets[f"mirror_{name}"]] = False
        for key, value in values.items():
            other = mirrored(value[copied], name) if value.ndim == 3 else value[copied]
            values[key] = np.concatenate([value, other])
        mesh, _ = unfold(replace(mesh, symmetry=(name,)), mesh.nodes)
    return Quantities(**values)
