"""Rods in a plane, which give the start values of beams.

An ideal beam starts from a planar, nearly inextensible Euler-Bernoulli rod under weight and a tip force
(`planar_rod`): nodes joined by stiff axial springs and bending springs. Newton's method on its energy, with
load steps if the whole load fails, applies to both supports. The continuous rod obeys
EI theta'' + V(s) x t = 0, V(s) the load beyond s.

An imperfect beam starts from an extensible rod with natural curvature between imperfect clamps (`solve_rod`).
Segments of length h and angle p_i carry the load V_i + R beyond their middle (R: the far clamp's force). With
t, n along and across a segment, tau = (V + R).t, its stretch is tau / EA, and the stationary points of

    sum over joints (p_(i+1) - p_i - h k)^2 / (2 C) - sum over segments h (tau + tau^2 / (2 EA)) + R.r_end

are the equilibria. C = h / EI between segments; at a clamp it is half of that plus the clamp's compliance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from tisim.laws import Moduli
from tisim.mesh import Mesh
from tisim.problems.beam.rest_shape import along, heaviness, scale, skin_factors
from tisim.scene import Beam

Array = NDArray[np.float64]
SEGMENTS = 40
SMALLEST_STEP = 1.0 / 64.0  # smallest increment of the load, as a fraction of it
SQUEEZED = 0.5  # decay length of a clamp's squeeze in the start values, in half heights of the section


def planar_rod(
    *,
    length: float,
    bending: float,
    stretching: float,
    line_load: tuple[float, float],
    tip_force: tuple[float, float],
    clamped_end: bool,
    segments: int = 60,
) -> tuple[Array, Array, Array]:
    """Equilibrium of a straight rod along the first axis of a plane, clamped at s = 0.

    Parameters
    ----------
    length : float
        Length of the rod [m].
    bending, stretching : float
        EI [N m2] and EA [N].
    line_load, tip_force : tuple of float
        Components along and across the rod [N/m], [N].
    clamped_end : bool
        Clamp the far end as well.
    segments : int
        Number of segments of the discrete rod.

    Returns
    -------
    tuple of ndarray
        Arc length s (k,) [m], positions (k, 2) [m] and section angles (k,) [rad], k = segments + 1. They
        belong to a part of the load if no equilibrium at the full load is found.
    """
    h = length / segments
    rest = np.column_stack([np.linspace(0.0, length, segments + 1), np.zeros(segments + 1)])
    load = np.tile(np.asarray(line_load, dtype=float) * h, (segments + 1, 1))
    load[0] *= 0.5
    load[-1] *= 0.5
    load[-1] += tip_force
    # ghost nodes one segment beyond each clamp hold its direction
    x = rest.copy()
    free = slice(1, segments) if clamped_end else slice(1, segments + 1)
    factor, step = 0.0, 1.0
    while factor < 1.0 and step > 1e-3:
        target = min(1.0, factor + step)
        trial = _equilibrium(x, target * load, h, bending, stretching, free, clamped_end)
        if trial is None:
            step *= 0.5
        else:
            x, factor = trial, target
            step *= 2.0
    edges = np.diff(x, axis=0)
    angle = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
    theta = np.empty(segments + 1)
    theta[1:-1] = 0.5 * (angle[1:] + angle[:-1])
    theta[0] = 0.0
    theta[-1] = 0.0 if clamped_end else angle[-1] + 0.5 * (angle[-1] - theta[-2])
    return rest[:, 0], x, theta


def _equilibrium(
    x: Array, load: Array, h: float, ei: float, ea: float, free: slice, clamped_end: bool
) -> Array | None:
    """Newton's method for the discrete rod; None if it does not converge."""
    x = x.copy()
    scale = np.linalg.norm(load) + 1e-12
    for _ in range(60):
        force, band = _forces(x, h, ei, ea, clamped_end)
        residual = (force - load)[free].ravel()
        if np.linalg.norm(residual) < 1e-5 * scale:
            return x
        n = residual.size
        ab = np.zeros((11, n))
        first = 2 * free.start
        for k in range(-5, 6):
            row = band[5 - k, first : first + n]
            ab[5 - k] = row
        step = solve_banded((5, 5), ab, -residual)
        if not np.isfinite(step).all():
            return None
        peak = np.abs(step).max()
        x[free] += (min(1.0, 2.0 * h / peak) * step).reshape(-1, 2)
    return None


def _forces(x: Array, h: float, ei: float, ea: float, clamped_end: bool) -> tuple[Array, Array]:
    """Internal forces (k, 2) [N] and the banded tangent (11, 2k) [N/m] of the discrete rod.

    The energy is EA/(2h) (|e| - h)^2 per edge and EI/(2h^3) |x_(i-1) - 2 x_i + x_(i+1)|^2 per node, which for
    edges of length h and a turning angle a is EI/h (1 - cos a).
    """
    ghost0 = x[:1] - np.array([[h, 0.0]])
    points = np.vstack([ghost0, x])
    if clamped_end:
        points = np.vstack([points, x[-1:] + np.array([[h, 0.0]])])
    k = len(x)
    force = np.zeros_like(points)
    c = ei / h**3
    lap = points[:-2] - 2 * points[1:-1] + points[2:]
    force[:-2] += c * lap
    force[1:-1] -= 2 * c * lap
    force[2:] += c * lap
    edges = np.diff(points, axis=0)
    size = np.linalg.norm(edges, axis=1)
    t = edges / size[:, None]
    pull = ea / h * (size - h)
    force[:-1] -= pull[:, None] * t
    force[1:] += pull[:, None] * t
    tt = t[:, :, None] * t[:, None, :]
    stiff = ea / h * tt + (pull / size)[:, None, None] * (np.eye(2) - tt)
    band = _bending_band(len(points), c).copy()
    for a, b in ((0, 0), (0, 1), (1, 0), (1, 1)):
        _add(band, 0, 0, a, b, stiff[:, a, b])
        _add(band, 1, 1, a, b, stiff[:, a, b])
        _add(band, 0, 1, a, b, -stiff[:, a, b])
        _add(band, 1, 0, a, b, -stiff[:, a, b])
    return force[1 : 1 + k], band[:, 2 : 2 + 2 * k]


@lru_cache(maxsize=32)
def _bending_band(points: int, stiffness: float) -> Array:
    """Contribution of the bending springs to the tangent, which is constant; shape (11, 2 points)."""
    band = np.zeros((11, 2 * points))
    ones = np.full(points - 2, stiffness)
    coefficient = (1.0, -2.0, 1.0)
    for p in range(3):
        for q in range(3):
            for a in range(2):
                _add(band, p, q, a, a, coefficient[p] * coefficient[q] * ones)
    return band


def _add(band: Array, i: int, j: int, a: int, b: int, values: Array) -> None:
    """Add values (n,) to the entries (component a of point i + k, component b of point j + k), k < n."""
    first = 2 * j + b
    band[5 + 2 * (i - j) + a - b, first : first + 2 * len(values) : 2] += values


@dataclass(frozen=True)
class Rod:
    """Shape of a rod in the plane y = 0.

    Attributes
    ----------
    s : position along the undeformed beam [m], shape (k,).
    axis : points (x, z) of the axis [m], shape (k, 2).
    angle : angles from the x axis [rad], shape (k,).
    """

    s: Array
    axis: Array
    angle: Array

    @property
    def clamp_angles(self) -> Array:
        """Angles at the near and the far end [rad], shape (2,)."""
        return self.angle[[0, -1]]


@dataclass(frozen=True)
class _Chain:
    """The rod's segments and joints, see the module's docstring.

    Attributes
    ----------
    h : length of a segment [m].
    load : load beyond each segment's middle [N], shape (k, 2).
    ea : axial stiffness [N], shape (k,).
    bend : stress-free angles of the joints [rad], shape (k + 1,); the first is that of the first segment from
        the x axis, the last that of the x axis from the last segment.
    softness : compliance of the joints [rad/(N m)], shape (k + 1,).
    end : middle of the far clamp's face (x, z) [m]; None for a cantilever.
    """

    h: float
    load: Array
    ea: Array
    bend: Array
    softness: Array
    end: Array | None


def solve_rod(scene: Beam, moduli: Moduli, clamp_angles: Array | None = None) -> Rod | None:
    """Equilibrium of the beam as a rod in the plane y = 0; None if none is found.

    Parameters
    ----------
    scene : Beam
    moduli : Moduli
    clamp_angles : ndarray of float, shape (2,), optional
        Prescribed angles of the clamps' faces [rad]. By default they follow from tilt and compliance.
    """
    clamps = scene.clamp_imperfections
    faces = np.array([clamps.tilt, clamps.far_tilt]) if clamp_angles is None else clamp_angles
    yielding = clamps.compliance if clamp_angles is None else 0.0
    chain = _chain(scene, moduli, faces, yielding)
    found = _in_steps(chain)
    if found is None:
        return None
    p, reaction = found
    h, bend = chain.h, chain.bend
    tau, t, _ = _tension(chain.load + reaction, p)
    points = np.zeros((SEGMENTS + 1, 2))
    np.cumsum((h * (1.0 + tau / chain.ea))[:, None] * t, axis=0, out=points[1:])
    angle = np.empty(SEGMENTS + 1)
    angle[1:-1] = 0.5 * (p[1:] + p[:-1])
    angle[0] = faces[0] + yielding * (p[0] - bend[0]) / chain.softness[0]
    if chain.end is not None:
        angle[-1] = faces[1] + yielding * (p[-1] + bend[-1]) / chain.softness[-1]
    else:
        angle[-1] = p[-1] + bend[-1] + faces[1]
    return Rod(np.linspace(0.0, scene.length, SEGMENTS + 1), points, angle)


def _chain(scene: Beam, moduli: Moduli, faces: Array, yielding: float) -> _Chain:
    """Segments and joints of a beam; faces (2,): clamp angles [rad], yielding: compliance [rad/(N m)]."""
    h = scene.length / SEGMENTS
    middle = np.asarray((np.arange(SEGMENTS) + 0.5) * h, dtype=np.float64)
    joint = np.asarray(np.arange(SEGMENTS + 1) * h, dtype=np.float64)
    area, inertia = scene.section.area, scene.section.second_moment("y")
    young = moduli.young_modulus
    stretching, bending, _ = skin_factors(scene)
    weight = scene.material.density * area * h * heaviness(scene, middle) * scale(scene, middle) ** 2
    beyond = np.cumsum(weight[::-1])[::-1] - 0.5 * weight
    softness = h / (young * inertia * bending * scale(scene, joint) ** 4 * along(scene, joint))
    bend = np.full(SEGMENTS + 1, scene.imperfections.curvature * h)
    for at_clamps in (softness, bend):
        at_clamps[[0, -1]] *= 0.5
    softness[[0, -1]] += yielding
    bend += np.concatenate([faces[:1], np.zeros(SEGMENTS - 1), -faces[1:]])
    end = None
    if scene.supports == "clamped-clamped":
        end = clamp_centres(scene)[1, [0, 2]]
    else:
        softness[-1] = np.inf
    return _Chain(
        h,
        beyond[:, None] * _in_plane(scene.gravity) + _in_plane(scene.tip_force),
        young * area * stretching * scale(scene, middle) ** 2 * along(scene, middle),
        bend,
        softness,
        end,
    )


def _in_plane(vector: tuple[float, float, float]) -> Array:
    return np.array([vector[0], vector[2]])


def _in_steps(chain: _Chain) -> tuple[Array, Array] | None:
    """Angles (k,) [rad] and the far clamp's force (2,) [N] at full load; load steps are halved on failure."""
    # start: stress-free shape of a cantilever, straight line between two clamps
    if chain.end is None:
        p = np.cumsum(chain.bend)[:-1]
    else:
        p = np.full(SEGMENTS, np.arctan2(chain.end[1], chain.end[0]))
    reaction, part, step = np.zeros(2), 0.0, 1.0
    while part < 1.0:
        wanted = min(1.0, part + step)
        trial = _newton(chain, wanted * chain.load, p, reaction)
        if trial is not None:
            (p, reaction), part = trial, wanted
            continue
        step *= 0.5
        if step < SMALLEST_STEP:
            return None
    return p, reaction


def _tension(force: Array, p: Array) -> tuple[Array, Array, Array]:
    """Axial force in the segments (k,) [N], their directions (k, 2) and normals (k, 2)."""
    t = np.column_stack([np.cos(p), np.sin(p)])
    n = np.column_stack([-np.sin(p), np.cos(p)])
    return (force * t).sum(axis=1), t, n


def _newton(chain: _Chain, load: Array, p: Array, reaction: Array) -> tuple[Array, Array] | None:
    """Angles (k,) [rad] and the far clamp's force (2,) [N] in equilibrium; None if Newton fails."""
    h, bend, softness, ea, end = chain.h, chain.bend, chain.softness, chain.ea, chain.end
    k = len(p)
    spring = 1.0 / softness
    size = k if end is None else k + 2
    matrix, residual = np.zeros((size, size)), np.zeros(size)
    i = np.arange(k)
    for _ in range(40):
        tau, t, n = _tension(load + reaction, p)
        across = ((load + reaction) * n).sum(axis=1)
        long = 1.0 + tau / ea
        moment = spring * (np.diff(p, prepend=0.0, append=0.0) - bend)
        residual[:k] = moment[:-1] - moment[1:] - h * long * across
        matrix[:] = 0.0
        matrix[i, i] = spring[:-1] + spring[1:] - h * (across**2 / ea - long * tau)
        matrix[i[:-1], i[1:]] = matrix[i[1:], i[:-1]] = -spring[1:-1]
        if end is not None:
            residual[k:] = end - h * (long[:, None] * t).sum(axis=0)
            matrix[:k, k:] = -h * (n * long[:, None] + (across / ea)[:, None] * t)
            matrix[k:, :k] = matrix[:k, k:].T
            matrix[k:, k:] = -h * (t.T / ea) @ t
        try:
            step = np.linalg.solve(matrix, -residual)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(step).all():
            return None
        peak = np.abs(step[:k]).max()
        step *= min(1.0, 0.5 / peak) if peak > 0.0 else 1.0
        p = p + step[:k]
        if end is not None:
            reaction = reaction + step[k:]
        if peak < 1e-9:
            return p, reaction
    return None


def clamped_positions(scene: Beam, mesh: Mesh, nodes: NDArray[np.int32], clamp_angles: Array) -> Array:
    """Positions (k, 3) [m] at which clamps of these angles (2,) [rad] hold `nodes` (k,) of the mesh."""
    clamps = scene.clamp_imperfections
    x, y, z = mesh.nodes[nodes].T
    near = x < 0.5 * scene.length
    inside = np.clip(x, 0.0, scene.length)
    size = scale(scene, inside)
    up, wide = size * z * (1.0 - clamps.squeeze), size * y / (1.0 - clamps.squeeze)
    angle = np.where(near, clamp_angles[0], clamp_angles[1])
    along_x = np.where(near, x, x - scene.length)
    centre = clamp_centres(scene)[np.where(near, 0, 1)]
    return np.column_stack(
        [
            centre[:, 0] + along_x * np.cos(angle) - up * np.sin(angle),
            wide,
            centre[:, 2] + along_x * np.sin(angle) + up * np.cos(angle),
        ]
    )


def clamp_centres(scene: Beam) -> Array:
    """Middles of the near and the far clamp's face [m], shape (2, 3)."""
    dx, dz = scene.clamp_imperfections.far_shift
    return np.array([[0.0, 0.0, 0.0], [scene.length + dx, 0.0, dz]])


def body_positions(scene: Beam, mesh: Mesh, rod: Rod) -> Array:
    """Node positions (n, 3) [m] of the beam around the rod, with plane sections.

    Sections keep the size of the rest shape, except for the clamps' squeeze, which decays from the clamps.
    """
    x, y, z = mesh.nodes.T
    inside = np.clip(x, 0.0, scene.length)
    half_height = scene.section.half_height
    squeeze = np.exp(-inside / (SQUEEZED * half_height))
    if scene.supports == "clamped-clamped":
        squeeze = squeeze + np.exp(-(scene.length - inside) / (SQUEEZED * half_height))
    squeeze = scene.clamp_imperfections.squeeze * squeeze
    size = scale(scene, inside)
    up, wide = size * z * (1.0 - squeeze), size * y / (1.0 - squeeze)
    angle = np.interp(inside, rod.s, rod.angle)
    return np.column_stack(
        [
            np.interp(inside, rod.s, rod.axis[:, 0]) - up * np.sin(angle) + (x - inside) * np.cos(angle),
            wide,
            np.interp(inside, rod.s, rod.axis[:, 1]) + up * np.cos(angle) + (x - inside) * np.sin(angle),
        ]
    )
