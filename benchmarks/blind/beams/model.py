"""A true beam with its hidden faults, and its mesh: stress-free shape, moduli, dead load, grips.

Coordinates are those of docs/reference/experiment-format.md: x out of the clamp face, z up. Signs of the
faults are defined in `Beam`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks.blind.beams.elements import (
    Bricks,
    Section,
    axial_breaks,
    bricks,
    face_shares,
    half_disc,
    lobatto,
    with_breaks,
)

GRAVITY = 9.81
WINDOW = 0.015  # length of a void [m]


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A true beam with its faults.

    Attributes
    ----------
    length, radius : free length and radius [m].
    bridge : True if both ends are clamped.
    mu, density : shear modulus [Pa] and density [kg/m3].
    bulk_ratio : bulk modulus over shear modulus.
    stiffening : a in the energy density of `elements`.
    grip_depth : length of free material inside each grip [m].
    near_tilt : rotation of the clamp [rad]; positive raises the free end.
    compliance : rotation of each clamp per moment [rad/(N m)].
    squeeze : relative reduction of the clamped section's height; it is wider so that its area stays.
    gravity_angle : direction of gravity [rad]; positive pulls towards +x.
    taper, axial_gradient : relative gradients of the size and of the modulus along x, about the middle [1/m].
    transverse_gradient : relative gradient of the modulus along z [1/m]; positive is stiffer on top.
    curvature : of the stress-free axis [1/m], positive upwards.
    void, void_at : fraction of stiffness and weight missing over 15 mm about x = void_at [m].
    skin, skin_depth : relative excess of the modulus in the outer skin_depth [m].
    gap : distance by which the far clamp is too near [m].
    far_pinned : True if the far face rotates freely about its centre.
    blob : mass hung over the last 3 mm [kg].
    string : upward force on the middle 3 mm [N].
    tip : known mass on the free face [kg].
    """

    length: float
    bridge: bool
    mu: float
    density: float = 1000.0
    radius: float = 0.010
    bulk_ratio: float = 1000.0
    stiffening: float = 0.0
    grip_depth: float = 0.0
    near_tilt: float = 0.0
    compliance: float = 0.0
    squeeze: float = 0.0
    gravity_angle: float = 0.0
    taper: float = 0.0
    axial_gradient: float = 0.0
    transverse_gradient: float = 0.0
    curvature: float = 0.0
    void: float = 0.0
    void_at: float = 0.0
    skin: float = 0.0
    skin_depth: float = 0.001
    gap: float = 0.0
    far_pinned: bool = False
    blob: float = 0.0
    string: float = 0.0
    tip: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """Resolution of the mesh.

    A finer `first` lets the lower edge of a soft long beam crease at the clamp, with several equilibria 0.5
    mm apart: perhaps real, but of no use here.

    Attributes
    ----------
    degree : polynomial degree of the elements.
    split : each quadrilateral of the section is split into split^2.
    first, growth, longest : first layer [m], growth ratio and longest layer [m] along the beam.
    """

    degree: int = 2
    split: int = 1
    first: float = 0.0018
    growth: float = 1.6
    longest: float = 0.006


Array = NDArray[np.float64]
HEXAGON = 0.5  # radius of the section's inner hexagon over that of the beam


@dataclass(frozen=True, eq=False)
class Model:
    """The meshed beam: planes of nodes, each a copy of the section.

    Attributes
    ----------
    ideal, rest : nodes in the prism and in the stress-free shape [m], shape (planes, n, 3).
    element : nodes of the elements, shape (e, a).
    mu : modulus at the quadrature points over Beam.mu, shape (e, q).
    load : dead load over Beam.mu [N/Pa], shape (planes, n, 3).
    """

    beam: Beam
    degree: int
    section: Section
    ideal: Array
    rest: Array
    element: NDArray[np.intp]
    bricks: Bricks
    mu: Array
    load: Array


def mesh(beam: Beam, resolution: Resolution) -> Model:
    """Mesh with layers graded towards the clamps and boundaries at the ends of a void and of loads.

    ValueError if a skin is combined with a split section.
    """
    start, end = -beam.grip_depth, beam.length + (beam.grip_depth if beam.bridge else 0.0)
    breaks = axial_breaks(
        start,
        end,
        both_ends=beam.bridge,
        first=resolution.first,
        growth=resolution.growth,
        longest=resolution.longest,
    )
    wanted: tuple[float, ...] = ()
    if beam.void:
        wanted += (beam.void_at - WINDOW / 2, beam.void_at + WINDOW / 2)
    if beam.blob:
        wanted += (beam.length - 0.003,)
    if beam.string:
        wanted += (beam.length / 2 - 0.0015, beam.length / 2 + 0.0015)
    breaks = with_breaks(breaks, wanted)
    degree = resolution.degree
    unit = (lobatto(degree)[:-1] + 1) / 2
    planes = np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * unit).ravel(), breaks[-1])
    section = half_disc(degree, (HEXAGON, 1.0), resolution.split)
    ideal = np.empty((len(planes), len(section.nodes), 3))
    ideal[..., 0] = planes[:, None]
    ideal[..., 1:] = section.nodes * beam.radius
    rest = _rest_shape(beam, ideal)
    layers, quads = len(breaks) - 1, len(section.quads)
    plane = degree * np.arange(layers)[:, None] + np.arange(degree + 1)
    element = plane[:, None, :, None] * len(section.nodes) + section.quads[None, :, None, :]
    element = element.reshape(layers * quads, -1)
    layer = partial(_skin_begins, 1 - beam.skin_depth / beam.radius) if beam.skin else None
    if layer and resolution.split != 1:
        raise ValueError("blind mesh: a skin needs a section of whole quadrilaterals")
    elements = bricks(degree, ideal.reshape(-1, 3)[element], rest.reshape(-1, 3)[element], layer)
    mu, density = _stiffness(beam, elements.point)
    load = np.zeros((ideal.size // 3, 3))
    np.add.at(load, element, _force(beam, elements, density))
    load = load.reshape(ideal.shape)
    if beam.tip:
        weight = beam.tip * GRAVITY / beam.mu * _down(beam)
        load[-1] += 0.5 * face_shares(section, degree)[:, None] * weight
    return Model(beam, degree, section, ideal, rest, element, elements, mu, load)


def _down(beam: Beam) -> Array:
    """Unit vector of gravity."""
    return np.array([np.sin(beam.gravity_angle), 0.0, -np.cos(beam.gravity_angle)])


def _skin_begins(radius: float, fast: float) -> float:
    """Slow coordinate at which the outer quadrilaterals reach `radius` (of 1), at a fast coordinate."""
    share = (fast + 1) / 2
    corner = HEXAGON * np.exp(1j * np.pi / 3 * np.arange(2))
    inner = (1 - share) * corner[0] + share * corner[1]
    outer = np.exp(1j * np.pi / 3 * share)
    return float(brentq(lambda slow: abs(inner + (slow + 1) / 2 * (outer - inner)) - radius, -1.0, 1.0))


def _rest_shape(beam: Beam, ideal: Array) -> Array:
    x = ideal[..., 0]
    size = 1 + beam.taper * (x - beam.length / 2)
    y, z = ideal[..., 1] * size, ideal[..., 2] * size
    if beam.curvature == 0.0:
        return np.stack([x, y, z], axis=-1)
    turn, bend = beam.curvature * x, 1 / beam.curvature
    return np.stack([(bend - z) * np.sin(turn), y, bend - (bend - z) * np.cos(turn)], axis=-1)


def _stiffness(beam: Beam, point: Array) -> tuple[Array, Array]:
    """Modulus and density at the quadrature points, over those of the beam."""
    x, y, z = np.moveaxis(point, -1, 0)
    mu = (1 + beam.axial_gradient * (x - beam.length / 2)) * (1 + beam.transverse_gradient * z)
    if (mu <= 0).any():
        raise ValueError("blind beam: a gradient so steep that the modulus falls to zero")
    if beam.skin:
        mu = mu * (1 + beam.skin * (np.hypot(y, z) > beam.radius - beam.skin_depth))
    left = 1 - beam.void * (np.abs(x - beam.void_at) < WINDOW / 2)
    return mu * left, left


def _force(beam: Beam, elements: Bricks, density: Array) -> Array:
    """Dead load on the elements' nodes (e, a, 3) over mu; the half beam carries half of a point load."""
    weight = elements.weight * density
    pull = beam.density * GRAVITY * _down(beam)
    force = np.einsum("qa,eq,i->eai", elements.value, weight, pull, optimize=True)
    x = elements.point[..., 0]
    for size, where in (
        (-GRAVITY * beam.blob, x > beam.length - 0.003),
        (beam.string, np.abs(x - beam.length / 2) < 0.0015),
    ):
        if size:
            part = elements.weight * where
            force[..., 2] += size / 2 * np.einsum("qa,eq->ea", elements.value, part) / part.sum()
    return np.asarray(force / beam.mu)


def held_face(model: Model, end: int, turn: float) -> tuple[Array, Array]:
    """Positions (n, 3) of a face rotated by `turn` about its clamp's centre, and their derivative by it."""
    beam, face = model.beam, model.ideal[end].copy()
    face[:, 1:] *= 1 + beam.taper * (face[0, 0] - beam.length / 2)
    face[:, 2] *= 1 - beam.squeeze
    face[:, 1] /= 1 - beam.squeeze
    pivot = 0.0 if end == 0 else beam.length
    arm = face[:, 0] - pivot
    c, s = np.cos(turn), np.sin(turn)
    zero = np.zeros(len(face))
    moved = np.stack([pivot + arm * c - face[:, 2] * s, face[:, 1], arm * s + face[:, 2] * c], axis=1)
    slope = np.stack([-arm * s - face[:, 2] * c, zero, arm * c - face[:, 2] * s], axis=1)
    if end != 0:
        moved[:, 0] -= beam.gap
    return moved, slope
