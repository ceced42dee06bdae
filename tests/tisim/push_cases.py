"""What the contact and poke tests share: rods as NumPy sees them, small blocks, pushed systems, theory."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq

from tisim import _poke
from tisim._body import Layout
from tisim._newton import Outcome, newton
from tisim._poke import PokeSystem
from tisim.materials import material_from_moduli
from tisim.mesh import Mesh, boundary_facets, poke_mesh
from tisim.scene import Poke, Rod

Array = NDArray[np.float64]
FLAT = Rod()
BALL = Rod(tip="hemisphere")
SHEAR, BULK = 30e3, 600e3


def soft(law: str = "neo-hookean", shear: float = SHEAR, bulk: float = BULK) -> Any:
    return material_from_moduli(law, shear=shear, bulk=bulk)


def direction(tilt: float, azimuth: float = 0.0) -> tuple[float, float, float]:
    """Push leaning by `tilt` [degrees] from straight down, towards `azimuth` [degrees]."""
    t, a = math.radians(tilt), math.radians(azimuth)
    return math.sin(t) * math.cos(a), math.sin(t) * math.sin(a), -math.cos(t)


def scene_of(**changes: Any) -> Poke:
    """A shallow poke on a coarse mesh."""
    return Poke(**{"material": soft(), "depth": 0.002, "refinement": 0.6, **changes})


def tiny_block(cells: int = 6) -> Mesh:
    """16 x 16 x 10 mm of bricks, smaller towards the middle of the top."""
    s = np.linspace(-1.0, 1.0, cells + 1)
    side = 0.008 * (0.5 * s + 0.5 * s**3)
    up = 0.010 * (1.0 - (1.0 - np.linspace(0.0, 1.0, 5)) ** 1.3)
    nodes = np.stack(np.meshgrid(side, side, up, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(cells + 1, cells + 1, 5)
    i, j, k = (c.ravel() for c in np.meshgrid(*(np.arange(n) for n in (cells, cells, 4)), indexing="ij"))
    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    elements = np.stack([number[i + a, j + b, k + c] for c in (0, 1) for a, b in ring], axis=1)
    faces = boundary_facets("hex8", elements)
    return Mesh(
        kind="hex8",
        nodes=nodes,
        elements=elements,
        node_sets={"base": np.flatnonzero(nodes[:, 2] == 0.0).astype(np.int32)},
        facet_sets={"top": faces[(nodes[faces, 2] > 0.010 - 1e-12).all(axis=1)], "surface": faces},
    )


def edge_of(rod: Rod) -> float:
    return rod.radius if rod.tip == "hemisphere" else rod.edge_radius


def profile(rod: Rod, n: int = 4000) -> Array:
    """Points (k, 2) of the rod's outline: distance from its axis, height behind the tip [m]."""
    e = edge_of(rod)
    angle = np.linspace(0.0, np.pi / 2, n)
    arc = np.column_stack([rod.radius - e + e * np.sin(angle), e - e * np.cos(angle)])
    flat = np.column_stack([np.linspace(0.0, rod.radius - e, n), np.zeros(n)])
    shaft = np.column_stack([np.full(n, rod.radius), np.linspace(e, 0.010, n)])
    return np.concatenate([flat, arc, shaft])


def surface_points(rod: Rod, tip: Array, axis: Array, *, around: int = 720) -> Array:
    """Points (k, 3) on the rod; one of the circle's points lies straight ahead of the tilt."""
    r, h = profile(rod, 1500).T
    down = np.array([0.0, 0.0, -1.0])
    u = down - (down @ axis) * axis
    u = u / np.linalg.norm(u) if np.linalg.norm(u) > 1e-9 else np.array([1.0, 0.0, 0.0])
    v = np.cross(axis, u)
    turn = 2.0 * np.pi * np.arange(around) / around
    circle = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    return (tip - h[:, None, None] * axis + r[:, None, None] * circle).reshape(-1, 3)


def brute_distance(points: Array, rod: Rod, tip: Array, axis: Array) -> tuple[Array, Array]:
    """Signed distance [m] of points (n, 3) to the sampled outline, and its outward normal (n, 3)."""
    e = edge_of(rod)
    behind = -(points - tip) @ axis
    radial = points - tip + behind[:, None] * axis
    r = np.linalg.norm(radial, axis=1)
    away = radial / np.maximum(r, 1e-15)[:, None]
    line = profile(rod)
    distance, normal = np.empty(len(points)), np.empty((len(points), 3))
    for k, (a, b) in enumerate(np.column_stack([r, behind])):
        nearest = line[np.argmin((line[:, 0] - a) ** 2 + (line[:, 1] - b) ** 2)]
        # the outline behind the rounding: its half-width at this height
        if b < 0.0:
            inside = False
        elif b < e:
            inside = a < rod.radius - e + math.sqrt(e * e - (e - b) ** 2)
        else:
            inside = a < rod.radius
        sign = -1.0 if inside else 1.0
        gap = np.array([a, b]) - nearest
        size = float(np.hypot(*gap))
        distance[k] = sign * size
        normal[k] = sign * (gap[0] * away[k] - gap[1] * axis) / max(size, 1e-15)
    return distance, normal


def system_of(scene: Poke) -> PokeSystem:
    mesh = scene.mesh or poke_mesh(
        block=scene.block,
        site=scene.site,
        direction=scene.direction,
        rod=scene.rod,
        refinement=scene.refinement,
    )
    return PokeSystem(scene, Layout.build(mesh, mesh.node_sets["base"]))


def pushed(scene: Poke) -> PokeSystem:
    """The system in equilibrium at the scene's depth, its friction's state as last assembled."""
    system = system_of(scene)
    frames, status, *_ = _poke._push(scene, system, trace=None)
    assert status.value == "converged", status
    assert frames[-1].x is system.previous
    return system


def carry_on(system: PokeSystem, depth: float) -> Outcome:
    """One more step from the accepted state to this depth, and that accepted."""
    system.move_to(depth)
    system.touch(system.previous)
    outcome = newton(system, system.previous, tolerance=1e-6, max_iterations=60)
    if outcome.status.value == "converged":
        system.accept(outcome.x)
    return outcome


def samples(system: PokeSystem, x: Array) -> Array:
    """Contact points (f, q, 3) of the system at x."""
    return np.einsum("qa,fai->fqi", system._shape, x[system.facets])


def half_space_force(rod: Rod, depth: float, shear: float, bulk: float) -> tuple[float, float]:
    """Force [N] and contact radius [m] of the rod on a frictionless elastic half-space (Galin, Sneddon).

    F = 2 E* int f'(r) r^2 / sqrt(a^2 - r^2) dr and d = int f'(r) a / sqrt(a^2 - r^2) dr over the contact
    0 < r < a, with f the circular edge behind the flat of radius b; Hertz where b = 0 and a is small.
    """
    nu = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
    stiff = 2.0 * shear / (1.0 - nu)
    e = edge_of(rod)
    b = rod.radius - e

    def over(weight: Any, a: float) -> float:
        def integrand(angle: float) -> float:
            r = a * math.sin(angle)
            s = (r - b) / e
            return s / math.sqrt(1.0 - s * s) * float(weight(r)) if r > b else 0.0

        return float(quad(integrand, math.asin(b / a), math.pi / 2, epsabs=0.0, epsrel=1e-9)[0])

    a = float(brentq(lambda a: a * over(lambda _: 1.0, a) - depth, b * (1 + 1e-9) + 1e-9, b + 0.98 * e))
    return 2.0 * stiff * over(lambda r: r * r, a), a
