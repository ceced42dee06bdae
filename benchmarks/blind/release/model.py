"""Free vibration of a released cantilever, and the displacements of its markers.

A Timoshenko beam of linear finite elements; its modes are integrated with a viscoelastic material.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

Array = NDArray[np.float64]

LENGTH, WIDTH, HEIGHT, DENSITY, GRAVITY = 0.1, 0.02, 0.02, 1000.0, 9.81
ELEMENTS, MODES = 60, 3
CREEPS = 1e-3  # speed over which dry friction is regularised [m/s]
MARKERS = {  # x, y, z [mm]
    "top": (100.0, 0.0, 14.0),
    "left": (100.0, 12.0, -6.0),
    "right": (98.0, -12.0, 2.0),
    "base": (-4.0, 0.0, 16.0),
}


@dataclass(frozen=True, kw_only=True)
class Truth:
    """Parameters of a released cantilever.

    Attributes
    ----------
    shear : relaxed shear modulus [Pa].
    viscous : viscous damping relative to stiffness [s].
    branches : (fraction of `shear`, relaxation time [s]) of each Maxwell branch.
    clamp : compliance of the clamp [rad/(N m)].
    loose : fraction of the hung mass that does not move with the beam.
    rub : dry friction at the tip of a beam with a hung mass [N].
    held : fraction of the static deflection that is subtracted for a beam without a hung mass.
    extra : additional height of the tip's markers [m] as a function of the time since the release [s].
    drag : damping relative to mass [1/s].
    clock : relative error by which the record's time is too large.
    scale : relative error by which displacements are too large.
    """

    shear: float = 6e5
    viscous: float = 4e-4
    branches: Sequence[tuple[float, float]] = ()
    clamp: float = 0.0
    loose: float = 0.0
    rub: float = 0.0
    held: float = 0.0
    extra: Callable[[Array], Array] | None = None
    drag: float = 0.0
    clock: float = 0.0
    scale: float = 0.0


def beam(truth: Truth, hung: float) -> tuple[Array, Array, Array]:
    """Stiffness, mass and load of a clamped beam with unknowns (w, theta) per node; w is 0 at the root.

    The rotation of the root is on a spring: that of the clamp, or a stiff one.
    """
    young, area, inertia = 3.0 * truth.shear, WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
    sheared = 10.0 * 1.5 / (12.0 + 11.0 * 0.5)
    n, h = ELEMENTS + 1, LENGTH / ELEMENTS
    stiff, mass, load = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    bend = young * inertia / h * np.array([[0, 0, 0, 0], [0, 1, 0, -1], [0, 0, 0, 0], [0, -1, 0, 1.0]])
    slip = np.array([-1.0 / h, -0.5, 1.0 / h, -0.5])  # shear strain in the middle: one point, no locking
    part = h * np.array([[1 / 3, 1 / 6], [1 / 6, 1 / 3]])
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        stiff[at, at] += bend + sheared * truth.shear * area * h * np.outer(slip, slip)
        for offset, line in ((0, DENSITY * area), (1, DENSITY * inertia)):
            where = np.array([2 * e + offset, 2 * e + 2 + offset])
            mass[np.ix_(where, where)] += line * part
        load[[2 * e, 2 * e + 2]] -= 0.5 * h * DENSITY * area * GRAVITY
    moving = (1.0 - truth.loose) * hung
    mass[-2, -2] += moving
    mass[-1, -1] += moving * HEIGHT**2 / 12.0  # spread over the face
    load[-2] -= hung * GRAVITY
    stiff[1, 1] += 1.0 / truth.clamp if truth.clamp else 1e9
    return stiff[1:, 1:], mass[1:, 1:], load[1:]


def swing(truth: Truth, hung: float, time: Array, *, start: float = 0.0) -> Array:
    """Nodes (t, n, 2) of w and theta at times since the release, 0 before it.

    The beam is released at `start` times its static deflection.
    """
    stiff, mass, load = beam(truth, hung)
    squares, shapes = eigh(stiff, mass)
    rest = np.linalg.solve(stiff, load)
    whole = shapes.T @ mass @ rest  # static equilibrium of each mode
    parts = np.array([p for p, _ in truth.branches])
    times = np.array([t for _, t in truth.branches])
    b = len(parts)

    first = np.concatenate([start * whole[:MODES], np.zeros(MODES), np.tile(start * whole[:MODES], b)])
    after = time[time > 0.0]
    friction = truth.rub if hung else 0.0
    # state: amplitudes and speeds of the modes, and the internal variable of each branch and mode
    eye, no = np.eye(MODES), np.zeros((MODES, MODES))
    k = np.diag(squares[:MODES])
    rates = np.block(
        [
            [no, eye, *[no] * b],
            [-(1.0 + parts.sum()) * k, -truth.viscous * k - truth.drag * eye, *(p * k for p in parts)],
            *([eye / t, no, *(-eye / t if n == m else no for m in range(b))] for n, t in enumerate(times)),
        ]
    )
    still = np.concatenate([whole[:MODES], np.zeros(MODES), np.tile(whole[:MODES], b)])
    if friction:
        found = _rubbing(rates, still, first, after, shapes[-2, :MODES], friction)[:MODES]
    else:
        values, vectors = np.linalg.eig(rates)
        parts_of = np.linalg.solve(vectors, first - still)[:, None] * np.exp(np.outer(values, after))
        found = (vectors @ parts_of).real[:MODES] + whole[:MODES, None]
    quick = rest - shapes[:, :MODES] @ whole[:MODES]  # higher modes are quasi-static
    nodes = np.zeros((len(time), len(rest) + 1))
    below = 0.0 if hung else truth.held
    nodes[time > 0.0, 1:] = found.T @ shapes[:, :MODES].T + quick - below * rest
    return nodes.reshape(len(time), -1, 2)


def _rubbing(rates: Array, still: Array, first: Array, after: Array, at_tip: Array, friction: float) -> Array:
    """States (k, t) of the modes with additional dry friction at the tip."""

    def rate(_: float, state: Array) -> Array:
        change = rates @ (state - still)
        speed = state[MODES : 2 * MODES]
        change[MODES : 2 * MODES] -= friction * np.tanh(at_tip @ speed / CREEPS) * at_tip
        return np.asarray(change)

    found = solve_ivp(
        rate, (0.0, float(after[-1])), first, method="LSODA", t_eval=after, rtol=1e-8, atol=1e-12
    )
    return np.asarray(found.y)


def moved(nodes: Array, at: tuple[float, float, float], *, on_clamp: bool) -> Array:
    """Displacement (t, 2) in x and z [m] of a marker on a stalk, to second order in the slopes."""
    x, _, z = (1e-3 * v for v in at)
    places = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    if on_clamp:
        theta = nodes[:, 0, 1]
        return np.column_stack([-z * theta - 0.5 * x * theta**2, x * theta - 0.5 * z * theta**2])
    w = np.array([np.interp(x, places, row) for row in nodes[:, :, 0]])
    theta = np.array([np.interp(x, places, row) for row in nodes[:, :, 1]])
    slope = np.diff(nodes[:, :, 0], axis=1) / np.diff(places)
    inside = np.clip(x - places[:-1], 0.0, np.diff(places))
    short = -0.5 * (slope**2) @ inside
    return np.column_stack([short - z * np.sin(theta), w + z * (np.cos(theta) - 1.0)])


def displaced(
    truth: Truth, hung: float, since: Array, places: dict[str, Array], *, start: float, angle: float
) -> dict[str, Array]:
    """Displacements (t, 2) in x and z [mm] of markers at `places` [mm].

    `since` is the time since the release by the record's clock; the frame is rotated by `angle` [rad].
    """
    true = since / (1.0 + truth.clock)
    nodes = swing(truth, hung, true, start=start)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    found = {}
    for name, at in places.items():
        x, y, z = (float(v) for v in at)
        on_clamp = MARKERS[name][0] < 0.0
        u = 1e3 * (1.0 + truth.scale) * moved(nodes, (x, y, z), on_clamp=on_clamp)
        if truth.extra is not None and not on_clamp:
            u[:, 1] += 1e3 * truth.extra(np.maximum(true, 0.0)) * (true > 0.0)
        found[name] = u @ turn
    return found
