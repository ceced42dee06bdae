"""Start values of imperfect beams: a planar, extensible rod with natural curvature between imperfect clamps.

Segments of length h and angle p_i carry the load V_i + R beyond their middle (R: the far clamp's force). With
t, n along and across a segment, tau = (V + R).t, its stretch is tau / EA, and the stationary points of

    sum over joints (p_(i+1) - p_i - h k)^2 / (2 C) - sum over segments h (tau + tau^2 / (2 EA)) + R.r_end

are the equilibria: C = h / EI between segments; at a clamp, half a segment's and the clamp's own compliance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim._specimen import along, half_sizes, heaviness, scale, skin_factors
from tisim.bodies import Circle
from tisim.laws import Moduli
from tisim.mesh import Mesh
from tisim.scene import Beam

Array = NDArray[np.float64]

SEGMENTS = 40
SMALLEST_STEP = 1.0 / 64.0  # of the load
SQUEEZED = 0.5  # how far a clamp's squeeze reaches into the guess, in half heights of the section


@dataclass(frozen=True)
class Rod:
    """s (k,) along the beam, axis points (k, 2) (x, z) [m], angles (k,) from the x axis [rad]."""

    s: Array
    axis: Array
    angle: Array

    @property
    def clamp_angles(self) -> Array:
        """At the near and the far end, (2,)."""
        return self.angle[[0, -1]]


@dataclass(frozen=True)
class _Chain:
    """The rod's segments and joints, see the module's text.

    h [m]; load (k, 2) beyond each segment's middle [N]; ea (k,) [N]; bend (k + 1,): angles of the joints
    free of stress [rad], the first against the x axis, and the last the x axis against the last segment;
    softness (k + 1,) [rad/(N m)]; end: the far clamp's middle (x, z) [m], None on a cantilever.
    """

    h: float
    load: Array
    ea: Array
    bend: Array
    softness: Array
    end: Array | None


def solve_rod(scene: Beam, moduli: Moduli, clamp_angles: Array | None = None) -> Rod | None:
    """The beam as a rod in the plane y = 0; None where no equilibrium is found.

    clamp_angles: of the clamps' faces [rad], instead of those that tilt and compliance give.
    """
    clamps = scene.clamps
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
    """faces (2,): angles of the clamps [rad]; yielding: their compliance [rad/(N m)]."""
    h = scene.length / SEGMENTS
    middle = np.asarray((np.arange(SEGMENTS) + 0.5) * h, dtype=np.float64)
    joint = np.asarray(np.arange(SEGMENTS + 1) * h, dtype=np.float64)
    area, inertia = _section(scene)
    young = 9.0 * moduli.bulk * moduli.shear / (3.0 * moduli.bulk + moduli.shear)
    stretching, bending, _ = skin_factors(scene)
    weight = scene.material.density * area * h * heaviness(scene, middle) * scale(scene, middle) ** 2
    beyond = np.cumsum(weight[::-1])[::-1] - 0.5 * weight
    softness = h / (young * inertia * bending * scale(scene, joint) ** 4 * along(scene, joint))
    bend = np.full(SEGMENTS + 1, scene.specimen.curvature * h)
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
    """Angles (k,) and the far clamp's force (2,) at full load, in as few steps of the load as it takes."""
    # from the stress-free shape of a cantilever, from straight between two clamps
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


def _section(scene: Beam) -> tuple[float, float]:
    """Area [m2] and second moment about y [m4]."""
    b, h = half_sizes(scene.section)
    if isinstance(scene.section, Circle):
        return np.pi * h**2, np.pi * h**4 / 4.0
    return 4.0 * b * h, 4.0 * b * h**3 / 3.0


def _tension(force: Array, p: Array) -> tuple[Array, Array, Array]:
    """Force along the segments (k,), their directions (k, 2) and normals (k, 2)."""
    t = np.column_stack([np.cos(p), np.sin(p)])
    n = np.column_stack([-np.sin(p), np.cos(p)])
    return (force * t).sum(axis=1), t, n


def _newton(chain: _Chain, load: Array, p: Array, reaction: Array) -> tuple[Array, Array] | None:
    """Angles (k,) and the far clamp's force (2,) in equilibrium; None where Newton does not find them."""
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
    """Where the clamps, at these angles, hold `nodes` (k,) of the mesh, (k, 3) [m]."""
    clamps = scene.clamps
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
    """Middles of the near and the far clamp's face, (2, 3) [m]."""
    dx, dz = scene.clamps.far_shift
    return np.array([[0.0, 0.0, 0.0], [scene.length + dx, 0.0, dz]])


def body_positions(scene: Beam, mesh: Mesh, rod: Rod) -> Array:
    """Node positions (n, 3) of the beam whose axis is the rod, its sections flat and as large as at rest."""
    x, y, z = mesh.nodes.T
    inside = np.clip(x, 0.0, scene.length)
    half_height = half_sizes(scene.section)[1]
    squeeze = np.exp(-inside / (SQUEEZED * half_height))
    if scene.supports == "clamped-clamped":
        squeeze = squeeze + np.exp(-(scene.length - inside) / (SQUEEZED * half_height))
    squeeze = scene.clamps.squeeze * squeeze
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
