"""Equilibrium of a heavy silicone beam with faults: the solver that makes the blind data.

Bricks of degree 2 with discontinuous pressures (`_blind_element`), Newton on positions and pressures, and
elimination layer by layer: a beam's matrix is block tridiagonal. It shares no code with `tisim`.

Coordinates as in measured/FORMAT.md: x out of the clamp face, z up. Signs of the faults stand in `Beam`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from _blind_element import Bricks, assemble, bricks, smallest_volume
from _blind_mesh import Section, axial_breaks, half_disc, lagrange, lobatto, with_breaks
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]
GRAVITY = 9.81
WINDOW = 0.015  # length of a void [m]
HEXAGON = 0.5  # radius of the section's inner hexagon, parts of the beam's


class NoEquilibriumError(RuntimeError):
    """No equilibrium was found."""


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A beam as it truly is. Lengths [m], angles [rad], mu [Pa], density [kg/m3].

    grip_depth: free material inside each grip. near_tilt: positive lifts the free end. compliance
    [rad/(N m)]: each clamp yields to its moment. squeeze: the held section lower by this part, wider so that
    its area stays. gravity_angle: positive pulls towards +x. taper, axial_gradient [1/m]: of the size and of
    the modulus along x, about the middle. transverse_gradient [1/m]: of the modulus along z, positive:
    stiffer on top. curvature [1/m]: of the stress-free axis, positive upwards. void: part of stiffness and
    weight missing over 15 mm about void_at. skin: excess modulus of the outer skin_depth. gap: the far clamp
    is nearer by this. far_pinned: the far face turns freely about its centre. blob [kg]: hung over the last
    3 mm. string [N]: lifts the middle 3 mm.
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


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """degree: of the bricks; split: each quadrilateral of the section into split^2; first, growth, longest:
    of the layers along the beam [m]. A finer `first` lets the lower edge of a soft long beam crease at the
    clamp, with several equilibria 0.5 mm apart: real perhaps, but of no use here."""

    degree: int = 2
    split: int = 1
    first: float = 0.0018
    growth: float = 1.6
    longest: float = 0.006


@dataclass(frozen=True, eq=False)
class Model:
    """The meshed beam: planes of nodes, each a copy of the section. ideal, rest (planes, n, 3): the prism and
    the stress-free shape; load (planes, n, 3) [N / Pa]; mu (e, q): modulus in parts of Beam.mu."""

    beam: Beam
    degree: int
    section: Section
    ideal: Array
    rest: Array
    element: NDArray[np.intp]
    bricks: Bricks
    mu: Array
    load: Array


@dataclass(frozen=True, eq=False)
class Shape:
    """A solved beam: positions (planes, n, 3) [m], the clamps' turns [rad] (positive: slope up), Newton
    steps."""

    model: Model
    x: Array
    turn: Array
    steps: int

    def edges(self, s: Array) -> Array:
        """Silhouette (2, len(s), 2): x, z [m] of the upper and lower edge at s in [0, 1], the ideal prism's x
        over its free length."""
        planes = self.model.ideal[:, 0, 0]
        degree, at = self.model.degree, s * self.model.beam.length
        layer = np.clip(np.searchsorted(planes[::degree], at, side="right") - 1, 0, len(planes) // degree - 1)
        low, high = planes[layer * degree], planes[(layer + 1) * degree]
        value, _ = lagrange(lobatto(degree), 2 * (at - low) / (high - low) - 1)
        columns = layer[:, None] * degree + np.arange(degree + 1)
        ends = [self.model.section.top, self.model.section.bottom]
        edges = np.einsum("sk,skec->esc", value, self.x[columns][:, :, ends][..., [0, 2]])
        # a grip that reaches out over its face holds what lies in it straight
        for end, beyond in ((0, np.minimum(at - planes[0], 0)), (-1, np.maximum(at - planes[-1], 0))):
            turn = self.turn[end] if len(self.turn) == 2 or end == 0 else 0.0
            held = beyond != 0
            ray = beyond[held, None] * np.array([np.cos(turn), np.sin(turn)])
            edges[:, held] = self.x[end, ends][:, None, [0, 2]] + ray
        return edges


def mesh(beam: Beam, resolution: Resolution) -> Model:
    """Layers graded towards the clamps, with boundaries where a fault begins and ends."""
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
    return Model(beam, degree, section, ideal, rest, element, elements, mu, load.reshape(ideal.shape))


def _skin_begins(radius: float, fast: float) -> float:
    """Slow coordinate at which the outer quadrilaterals pass `radius` (of 1), at a fast coordinate."""
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
    """Modulus and density at the quadrature points, in parts of the beam's."""
    x, y, z = np.moveaxis(point, -1, 0)
    mu = (1 + beam.axial_gradient * (x - beam.length / 2)) * (1 + beam.transverse_gradient * z)
    if (mu <= 0).any():
        raise ValueError("blind beam: a gradient so steep that the modulus falls to zero")
    if beam.skin:
        mu = mu * (1 + beam.skin * (np.hypot(y, z) > beam.radius - beam.skin_depth))
    left = 1 - beam.void * (np.abs(x - beam.void_at) < WINDOW / 2)
    return mu * left, left


def _force(beam: Beam, elements: Bricks, density: Array) -> Array:
    """Dead load on the elements' nodes (e, a, 3), in parts of mu; the half beam carries half of a load."""
    weight = elements.weight * density
    pull = beam.density * GRAVITY * np.array([np.sin(beam.gravity_angle), 0.0, -np.cos(beam.gravity_angle)])
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


def solve(beam: Beam, *, start: Array | None = None, resolution: Resolution | None = None) -> Shape:
    """Equilibrium. start (k, 4): x, z, slope angle of the axis at the ideal x in column 0, to begin from;
    without it the load is raised in steps. Raises NoEquilibriumError."""
    model = mesh(beam, resolution or Resolution())
    if start is not None:
        try:
            return _newton(model, _from_axis(model, start), 1.0)
        except NoEquilibriumError:
            pass
    x, factor, step = model.ideal.copy(), 0.0, 0.25
    x[0] = _face(model, 0, beam.near_tilt)[0]
    shape: Shape | None = None
    while factor < 1.0:
        try:
            shape = _newton(model, x, min(1.0, factor + step))
        except NoEquilibriumError:
            step /= 2
            if step < 0.01:
                raise
            continue
        x, factor, step = shape.x, min(1.0, factor + step), 1.5 * step
    assert shape is not None
    return shape


def axis_of(shape: Shape) -> Array:
    """(planes, 4): ideal x, then x, z and slope angle of the axis, as `solve` takes for its start."""
    flat = shape.model.section.flat
    x = shape.x[:, flat]
    up = x[:, shape.model.section.nodes[flat, 1].argmax()] - x[:, shape.model.section.nodes[flat, 1].argmin()]
    centre = x.mean(axis=1)
    return np.stack(
        [shape.model.ideal[:, 0, 0], centre[:, 0], centre[:, 2], np.arctan2(-up[:, 0], up[:, 2])], axis=1
    )


def _from_axis(model: Model, start: Array) -> Array:
    """The prism bent along an axis, turned by the tilt (a bridge's tilt fades), closed by the gap."""
    ideal, beam = model.ideal, model.beam
    at = ideal[:, 0, 0]
    cx, cz, slope = (np.interp(at, start[:, 0], start[:, k]) for k in (1, 2, 3))
    cx += np.minimum(at - start[0, 0], 0) + np.maximum(at - start[-1, 0], 0)
    share = np.clip(at / beam.length, 0, 1)
    if beam.bridge:
        cz = cz + beam.near_tilt * beam.length * share * (1 - share) ** 2
        slope = slope + beam.near_tilt * (1 - share) * (1 - 3 * share)
        cx = cx - beam.gap * share
    else:
        turn = beam.near_tilt + beam.curvature * at * 0.5
        c, s = np.cos(turn), np.sin(turn)
        cx, cz, slope = c * cx - s * cz, s * cx + c * cz, slope + turn
    # bent, an incompressible section narrows where it is stretched: Newton starts near J = 1
    bend = np.gradient(slope, at)[:, None] - beam.curvature
    y = ideal[..., 1] * (1 + bend * ideal[..., 2] / 2)
    z = ideal[..., 2] + bend * (ideal[..., 2] ** 2 - ideal[..., 1] ** 2) / 4
    return np.stack(
        [cx[:, None] - z * np.sin(slope)[:, None], y, cz[:, None] + z * np.cos(slope)[:, None]], axis=-1
    )


def _face(model: Model, end: int, turn: float) -> tuple[Array, Array]:
    """Positions (n, 3) of a held face turned by `turn` about its clamp's centre, and their slope by it."""
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


def _newton(model: Model, x: Array, factor: float) -> Shape:
    """Newton at `factor` of the load, on positions, pressures and the turns of clamps that yield."""
    beam, x = model.beam, x.copy()
    ends = (0, -1) if beam.bridge else (0,)
    base = np.array([beam.near_tilt, 0.0][: len(ends)])
    spring = np.full(len(ends), np.inf)  # clamp's stiffness over mu, for the half beam
    if beam.compliance:
        spring[:] = 0.5 / (beam.compliance * beam.mu)
    if beam.far_pinned and beam.bridge:
        spring[1] = 0.0
    loose = np.flatnonzero(np.isfinite(spring))
    turn = base.copy()
    p = np.zeros((len(model.element), model.bricks.pressure.shape[1]))
    if smallest_volume(model.bricks, x.reshape(-1, 3)[model.element]) <= 0.0:
        raise NoEquilibriumError("the start is turned inside out")
    for step in range(1, 13):
        slopes = []
        moves = np.zeros_like(x)
        for k, end in enumerate(ends):
            face, slope = _face(model, end, float(turn[k]))
            moves[end] = face - x[end]
            slopes.append(slope)
        parts = assemble(
            model.bricks, x.reshape(-1, 3)[model.element], p, model.mu, beam.stiffening, beam.bulk_ratio
        )
        dx, dturn = _step(model, parts.force, parts.matrix, factor, moves, slopes, loose, spring, turn - base)
        largest = np.abs(dx).max()
        if not np.isfinite(largest) or largest > 20 * beam.length:
            break
        part = _admissible(model, x, dx)
        x = x + part * dx
        turn = turn + part * dturn
        du = dx.reshape(-1, 3)[model.element].reshape(len(p), -1)
        p = p + part * (parts.shift + np.einsum("ebk,ek->eb", parts.recover, du))
        if largest < 2e-7 and part == 1.0:
            return Shape(model, x, turn, step)
    raise NoEquilibriumError(f"no equilibrium within {step} Newton steps: {beam}")


def _admissible(model: Model, x: Array, dx: Array) -> float:
    """Part of a step after which no element is turned inside out."""
    part = 1.0
    while smallest_volume(model.bricks, (x + part * dx).reshape(-1, 3)[model.element]) <= 0.0:
        part /= 2
        if part < 1e-2:
            raise NoEquilibriumError("elements turn inside out")
    return part


def _step(
    model: Model,
    force: Array,
    matrix: Array,
    factor: float,
    moves: Array,
    slopes: list[Array],
    loose: NDArray[np.intp],
    spring: Array,
    turned: Array,
) -> tuple[Array, Array]:
    """Newton step of the positions and of the clamps' turns: layers condensed, then block elimination."""
    degree, quads = model.degree, model.section.quads
    n = 3 * len(model.section.nodes)
    layers, size = len(model.mu) // len(quads), (degree + 1) * n
    residual = (factor * model.load).ravel()
    right = residual.reshape(-1, n).copy()
    A = np.zeros((layers, size, size))
    R = np.zeros((layers, size))
    for m, quad in enumerate(quads):
        nodes = (np.arange(degree + 1)[:, None] * len(model.section.nodes) + quad).ravel()
        dof = (3 * nodes[:, None] + np.arange(3)).ravel()
        block = matrix[m :: len(quads)].reshape(layers, -1)
        A.reshape(layers, -1)[:, (dof[:, None] * size + dof).ravel()] += block
        R[:, dof] -= force[m :: len(quads)].reshape(layers, -1)
    plane = degree * np.arange(layers)[:, None] + np.arange(degree + 1)
    np.add.at(right, plane, R.reshape(layers, degree + 1, n))
    mirror = 3 * model.section.flat + 1  # y = 0 stays in the mirror plane
    held = (np.arange(degree + 1)[:, None] * n + mirror).ravel()
    A[:, held] = 0.0
    A[:, :, held] = 0.0
    A[:, held, held] = 1.0
    right[:, mirror] = 0.0
    # columns: the load's right side with the faces moved as prescribed, then one for each loose clamp
    columns = 1 + len(loose)
    inner, outer = slice(n, degree * n), np.r_[0:n, degree * n : size]
    G = A[:, inner, outer]
    b = right[:-1].reshape(layers, degree, n)[:, 1:].reshape(layers, -1, 1)
    solved = np.linalg.solve(A[:, inner, inner], np.concatenate([G, b], axis=2))
    S = A[:, outer[:, None], outer] - G.swapaxes(1, 2) @ solved[..., :-1]
    c = (G.swapaxes(1, 2) @ solved[..., -1:])[..., 0]
    f = right[::degree].copy()
    f[:-1] -= c[:, :n]
    f[1:] -= c[:, n:]
    given = np.zeros((layers + 1, n, columns))
    ends = (0, layers)[: len(slopes)]
    for k, end in enumerate(ends):
        given[end, :, 0] = moves[-1 if k else 0].ravel()
        if k in loose:
            given[end, :, 1 + list(loose).index(k)] = slopes[k].ravel()
    d = _tridiagonal(S, f, given, bridge=len(ends) == 2)
    dturn = np.zeros(len(slopes))
    if len(loose):
        work, pull = np.zeros((len(loose), columns)), np.zeros(len(loose))
        for row, k in enumerate(loose):
            end, layer = ends[k], (0, layers - 1)[k]
            half = slice(0, n) if k == 0 else slice(n, 2 * n)
            reaction = S[layer, half] @ np.concatenate([d[layer], d[layer + 1]])
            work[row] = slopes[k].ravel() @ reaction
            pull[row] = slopes[k].ravel() @ f[end]
            work[row, 1 + row] += spring[k]
            work[row, 0] += spring[k] * turned[k]
        dturn[loose] = np.linalg.solve(work[:, 1:], pull - work[:, 0])
    d = d[..., 0] + d[..., 1:] @ dturn[loose]
    dx = np.empty((layers * degree + 1, n))
    dx[::degree] = d
    both = np.concatenate([d[:-1], d[1:]], axis=1)[..., None]
    middle = solved[..., -1:] - solved[..., :-1] @ both
    dx[:-1].reshape(layers, degree, n)[:, 1:] = middle.reshape(layers, degree - 1, n)
    return dx.reshape(moves.shape), dturn


def _tridiagonal(S: Array, f: Array, given: Array, *, bridge: bool) -> Array:
    """Faces' moves (faces, n, columns) from the layers' matrices S (l, 2n, 2n) and forces f (faces, n) (first
    column only); `given` holds the moves of the held faces."""
    layers, n = len(S), S.shape[1] // 2
    last = layers - 1 if bridge else layers
    right = np.zeros_like(given)
    right[..., 0] = f
    right[1] -= S[0, n:, :n] @ given[0]
    if bridge:
        right[layers - 1] -= S[-1, :n, n:] @ given[-1]
    d = given.copy()
    up: list[Array] = []
    diagonal = S[0, n:, n:]
    for face in range(1, last + 1):
        if face < layers:
            diagonal = diagonal + S[face, :n, :n]
        if face == last:
            d[face] = np.linalg.solve(diagonal, right[face])
            break
        both = np.linalg.solve(diagonal, np.concatenate([S[face, :n, n:], right[face]], axis=1))
        up.append(both)
        lower = S[face, n:, :n]
        right[face + 1] -= lower @ both[:, n:]
        diagonal = S[face, n:, n:] - lower @ both[:, :n]
    for face in range(last - 1, 0, -1):
        both = up[face - 1]
        d[face] = both[:, n:] - both[:, :n] @ d[face + 1]
    return d
